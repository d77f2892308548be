"""Pinocchio's robots with quaternions as descriptions."""

from __future__ import annotations

import json
from pathlib import Path
from typing import Any

import numpy as np

TYPES = {
    "FreeFlyer": "floating", "Spherical": "spherical", "HelicalUnaligned": "helical", "PrismaticUnaligned": "prismatic",
    "Planar": "planar", "RevoluteUnaligned": "revolute", "RX": "revolute", "RY": "revolute", "RZ": "revolute",
}


def quaternion(r: np.ndarray) -> np.ndarray:
    """Returns the quaternion x y z w of a rotation matrix: an eigenvector of Bar-Itzhack's matrix."""
    k = np.zeros((4, 4))
    k[:3, :3] = r + r.T - np.trace(r) * np.eye(3)
    k[3, :3] = k[:3, 3] = [r[2, 1] - r[1, 2], r[0, 2] - r[2, 0], r[1, 0] - r[0, 1]]
    k[3, 3] = np.trace(r)
    return np.linalg.eigh(k)[1][:, -1]


def description(file: Path) -> str:
    """Every velocity has an ideal drive, so that inputs are the forces at all joints."""
    joints = json.loads(file.read_text())["joints"]
    lines = [f'name = "{file.stem}"']
    for joint in joints:
        parent = "base" if joint["parent"] < 0 else joints[joint["parent"]]["name"]
        q = dict(zip("xyzw", quaternion(np.array(joint["R"])).tolist()))
        origin = ", ".join(f"{key} = {value!r}" for key, value in q.items())
        lines += ["[[joints]]", f'name = "{joint["name"]}"', f'parent = "{parent}"', f'type = "{TYPES[joint["type"]]}"']
        lines += ['drive = "ideal"', f"origin = {{ xyz = {joint['xyz']}, quaternion = {{ {origin} }} }}"]
        has_axis = joint["axis"] is not None and joint["type"] != "Planar"
        lines += [f"axis = {joint['axis']}"] if has_axis else []
        lines += [f"pitch = {joint['pitch']}"] if "pitch" in joint else []
        if joint["mass"] > 0:
            inertia = ", ".join(f"{key} = {value!r}" for key, value in zip(["xx", "xy", "yy", "xz", "yz", "zz"], joint["inertia"]))
            lines += ["[[bodies]]", f'name = "{joint["name"]}_body"', f'link = "{joint["name"]}"', f"mass = {joint['mass']!r}"]
            lines += [f"center_of_mass = {joint['com']}", f"inertia = {{ {inertia} }}"]
    return "\n".join([*lines, "[[frames]]", 'name = "last"', f'link = "{joints[-1]["name"]}"', ""])


def samples(file: Path) -> list[dict[str, Any]]:
    return [{key: np.array(value) for key, value in each.items()} for each in json.loads(file.read_text())["samples"]]


def small_motions(joints: np.ndarray, y: np.ndarray) -> np.ndarray:
    """Returns T(y) in ẏ = T(y) v, of shape NY x N: rates of the position entries per velocity."""
    ny, n = joints.sum(), sum(entries - (entries > 1) for entries in joints)
    rates = np.zeros((ny, n))
    row = column = 0
    for entries in joints:
        if entries == 1:
            rates[row, column] = 1
        else:
            x, y_, z, w = q = y[row + entries - 4 : row + entries]
            rotation = (w * w - q[:3] @ q[:3]) * np.eye(3) + 2 * np.outer(q[:3], q[:3])
            rotation += 2 * w * np.array([[0, -z, y_], [z, 0, -x], [-y_, x, 0]])
            turning = 0.5 * np.array([[w, -z, y_], [z, w, -x], [-y_, x, w], [-x, -y_, -z]])
            if entries == 7:
                rates[row : row + 3, column : column + 3] = rotation
            end = column + entries - 1
            rates[row + entries - 4 : row + entries, end - 3 : end] = turning
        row, column = row + entries, column + entries - (entries > 1)
    return rates


def planar_joints(file: Path) -> list[tuple[int, int]]:
    """Returns the first position and the first velocity of each joint in Pinocchio's coordinates."""
    joints = json.loads(file.read_text())["joints"]
    return [(joint["idx_q"], joint["idx_v"]) for joint in joints if joint["type"] == "Planar"]


class Planar:
    """A planar joint, whose velocities are in the body's frame in Pinocchio and in the parent's frame in gelenk."""

    def __init__(self, sample: dict[str, Any], position: int, velocity: int):
        self.position, self.velocity = position, velocity
        self.cosine, self.sine = sample["q"][position + 2 : position + 4]
        self.speeds = sample["v"][velocity : velocity + 3]

    def place(self, turn: np.ndarray, rate: np.ndarray, by_d: np.ndarray) -> None:
        """Returns the blocks of v = turn v', of d(turn)/dt, and of the derivative of ⊕, which is a sum for this joint."""
        first = self.velocity
        turn[first : first + 2, first : first + 2] = [[self.cosine, -self.sine], [self.sine, self.cosine]]
        rate[first : first + 2, first : first + 2] = self.speeds[2] * self.slope()
        by_d[first : first + 3, first : first + 3] = np.eye(3)

    def slope(self) -> np.ndarray:
        """Returns the derivative of the matrix `turn` with respect to the angle."""
        return np.array([[-self.sine, -self.cosine], [self.cosine, -self.sine]])

    def by_speed(self, n: int) -> np.ndarray:
        """Returns the derivative of d(turn)/dt v' with respect to the angular velocity."""
        column = np.zeros(n)
        column[self.velocity : self.velocity + 2] = self.slope() @ self.speeds[:2]
        return column


def without_cosines(q: np.ndarray, planars: list[Planar]) -> np.ndarray:
    """Positions with angles of planar joints."""
    y = list(q)
    for each in sorted(planars, key=lambda each: -each.position):
        y[each.position + 2 : each.position + 4] = [np.arctan2(each.sine, each.cosine)]
    return np.array(y)
