#!/usr/bin/env python3
"""Plain least squares in numpy beside `gelenk identify`, on halves of the measured runs of a Schunk LWA 4P.

usage: schunk.py GELENK DESCRIPTION DATA FOLDER

DATA is the folder of `runs.csv` and `model.json`. Each half is fitted, and the other half is predicted. Two kinds of halves: the first
14 runs and the last 14, which hold other motions, and every second run, so that both halves hold every motion. The columns are Pinocchio's
regressor (all inertial parameters, without gravity, which the robot compensates), reflected inertia, viscous friction, Coulomb friction
tanh(v / 0.02 rad/s) and an offset for each joint; least squares is numpy's, with singular values below 1e-4 of the largest cut off.

The description that `gelenk identify` writes for a half is read back, and its torques are Pinocchio's with the identified bodies. So one
yardstick serves both: R², centred, on the same signals of the unseen half, over the samples in which the joint moves. Signals pass a Gaussian
filter of 5 Hz, the bandwidth that the command finds here for halves which hold every motion: what is above it is vibration, which no rigid
arm explains. Exit code 1 where the command is worse than least squares at a joint by more than 0.002, which is the difference that another
filter makes.
"""
import csv
import json
import os
import subprocess
import sys
import tomllib

import numpy as np
import pinocchio as pin

JOINTS = 6
BANDWIDTH = 5.0  # Hz, where the filter halves an amplitude
STEP = 0.004  # s
SLOW = 0.02  # share of a joint's largest speed below which it rests
COULOMB = 0.02  # rad/s
CUT = 1e-4
MARGIN = 0.002
OPTIONS = ["--gravity-compensated", "--effort", "joint", "--format", "json"]


def read(path):
    """Header, and the rows of each run; the last row of a run has no torque."""
    with open(path, encoding="utf-8") as file:
        rows = csv.reader(file)
        header, runs = next(rows), {}
        for row in rows:
            runs.setdefault(row[0], []).append(row)
    return header, list(runs.values())


def smooth(columns):
    deviation = np.sqrt(0.5 * np.log(2)) / (np.pi * BANDWIDTH) / STEP
    reach = int(4 * deviation)
    window = np.exp(-0.5 * (np.arange(-reach, reach + 1) / deviation) ** 2)
    return np.apply_along_axis(lambda column: np.convolve(column, window / window.sum(), "valid"), 0, columns)


def prepare(rows):
    """Positions, velocities, accelerations and torques of a run, smoothed alike."""
    values = np.array(rows[:-1], float)
    step = np.median(np.diff(values[:, 1]))
    positions, torques = smooth(values[:, 2:8]), smooth(values[:, 14:20])
    velocities = np.gradient(positions, step, axis=0)
    accelerations = np.gradient(velocities, step, axis=0)
    return [column[2:-2] for column in (positions, velocities, accelerations, torques)]


def frames(path):
    """Poses of the joints' frames, each in the one before, and the described inertias."""
    with open(path, encoding="utf-8") as file:
        joints = json.load(file)["joints"]
    poses, inertias = [pin.SE3.Identity()], []
    for joint in joints:
        rotation = np.array(joint["next_frame_rotation"]).reshape(3, 3)
        poses.append(pin.SE3(rotation, np.array(joint["next_frame_position"])))
        moments = np.array(joint["inertia_about_com"]).reshape(3, 3)
        inertias.append(pin.Inertia(joint["mass"], np.array(joint["com"]), moments))
    return poses[:JOINTS], inertias


def robot_of(poses, inertias):
    """The arm without gravity, which the robot compensates."""
    robot, parent = pin.Model(), 0
    robot.gravity.linear[:] = 0
    for index, (pose, inertia) in enumerate(zip(poses, inertias)):
        parent = robot.addJoint(parent, pin.JointModelRZ(), pose, f"joint_{index + 1}")
        robot.appendBodyToJoint(parent, inertia, pin.SE3.Identity())
    return robot


def with_weight(robot):
    robot = robot.copy()
    robot.gravity.linear[:] = [0, 0, -9.80665]
    return robot


def regressor(robot, run):
    """Columns [samples × joints × unknowns]."""
    positions, velocities, accelerations, _ = run
    data = robot.createData()
    inertial = [pin.computeJointTorqueRegressor(robot, data, *state) for state in zip(positions, velocities, accelerations)]
    terms = [accelerations, velocities, np.tanh(velocities / COULOMB), np.ones_like(velocities)]
    own = [np.einsum("ij,jk->ijk", term, np.eye(JOINTS)) for term in terms]
    return np.concatenate([np.array(inertial), *own], axis=2)


def least_squares(columns, torques):
    """Each joint weighed by the deviation of its torque; columns of unit length."""
    weights = 1 / torques.std(axis=0)
    a = (columns * weights[None, :, None]).reshape(-1, columns.shape[2])
    norms = np.linalg.norm(a, axis=0)
    norms[norms == 0] = 1
    solution, *_ = np.linalg.lstsq(a / norms, (torques * weights).ravel(), rcond=CUT)
    return solution / norms


