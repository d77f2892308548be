#!/usr/bin/env python3
"""Generated functions of published URDFs beside Pinocchio.

usage: compare.py GELENK FOLDER [NAME ...]

GELENK is the program, FOLDER keeps modules and binaries. NAMEs choose robots of robots.txt by a part of their path, by default
all. The robots are those of the package example-robot-data which Pinocchio loads on a fixed base with nq = nv. Each is generated
by `gelenk generate X.urdf --no-friction --ignore-mimic`. M, k, gravity, inverse and forward dynamics and both Jacobians of the
inverse dynamics are compared at seeded states, relative to the largest entry of Pinocchio's array; a singular M has to be
singular for Pinocchio too. Exit code 1 where something differs.
"""
import os
import random
import subprocess
import sys
import sysconfig

try:
    import numpy as np
    import pinocchio as pin
except ImportError as missing:
    print(f"skipped: {missing}; `pip install pin example-robot-data numpy` makes the comparison possible")
    sys.exit(0)

HERE = os.path.dirname(os.path.abspath(__file__))
STATES = 5
MOST = 1e-9
# Scaled by its diagonal, a mass matrix whose smallest eigenvalue is below this is singular.
SINGULAR = 1e-12
# Arrays that are so small beside the forces of the same state vanish in exact arithmetic: they are compared with the forces.
ROUNDING = 1e-13


def robots_folder():
    for base in [sysconfig.get_path("purelib"), sysconfig.get_path("platlib"), *sys.path]:
        folder = os.path.join(base, "cmeel.prefix", "share", "example-robot-data", "robots")
        if os.path.isdir(folder):
            return folder
    return None


def is_fixed_base_robot(path):
    try:
        model = pin.buildModelFromUrdf(path)
    except Exception:  # Pinocchio raises what its parser raises.
        return False
    return model.nv > 0 and model.nq == model.nv


def listed(folder):
    """The committed list; says where the installed package has others."""
    names = open(os.path.join(HERE, "robots.txt")).read().split()
    found = []
    for place, _, files in os.walk(folder):
        paths = [os.path.join(place, file) for file in files if file.endswith(".urdf")]
        found += [os.path.relpath(path, folder) for path in paths if is_fixed_base_robot(path)]
    for name in sorted(set(found) - set(names)):
        print(f"not in robots.txt: {name}")
    missing = sorted(set(names) - set(found))
    for name in missing:
        print(f"not in the package: {name}")
    return [name for name in names if name not in missing], not missing


def run(command, **options):
    done = subprocess.run(command, capture_output=True, text=True, **options)
    if done.returncode != 0:
        raise RuntimeError(f"{os.path.basename(command[0])}: {done.stderr.strip()[-400:]}")
    return done.stdout


def build(gelenk, urdf, stem):
    module = stem + ".rs"
    run([gelenk, "generate", urdf, "--no-friction", "--ignore-mimic", "--output", module])
    text = open(module).read()
    has_forward = "pub fn forward_dynamics(" in text
    command = ["rustc", "--edition", "2024", "-A", "unexpected_cfgs", "-o", stem, os.path.join(HERE, "harness.rs")]
    command += ["--cfg", "has_forward_dynamics"] if has_forward else []
    run(command, env={**os.environ, "GELENK_MODULE": os.path.abspath(module)})
    return has_forward


def states(model):
    """Within the limits where there are some, else a turn to each side; velocities and accelerations of ±2, forces of ±10."""
    chance = random.Random(20_260_101)
    low, high = np.array(model.lowerPositionLimit), np.array(model.upperPositionLimit)
    bounded = (high > low) & (high - low < 100)
    low, high = np.where(bounded, low, -np.pi), np.where(bounded, high, np.pi)
    for _ in range(STATES):
        y = np.array([chance.uniform(a, b) for a, b in zip(low, high)])
        v, a = (np.array([chance.uniform(-2, 2) for _ in low]) for _ in range(2))
        yield y, v, a, np.array([chance.uniform(-10, 10) for _ in low])


