"""Batches from Python beside functions over eight states in Rust: time per state. `python_lanes.sh` calls it.

    python python_lanes.py LIBRARY...

Each library holds the functions of `python_lanes.rs` of the robot after which it is named. Calls alternate, and the
least time of each counts. Rust's states lie as it wants them. Python's are ordinary arrays, and each call makes new
results; Rust's results are written over and over into the same place, but for large batches are new too, since new memory
costs more than what is computed.
"""

from __future__ import annotations

import ctypes
import os
import sys
import time
from pathlib import Path
from typing import Any, Callable

import gelenk
import numpy as np

LANES = 8
MODELS = Path(__file__).resolve().parents[2] / "models"


def aligned(*shape: int) -> np.ndarray:
    """An array at the start of a cache line, as Rust's lanes ask for."""
    raw = np.empty(8 * int(np.prod(shape)) + 64, np.uint8)
    start = -raw.ctypes.data % 64
    return raw[start : len(raw) - 64 + start].view(np.float64).reshape(shape)


def side_by_side(states: np.ndarray) -> np.ndarray:
    """Blocks of eight states, entry by entry."""
    blocks = states.reshape(-1, LANES, states.shape[-1]).transpose(0, 2, 1)
    made = aligned(*blocks.shape)
    made[...] = blocks
    return made


def seconds(call: Callable[[], Any], count: int) -> float:
    start = time.perf_counter()
    for _ in range(count):
        call()
    return (time.perf_counter() - start) / count


def compare(robot: Any, library: ctypes.CDLL, name: str, states: int) -> None:
    rng = np.random.default_rng(states)
    last = robot.N if name == "inverse_dynamics" else robot.M
    arguments = [rng.uniform(-3, 3, (states, count)) for count in (robot.N, robot.N, last)]
    blocks = [side_by_side(each) for each in arguments]
    function = getattr(robot, name)
    expected = function(*arguments)
    expected = expected if isinstance(expected, tuple) else (expected,)
    call, count = getattr(library, name), ctypes.c_size_t(states // LANES)

    def places() -> tuple[list[np.ndarray], list[ctypes.c_void_p]]:
        results = [aligned(states // LANES, each[0].size, LANES) for each in expected]
        return results, [ctypes.c_void_p(each.ctypes.data) for each in blocks + results]

    results, pointers = places()
    call(count, *pointers)
    for found, wanted in zip(results, expected):
        same = found.transpose(0, 2, 1).reshape(states, -1) == wanted.reshape(states, -1)
        assert same.all(), f"{robot.name}: {name} has other numbers in Rust"

    def rust() -> None:
        call(count, *pointers)

    def rust_anew() -> None:
        _kept, new = places()
        call(count, *new)

    # One call at a time: the shorter, the likelier that no other work on the machine comes between.
    times = [
        (seconds(rust_anew if states > 10_000 else rust, 1), seconds(lambda: function(*arguments), 1))
        for _ in range(3_000_000 // states)
    ]
    least = [1e9 * min(each) / states for each in zip(*times)]
    ratio = float(np.median([mine / other for other, mine in times]))
    print(
        f"{robot.name:12} {name:17} {states:7} {least[0]:8.1f} {least[1]:8.1f} {least[1] / least[0]:8.2f} {ratio:8.2f}",
        flush=True,
    )


def single(robot: Any, name: str) -> None:
    last = robot.N if name == "inverse_dynamics" else robot.M
    state = [np.full(count, 0.5) for count in (robot.N, robot.N, last)]
    function = getattr(robot, name)
    least = min(seconds(lambda: function(*state), 50) for _ in range(1000))
    print(f"{robot.name:12} {name:17} one call {1e6 * least:.2f} µs", flush=True)


def main() -> None:
    print("load", *(f"{each:.1f}" for each in os.getloadavg()))
    print("robot        function           states  Rust ns  Python ns  ratio  median of the rounds' ratios")
    for file in map(Path, sys.argv[1:]):
        robot = gelenk.load(MODELS / f"{file.stem}.toml")
        library = ctypes.CDLL(str(file))
        for name in ("inverse_dynamics", "linearize"):
            for states in (1000, 100_000):
                compare(robot, library, name, states)
            single(robot, name)


if __name__ == "__main__":
    main()
