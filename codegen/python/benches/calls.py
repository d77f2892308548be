"""Measures the time of a call from Python for one state, as a multiple of the time per state in a batch.

    GELENK_PROGRAM=target/release/gelenk PYTHONPATH=codegen/python/src python codegen/python/benches/calls.py

The printed time is the smallest of several measurements. On a machine that runs other programs the times are meaningless.
"""

from __future__ import annotations

import timeit
from pathlib import Path
from typing import Any, Callable

import gelenk
import numpy as np

MODELS = Path(__file__).resolve().parents[3] / "models"
STATES = 4000


def shortest(call: Callable[[], Any], count: int) -> float:
    return min(timeit.repeat(call, number=count, repeat=15)) / count


def main() -> None:
    rng = np.random.default_rng(0)
    for name in ("powercube", "ur5", "panda"):
        robot = gelenk.load(MODELS / f"{name}.toml", functions=["all"])
        values = {letter: rng.uniform(-1, 1, (STATES, robot.N)) for letter in "yva"}
        values["u"] = rng.uniform(-1, 1, (STATES, robot.M))
        for function, letters in [(robot.inverse_dynamics, "yva"), (robot.mass_matrix, "y"), (robot.linearize, "yvu")]:
            many = [values[letter] for letter in letters]
            single = [each[0] for each in many]
            one = shortest(lambda: function(*single), 3000)
            state = shortest(lambda: function(*many), 3) / STATES
            print(f"{name:10} {function.__name__:17} one call {1e9 * one:5.0f} ns, {one / state:5.1f} times a state of a batch")


if __name__ == "__main__":
    main()
