#!/usr/bin/env python3
"""Writes the published equations of the PowerCube at the states of a file: needs NumPy.

    python make_powercube.py powercube/dynamics.json > out.json

The states y = (β, γ), v and u are those of the file; M, k, q, B and ẋ = (v, M⁻¹ (q + B u − k)) are computed anew from the
expressions of the Neweul-M² model (Nicodemus et al., 2022, MIT licence). SI units, radians.
"""
import json
import sys

import numpy as np

GEAR, ROTOR, H, G = 161.0, 5.267e-5, 0.3107549862, 9.80665


def values(y: np.ndarray, v: np.ndarray, u: np.ndarray) -> dict[str, np.ndarray]:
    cosine, sine = np.cos(y[1]), np.sin(y[1])
    m11 = ROTOR * GEAR**2 + 2 * H * cosine + 0.9560375168565
    m12 = ROTOR * GEAR + H * cosine + 0.6608899068565
    m22 = ROTOR * GEAR**2 + 0.6608899068565
    mass = np.array([[m11, m12], [m12, m22]])
    k = H * sine * np.array([-(2 * v[0] * v[1] + v[1] ** 2), v[0] ** 2])
    gravity = np.array([1.626138 * np.sin(y[0]), 0]) * G + 1.72641659 * G * np.sin(y[0] + y[1])
    beta = 76.556 * v[0] + np.array([3.924, 10.838, 2.236]) @ np.tanh(np.array([5, 10, 20]) * v[0])
    gamma = 56.231 * v[1] + np.array([0.368, 0.368, 8.342]) @ np.tanh(np.array([5, 10, 100]) * v[1]) + 0.492 * np.sign(v[1])
    q, b = gravity - np.array([beta, gamma]), GEAR * np.eye(2)
    return dict(M=mass, k=k, q=q, B=b, xdot=np.concatenate([v, np.linalg.solve(mass, q + b @ u - k)]))


def main() -> None:
    with open(sys.argv[1], encoding="utf-8") as file:
        told = json.load(file)
    for sample in told["samples"]:
        found = values(*(np.array(sample[key]) for key in ("y", "v", "u")))
        sample.update((key, value.tolist()) for key, value in found.items())
    json.dump(told, sys.stdout)


main()
