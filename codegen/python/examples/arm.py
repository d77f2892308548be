"""Draws three figures of an arm: its gravity torque over all positions, swings with nine loads, and tracking with feed-forward.

    pip install './codegen/python[plots]'
    python codegen/python/examples/arm.py arm.png
"""

from __future__ import annotations

import sys
from pathlib import Path

import gelenk
import numpy as np

PERIOD = 0.002


def weight(robot: gelenk.Robot) -> tuple[np.ndarray, np.ndarray]:
    """Returns the torque that holds the shoulder against gravity, over a grid of positions. One call computes all of them."""
    angles = np.linspace(-np.pi, np.pi, 301)
    grid = np.stack(np.meshgrid(angles, angles, indexing="ij"), axis=-1)
    return angles, -robot.gravity_forces(grid)[..., 0]


def swings(robot: gelenk.Robot, loads: np.ndarray, steps: int) -> np.ndarray:
    """Returns the angles of the shoulder without motor torques, one row per load. The motion starts at rest at 1 rad."""
    parameters = robot.pack_parameters(load=loads)
    y, v = np.broadcast_to([1.0, 0.5], (len(loads), 2)), np.zeros((len(loads), 2))
    angles = np.empty((len(loads), steps))
    for step in range(steps):
        angles[:, step] = y[:, 0]
        y, v = robot.step(y, v, np.zeros(robot.M), PERIOD, parameters=parameters)
    return angles


def tracking(robot: gelenk.Robot, with_model: bool, steps: int) -> np.ndarray:
    """Returns the tracking errors of the shoulder under a PD law, with or without feed-forward."""
    time = PERIOD * np.arange(steps)
    swing, rate = np.array([0.8, -0.5]), 2 * np.pi * 0.5
    wanted = swing * np.sin(rate * time)[:, None]
    velocities = swing * rate * np.cos(rate * time)[:, None]
    accelerations = -(rate**2) * wanted
    torques = robot.inverse_dynamics(wanted, velocities, accelerations) * with_model
    y, v, errors = wanted[0], velocities[0], np.empty(steps)
    for step in range(steps):
        errors[step] = y[0] - wanted[step, 0]
        feedback = -400 * (y - wanted[step]) - 40 * (v - velocities[step])
        u = (torques[step] + feedback) / robot.GEAR_RATIOS
        # The true load is 20 % heavier than the load of the model.
        y, v = robot.step(y, v, u, PERIOD, load=1.2)
    return errors


def load() -> gelenk.Robot:
    return gelenk.load(Path(__file__).with_name("arm.toml"), smooth_sign=50)


def draw(robot: gelenk.Robot, file: str) -> None:
    """Draws all three figures to a file."""
    import matplotlib

    matplotlib.use("Agg")
    import matplotlib.pyplot as plt

    figure, (left, middle, right) = plt.subplots(1, 3, figsize=(13, 4), layout="constrained")

    angles, torque = weight(robot)
    largest = np.abs(torque).max()
    mesh = left.pcolormesh(angles, angles, torque.T, cmap="RdBu", vmin=-largest, vmax=largest, shading="nearest")
    figure.colorbar(mesh, ax=left, label="torque that holds the shoulder [N m]")
    left.set(xlabel="shoulder [rad]", ylabel="elbow [rad]", title="Weight over 90 601 positions")

    loads = np.linspace(0, 4, 9)
    for load, row in zip(loads, swings(robot, loads, 3000)):
        middle.plot(PERIOD * np.arange(row.size), row, color=plt.cm.viridis(load / loads[-1]), label=f"{load:g} kg")
    middle.set(xlabel="time [s]", ylabel="shoulder [rad]", title="Swings by the load of the hand")
    middle.legend(fontsize="small", ncols=3)

    for with_model, label in [(False, "PD"), (True, "PD and feed-forward")]:
        errors = tracking(robot, with_model, 2000)
        right.plot(PERIOD * np.arange(errors.size), 1000 * errors, label=label)
    right.set(xlabel="time [s]", ylabel="error of the shoulder [mrad]", title="Tracking, 20 % more load than modelled")
    right.set_ylim(-16, 12)
    right.legend(loc="lower left")

    figure.savefig(file, dpi=110)
    print(f"wrote {file}")


if __name__ == "__main__":
    draw(load(), sys.argv[1] if len(sys.argv) > 1 else "arm.png")
