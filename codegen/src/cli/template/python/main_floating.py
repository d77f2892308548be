"""Lets the robot of robot.toml fall and tumble, and prints its motion."""

from pathlib import Path

import gelenk
import numpy as np

STEP = 1e-3
"""Step of the integration in s."""
STEPS = 1000
"""Number of steps."""
PRINTED = 100
"""Number of steps between two printed lines."""

robot = gelenk.load(Path(__file__).with_name("robot.toml"))


def inputs(y: np.ndarray, v: np.ndarray) -> np.ndarray:
    """Returns the inputs. Replace this function by your controller."""
    return np.zeros(robot.M)


def main() -> None:
    # The robot starts at its neutral positions, and its base turns at 1 rad/s about its x axis.
    y, v = np.array(robot.NEUTRAL), np.zeros(robot.N)
    v[3] = 1.0
    print("  ".join([f"{'t [s]':>8}", *(f"{name:>12}" for name in robot.POSITION_NAMES), f"{'energy [J]':>12}"]))
    for step in range(STEPS + 1):
        if step % PRINTED == 0:
            energy = robot.kinetic_energy(y, v) + robot.potential_energy(y)
            print("  ".join([f"{step * STEP:8.3f}", *(f"{angle:12.6f}" for angle in y), f"{energy:12.6f}"]))
        y, v = robot.step(y, v, inputs(y, v), STEP)


if __name__ == "__main__":
    main()