def expected(model, data, y, v, a, u):
    gravity = pin.computeGeneralizedGravity(model, data, y).copy()
    upper = np.triu(pin.crba(model, data, y).copy())
    by_y, by_v, _ = (np.array(x) for x in pin.computeRNEADerivatives(model, data, y, v, a))
    return {
        "mass_matrix": upper + np.triu(upper, 1).T,
        "coriolis_forces": pin.nonLinearEffects(model, data, y, v) - gravity,
        "gravity_forces": -gravity,
        "inverse_dynamics": pin.rnea(model, data, y, v, a).copy(),
        "inverse_dynamics_by_y": by_y,
        "inverse_dynamics_by_v": by_v,
        "forward_dynamics": pin.aba(model, data, y, v, u).copy(),
    }


def is_singular(mass):
    diagonal = np.sqrt(np.maximum(np.diag(mass), 0))
    if diagonal.min() == 0:
        return True
    return np.linalg.eigvalsh(mass / np.outer(diagonal, diagonal)).min() < SINGULAR


def answers(binary, model):
    """For each state its arrays by name."""
    rows = [" ".join(repr(float(x)) for x in np.concatenate(state)) for state in states(model)]
    lines = iter(run([binary], input="\n".join(rows) + "\n").splitlines())
    n, m = (int(word) for word in next(lines).split())
    names = [next(lines) for _ in range(n)]
    if names != list(model.names)[1:] or m != n:
        raise RuntimeError(f"joints {names}, Pinocchio has {list(model.names)[1:]}")
    result = []
    for line in lines:
        name, *numbers = line.split()
        if name == "mass_matrix":
            result.append({})
        result[-1][name] = np.array([float(x) for x in numbers])
    return result


def relative_error(found, wanted, size):
    """Beside the largest entry; beside the forces, where both arrays are rounding."""
    largest = max(np.abs(found).max(), np.abs(wanted).max())
    scale = size if largest <= ROUNDING * size else np.abs(wanted).max()
    return np.abs(found - wanted).max() / scale


def compare(binary, model, has_forward):
    """Largest error of each array, and whether M is singular."""
    data, worst, singular = model.createData(), {}, False
    for state, found in zip(states(model), answers(binary, model), strict=True):
        wanted = expected(model, data, *state)
        singular |= is_singular(wanted["mass_matrix"])
        size = np.abs(wanted["inverse_dynamics"]).max()
        for name, array in wanted.items():
            if name == "forward_dynamics" and not has_forward:
                continue
            error = relative_error(found[name], array.ravel(), size)
            # A maximum of Python would drop a NaN.
            worst[name] = error if not error <= worst.get(name, 0.0) else worst.get(name, 0.0)
    return worst, singular


COLUMNS = {
    "mass_matrix": "M",
    "coriolis_forces": "k",
    "gravity_forces": "gravity",
    "inverse_dynamics": "inverse",
    "forward_dynamics": "forward",
    "inverse_dynamics_by_y": "∂/∂y",
    "inverse_dynamics_by_v": "∂/∂v",
}


def row(gelenk, folder, work, name):
    """The line of the table, and whether the robot agrees."""
    stem = os.path.join(work, name.removesuffix(".urdf").replace("/", "__"))
    model = pin.buildModelFromUrdf(os.path.join(folder, name))
    try:
        has_forward = build(gelenk, os.path.join(folder, name), stem)
        errors, singular = compare(stem, model, has_forward)
    except RuntimeError as wrong:
        return f"{name:64} {wrong}", False
    agrees = all(error <= MOST for error in errors.values()) and (has_forward or singular)
    cells = [f"{errors[key]:9.1e}" if key in errors else f"{'singular' if singular else 'MISSING':>9}" for key in COLUMNS]
    return f"{name:64} {model.nv:3} {' '.join(cells)}{'' if agrees else '   DIFFERS'}", agrees


def main(gelenk, work, *choice):
    folder = robots_folder()
    if folder is None:
        print("skipped: no robots; `pip install example-robot-data` brings them")
        return 0
    os.makedirs(work, exist_ok=True)
    names, complete = listed(folder)
    names = [name for name in names if not choice or any(part in name for part in choice)]
    print(f"{'robot':64}   n {' '.join(f'{title:>9}' for title in COLUMNS.values())}")
    agreeing = 0
    for name in names:
        line, agrees = row(gelenk, folder, work, name)
        agreeing += agrees
        print(line, flush=True)
    print(f"{agreeing} of {len(names)} robots agree with Pinocchio {pin.__version__} to {MOST:g}")
    return 0 if agreeing == len(names) and complete else 1


if len(sys.argv) < 3:
    sys.exit(__doc__)
sys.exit(main(*sys.argv[1:]))
