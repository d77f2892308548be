"""Tests the numbers of the example without its figures."""

from __future__ import annotations

import runpy
from pathlib import Path

import numpy as np

EXAMPLE = Path(__file__).resolve().parents[1] / "examples" / "arm.py"


def test_the_example_shows_what_it_says(cache: Path) -> None:
    example = runpy.run_path(str(EXAMPLE))
    robot = example["load"]()
    angles, torque = example["weight"](robot)
    assert torque.shape == (301, 301)
    # The gravity torque of the horizontal arm is Σ m g c over the links and the load.
    side, straight = np.argmin(np.abs(angles - np.pi / 2)), 150
    expected = 9.81 * (3 * 0.2 + 2 * 0.55 + 1 * 0.7) * np.sin(angles[side])
    assert abs(torque[side, straight] - expected) < 1e-9
    loads = np.array([0.0, 4.0])
    light, heavy = example["swings"](robot, loads, 500)
    assert light[0] == heavy[0] == 1.0 and heavy.min() < light.min() < 0, "a load carries the swing farther"
    without, with_model = (np.abs(example["tracking"](robot, model, 1000)).max() for model in (False, True))
    assert with_model < without / 10
