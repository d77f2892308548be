"""Rounds of gelenk's Stribeck fit and SciPy's curve_fit; `stribeck.sh` calls it with the number of rounds.

The data are those of runtime/benches/identification.rs: 1 kHz, noise of 0.05 N m from SplitMix64 and Box and Muller.
"""

import re
import subprocess
import sys
import time

import numpy as np
import scipy
from scipy.optimize import curve_fit

TRUE = (2.1, 1.4, 20.0, 0.9, 8.0)
START = (1.0, 1.0, 10.0, 1.0, 5.0)
SEED = 20240229
SAMPLES = (10_000, 100_000, 1_000_000)
# How far two optimizers may stop from the same minimum, as a share of a parameter.
AGREEMENT = 1e-4


def uniforms(count):
    with np.errstate(over="ignore"):
        z = np.uint64(SEED) + np.arange(1, count + 1, dtype=np.uint64) * np.uint64(0x9E3779B97F4A7C15)
        z = (z ^ (z >> np.uint64(30))) * np.uint64(0xBF58476D1CE4E5B9)
        z = (z ^ (z >> np.uint64(27))) * np.uint64(0x94D049BB133111EB)
    return ((z ^ (z >> np.uint64(31))) >> np.uint64(11)).astype(np.float64)


def law(v, a1, a2, a3, a4, a5):
    return a1 * v + a2 * np.tanh(a3 * v) + a4 * np.exp(-a5 * np.abs(v)) * np.tanh(3 * a3 * v)


def with_offset(v, a1, a2, a3, a4, a5, offset):
    return law(v, a1, a2, a3, a4, a5) + offset


def jacobian(v, a1, a2, a3, a4, a5):
    step, short, decay = np.tanh(a3 * v), np.tanh(3 * a3 * v), np.exp(-a5 * np.abs(v))
    by_steepness = a2 * v * (1 - step * step) + 3 * a4 * decay * v * (1 - short * short)
    return np.column_stack([v, step, by_steepness, decay * short, -a4 * np.abs(v) * decay * short])


def samples(m):
    t = np.arange(m) * 1e-3
    turns = 2 * np.pi * t
    v = 1.2 * np.sin(0.31 * turns) + 0.7 * np.sin(0.83 * turns + 0.4) + 0.15 * np.sin(3.7 * turns)
    k = uniforms(2 * m)
    noise = np.sqrt(-2 * np.log((k[0::2] + 1) / 2.0**53)) * np.cos(2 * np.pi * k[1::2] / 2.0**53)
    return v, law(v, *TRUE) + 0.05 * noise


CASES = {
    "curve_fit": lambda v, y: curve_fit(law, v, y, p0=START)[0],
    "curve_fit, exact Jacobian": lambda v, y: curve_fit(law, v, y, p0=START, jac=jacobian)[0],
    "curve_fit with offset": lambda v, y: curve_fit(with_offset, v, y, p0=(*START, 0.0))[0],
}


def least(fit, v, y):
    """Least time in ms, and the parameters: what a busy machine distorts least."""
    times = []
    begin = time.perf_counter()
    while len(times) < 3 or (time.perf_counter() - begin < 1 and len(times) < 25):
        start = time.perf_counter()
        found = fit(v, y)
        times.append(time.perf_counter() - start)
    return 1e3 * min(times), found


def gelenk():
    """Least times in ms and parameters of the bench, by number of samples."""
    command = ["cargo", "bench", "--quiet", "-p", "gelenk-runtime", "--bench", "identification", "--", "fit"]
    text = subprocess.run(command, check=True, capture_output=True, text=True).stdout
    rows = re.findall(r"^Stribeck +m= *(\d+) .* least ([\d.]+) ms +\[([^\]]*)\]", text, re.MULTILINE)
    return {int(m): (float(ms), np.array(values.split(), dtype=float)) for m, ms, values in rows}


def main(rounds):
    data = {m: samples(m) for m in SAMPLES}
    best = {}
    for _ in range(rounds):
        own = gelenk()
        for m, (v, y) in data.items():
            rows = {name: least(fit, v, y) for name, fit in CASES.items()}
            away = np.max(np.abs(own[m][1] / rows["curve_fit with offset"][1][:5] - 1))
            if away > AGREEMENT:
                sys.exit(f"{m} samples: the fits differ by {away:.1e}")
            for name, (ms, _) in {"gelenk": own[m], **rows}.items():
                best[m, name] = min(ms, best.get((m, name), np.inf))
    print(f"least of {rounds} rounds, SciPy {scipy.__version__}, NumPy {np.__version__}")
    print("| samples | gelenk [ms] |" + "".join(f" {name} [ms] | × gelenk |" for name in CASES))
    for m in SAMPLES:
        own = best[m, "gelenk"]
        cells = "".join(f" {best[m, name]:.2f} | {best[m, name] / own:.1f} |" for name in CASES)
        print(f"| {m} | {own:.2f} |{cells}")


main(int(sys.argv[1]))
