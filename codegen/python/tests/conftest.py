"""Fixtures of several tests. `GELENK_PROGRAM` names the program if it is not installed with the package."""

from __future__ import annotations

import os
from pathlib import Path

import gelenk
import pytest

MODELS = Path(__file__).resolve().parents[3] / "models"

ARM = """\
name = "arm"
joints = [
    { name = "shoulder", axis = [0, 1, 0], drive = { gear_ratio = 100, rotor_inertia = 2e-5 } },
    { name = "elbow", axis = [0, 1, 0], origin = { xyz = [0, 0, 0.4] }, drive = "ideal", friction = { viscous = 0.2 } },
]
bodies = [
    { link = "shoulder", mass = 3.0, center_of_mass = [0, 0, 0.2], inertia = 0.04 },
    { link = "elbow", mass = 2.0, center_of_mass = [0, 0, 0.15], inertia = 0.02 },
]
"""

SEVEN = """\
name = "seven"
joints = [
    { name = "j1", axis = [0, 0, 1], origin = { xyz = [0, 0, 0.34] }, drive = "ideal", friction = { viscous = 0.5 } },
    { name = "j2", axis = [0, 1, 0], drive = "ideal", friction = { viscous = 0.5 } },
    { name = "j3", axis = [0, 0, 1], origin = { xyz = [0, 0, 0.4] }, drive = "ideal", friction = { viscous = 0.4 } },
    { name = "j4", axis = [0, -1, 0], drive = "ideal", friction = { viscous = 0.4 } },
    { name = "j5", axis = [0, 0, 1], origin = { xyz = [0, 0, 0.4] }, drive = "ideal", friction = { viscous = 0.3 } },
    { name = "j6", axis = [0, 1, 0], drive = "ideal", friction = { viscous = 0.2 } },
    { name = "j7", axis = [0, 0, 1], origin = { xyz = [0.02, 0, 0.126] }, drive = "ideal", friction = { viscous = 0.1 } },
]
bodies = [
    { link = "j1", mass = 5.1, center_of_mass = [0, -0.03, 0.12], inertia = { xx = 0.06, yy = 0.05, zz = 0.02 } },
    { link = "j2", mass = 4.3, center_of_mass = [0, 0.05, 0.06], inertia = { xx = 0.05, yy = 0.018, zz = 0.044, yz = 0.001 } },
    { link = "j3", mass = 3.2, center_of_mass = [0.01, 0.03, 0.13], inertia = { xx = 0.04, yy = 0.03, zz = 0.012 } },
    { link = "j4", mass = 2.9, center_of_mass = [0, 0.06, 0.03], inertia = { xx = 0.02, yy = 0.01, zz = 0.02 } },
    { link = "j5", mass = 1.7, center_of_mass = [0, 0.02, 0.08], inertia = { xx = 0.012, yy = 0.01, zz = 0.006 } },
    { link = "j6", mass = 1.6, center_of_mass = [0.01, 0, 0.02], inertia = { xx = 0.006, yy = 0.005, zz = 0.004 } },
    { link = "j7", mass = 0.8, center_of_mass = [0.01, 0, 0.05], inertia = { xx = 0.002, yy = 0.002, zz = 0.001 } },
]
frames = [{ name = "tool", link = "j7", origin = { xyz = [0, 0, 0.12] } }]
"""
"""An arm with seven axes, which `models/` does not have."""


@pytest.fixture(scope="session", autouse=True)
def cache(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """Uses a separate cache for each run."""
    folder = tmp_path_factory.mktemp("cache")
    os.environ["GELENK_CACHE"] = str(folder)
    return folder


def write(file: Path, text: str) -> Path:
    """Writes a file with an older time, because files that were written just now are not cached yet."""
    file.write_text(text, "utf-8")
    os.utime(file, (1_700_000_000, 1_700_000_000))
    return file


@pytest.fixture(scope="session")
def arm_file(tmp_path_factory: pytest.TempPathFactory) -> Path:
    return write(tmp_path_factory.mktemp("arm") / "arm.toml", ARM)


@pytest.fixture(scope="session")
def seven_file(tmp_path_factory: pytest.TempPathFactory) -> Path:
    return write(tmp_path_factory.mktemp("seven") / "seven.toml", SEVEN)


@pytest.fixture(scope="session")
def arm(arm_file: Path, cache: Path) -> gelenk.Robot:
    return gelenk.load(arm_file)


@pytest.fixture(scope="session")
def powercube(cache: Path) -> gelenk.Robot:
    """A robot with free parameters."""
    return gelenk.load(MODELS / "powercube_parameters.toml")


@pytest.fixture(scope="session")
def reference() -> Path:
    """Returns the folder of reference values from other programs."""
    return MODELS.parent / "tests" / "reference"
