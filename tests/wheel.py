#!/usr/bin/env python3
"""Builds the wheel of the Python package, installs it in a fresh environment, and runs it without Cargo.

    python3 tests/wheel.py             builds the wheel with maturin, without optimization
    python3 tests/wheel.py FOLDER      takes the wheel in the folder

The mass matrix of the PowerCube is compared with the published one. What is built goes to target/wheel.
"""
import os
import shutil
import subprocess
import sys
import venv
from pathlib import Path

ROOT = Path(__file__).resolve().parents[1]
PLACE = Path(os.environ.get("CARGO_TARGET_DIR", ROOT / "target")).resolve() / "wheel"
SCRIPTS = "Scripts" if os.name == "nt" else "bin"
CHECK = """
import importlib.metadata, json, sys, gelenk
robot = gelenk.load("powercube.toml", functions=["mass_matrix"])
for sample in json.load(open(sys.argv[1]))["samples"]:
    error = abs(robot.mass_matrix(sample["y"]) - sample["M"]).max()
    assert error < 1e-12, error
print(f"gelenk {importlib.metadata.version('gelenk')}: the PowerCube's mass matrix is the published one")
"""


def environment(name: str) -> Path:
    """The folder with the programs of an environment without packages."""
    venv.create(PLACE / name, clear=True, with_pip=True)
    return PLACE / name / SCRIPTS


def install(programs: Path, package: str) -> None:
    pip = [programs / "python", "-m", "pip", "install", "--quiet", "--disable-pip-version-check", "--only-binary", ":all:"]
    subprocess.run([*pip, package], check=True)


def built() -> Path:
    folder = PLACE / "dist"
    shutil.rmtree(folder, ignore_errors=True)
    tools = environment("tools")
    install(tools, "maturin>=1.7,<2")
    command = [tools / "maturin", "build", "--profile", "dev", "--locked", "--out", folder]
    subprocess.run(command, cwd=ROOT / "codegen/python", check=True)
    return folder


def without_cargo(programs: Path) -> dict[str, str]:
    folders = [folder for folder in os.get_exec_path() if not shutil.which("cargo", path=folder)]
    kept = {key: value for key, value in os.environ.items() if not key.startswith(("CARGO", "RUST", "PYTHON", "GELENK"))}
    return kept | {"PATH": os.pathsep.join([str(programs), *folders]), "GELENK_CACHE": str(PLACE / "cache")}


def main() -> None:
    folder = Path(sys.argv[1]).resolve() if len(sys.argv) > 1 else built()
    [wheel] = folder.glob("*.whl")
    programs = environment("clean")
    install(programs, str(wheel))
    work, variables = PLACE / "work", without_cargo(programs)
    shutil.rmtree(work, ignore_errors=True)
    shutil.rmtree(PLACE / "cache", ignore_errors=True)
    work.mkdir()
    shutil.copy(ROOT / "models/powercube.toml", work)
    values = ROOT / "tests/reference/powercube/dynamics.json"
    for command in (["gelenk", "--version"], ["gelenk", "generate", "powercube.toml"], ["python", "-c", CHECK, values]):
        command[0] = shutil.which(command[0], path=programs)
        subprocess.run(command, cwd=work, env=variables, check=True)
    print(f"{wheel.name}: {wheel.stat().st_size / 1e6:.1f} MB")


main()