class Identified:
    """The description that the command wrote."""

    def __init__(self, path, poses, compensated):
        with open(path, "rb") as file:
            text = tomllib.load(file)
        self.robot = robot_of(poses, [self.inertia(body) for body in text["bodies"]])
        self.joints = text["joints"]
        self.weights = [with_weight(robot) for robot in (self.robot, compensated)]

    @staticmethod
    def inertia(body):
        i = body["inertia"]
        moments = [[i["xx"], i["xy"], i["xz"]], [i["xy"], i["yy"], i["yz"]], [i["xz"], i["yz"], i["zz"]]]
        return pin.Inertia(body["mass"], np.array(body["center_of_mass"]), np.array(moments))

    def torques(self, run):
        positions, velocities, accelerations, _ = run
        data = self.robot.createData()
        forces = [pin.rnea(self.robot, data, *state) for state in zip(positions, velocities, accelerations)]
        drives = [self.drive(j, velocities[:, j], accelerations[:, j]) for j in range(JOINTS)]
        return np.array(forces) + np.stack(drives, axis=1) + self.weight_left(positions)

    def weight_left(self, positions):
        """What the found bodies weigh beyond those that the robot compensates."""
        if not self.is_weighed:
            return 0
        left = [[pin.computeGeneralizedGravity(robot, robot.createData(), y) for y in positions] for robot in self.weights]
        return np.array(left[0]) - np.array(left[1])

    def drive(self, joint, v, a):
        """Reflected inertia and friction."""
        drive = self.joints[joint]["drive"]
        names = {"v": v, "tanh": np.tanh, "abs": np.abs, "sign": np.sign, "__builtins__": {}}
        terms = self.joints[joint]["friction"]["terms"]
        friction = sum(coefficient * eval(basis, names) for basis, coefficient in terms)
        return drive["rotor_inertia"] * drive["gear_ratio"] ** 2 * a + friction


def command(program, description, header, halves, folder, name, poses, compensated):
    """What `gelenk identify` writes for one half, with its own R² on the other."""
    files = []
    for part, rows in zip(("fit", "unseen"), halves):
        files.append(os.path.join(folder, f"{name}_{part}.csv"))
        with open(files[-1], "w", encoding="utf-8", newline="") as file:
            csv.writer(file).writerows([header, *(row for run in rows for row in run)])
    output = os.path.join(folder, f"{name}.toml")
    arguments = [program, "identify", description, files[0], "--validate", files[1], "--output", output, *OPTIONS]
    done = subprocess.run(arguments, capture_output=True, text=True, check=False)
    if done.returncode != 0:
        # Joints that half a log does not explain are said; the command writes them where it is told to.
        print(f"{name}: {done.stderr.strip().splitlines()[-1]}")
        done = subprocess.run([*arguments, "--accept-poor"], capture_output=True, text=True, check=True)
    found = json.loads(done.stdout)
    identified = Identified(output, poses, compensated)
    identified.is_weighed = found["gravity"] == "compensated as described"
    return identified, found


def r_squared(errors, torques, velocities):
    """Of each joint, over the samples in which it moves."""
    moves = np.abs(velocities) > SLOW * np.abs(velocities).max(0)
    of_joint = lambda j: 1 - (errors[moves[:, j], j] ** 2).sum() / torques[moves[:, j], j].var() / moves[:, j].sum()
    return np.array([of_joint(j) for j in range(JOINTS)])


def compare(name, fit, unseen, of_program, runs, columns):
    """R² of both on the unseen half."""
    identified, found = of_program
    together = lambda part, of: np.concatenate([of(k) for k in part])
    torques = {part: together(part, lambda k: runs[k][3]) for part in (fit, unseen)}
    solution = least_squares(together(fit, lambda k: columns[k]), torques[fit])
    velocities = together(unseen, lambda k: runs[k][1])
    plain = r_squared(torques[unseen] - together(unseen, lambda k: columns[k]) @ solution, torques[unseen], velocities)
    # Offsets are not written: each joint's is the mean of what is left of the half that was fitted.
    left = {part: torques[part] - together(part, lambda k: identified.torques(runs[k])) for part in (fit, unseen)}
    ours = r_squared(left[unseen] - left[fit].mean(0), torques[unseen], velocities)
    own = [joint["r_squared"] for joint in found["validation"]]
    show = lambda values: " ".join("       –" if value is None else f"{value:8.4f}" for value in values)
    print(f"{name}\n  numpy, least squares             {show(plain)}")
    print(f"  gelenk identify, same yardstick  {show(ours)}\n  gelenk identify --validate       {show(own)}")
    print("  " + "; ".join(joint["friction"] for joint in found["joints"]))
    return [f"{name}: joint {j + 1}: {ours[j]:.4f} instead of {plain[j]:.4f}" for j in range(JOINTS) if ours[j] < plain[j] - MARGIN]


def main():
    program, description, data, folder = sys.argv[1:]
    os.makedirs(folder, exist_ok=True)
    header, rows = read(os.path.join(data, "runs.csv"))
    poses, described = frames(os.path.join(data, "model.json"))
    robot = robot_of(poses, described)
    runs = [prepare(run) for run in rows]
    columns = [regressor(robot, run) for run in runs]
    middle, end = len(runs) // 2, len(runs)
    first, last = tuple(range(middle)), tuple(range(middle, end))
    even, odd = tuple(range(0, end, 2)), tuple(range(1, end, 2))
    halves = [("even to odd runs", even, odd), ("odd to even runs", odd, even)]
    halves += [("first to last runs", first, last), ("last to first runs", last, first)]
    worse = []
    for name, fit, unseen in halves:
        parts = [[rows[k] for k in part] for part in (fit, unseen)]
        found = command(program, description, header, parts, folder, name.replace(" ", "_"), poses, robot)
        worse += compare(name, fit, unseen, found, runs, columns)
    for line in worse:
        print(f"worse: {line}")
    return 1 if worse else 0


if __name__ == "__main__":
    sys.exit(main())
