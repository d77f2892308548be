"""What several tests need. `GELENK_PROGRAM` names the program where it is not installed with the package."""

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


@pytest.fixture(scope="session", autouse=True)
def cache(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """A cache of its own for each run."""
    folder = tmp_path_factory.mktemp("cache")
    os.environ["GELENK_CACHE"] = str(folder)
    return folder


def write(file: Path, text: str) -> Path:
    """Writes a file as somebody did a while ago: what was written just now is not yet cached."""
    file.write_text(text, "utf-8")
    os.utime(file, (1_700_000_000, 1_700_000_000))
    return file


@pytest.fixture(scope="session")
def arm_file(tmp_path_factory: pytest.TempPathFactory) -> Path:
    return write(tmp_path_factory.mktemp("arm") / "arm.toml", ARM)


@pytest.fixture(scope="session")
def arm(arm_file: Path, cache: Path) -> gelenk.Robot:
    return gelenk.load(arm_file)


@pytest.fixture(scope="session")
def powercube(cache: Path) -> gelenk.Robot:
    """A robot with free parameters."""
    return gelenk.load(MODELS / "powercube_parameters.toml")


@pytest.fixture(scope="session")
def reference() -> Path:
    """The folder of values that nobody here computed."""
    return MODELS.parent / "tests" / "reference"
