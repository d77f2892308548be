"""The program's commands, type stubs and documentation."""

from __future__ import annotations

import ast
from pathlib import Path

import gelenk
import numpy as np
import pytest

from conftest import ARM


def test_generate_and_report_return_what_they_wrote(arm_file: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.chdir(tmp_path)
    assert gelenk.generate(arm_file, functions=["mass_matrix"]) == [Path("arm.rs")]
    written = gelenk.generate(arm_file, tmp_path / "c", language="c", tools=["python"], control_model=50)
    names = sorted(path.name for path in written)
    assert all(path.is_file() for path in written)
    assert names == sorted(f"arm{end}" for end in [".c", ".h", "_python.c", "_control.c", "_control.h", "_control_python.c"])
    page = gelenk.report(arm_file, tmp_path / "page", smooth_sign=100)
    assert page == tmp_path / "page" / "index.html" or page == Path("page/index.html")
    assert "<html" in page.read_text("utf-8")


def test_what_was_identified_is_loaded_again(tmp_path: Path) -> None:
    """A plan, a simulated log with the robot's true friction, and the description that comes back."""
    truth = gelenk.load(_described(tmp_path / "truth.toml", friction=0.7), functions=["inverse_dynamics"])
    guess = _described(tmp_path / "arm.toml", friction=0.2)
    plan = gelenk.plan(guess, tmp_path / "plan.csv", seconds=10, rate=200)
    columns = plan.read_text().splitlines()
    names = [name.strip() for name in columns[0].split(",")]
    rows = np.loadtxt(plan, delimiter=",", skiprows=1)
    time, places = rows[:, 0], [names.index(f"q_{each}") for each in ("shoulder", "elbow")]
    y = rows[:, places]
    v = np.gradient(y, time, axis=0)
    a = np.gradient(v, time, axis=0)
    torques = truth.inverse_dynamics(y, v, a) + np.random.default_rng(9).normal(0, 0.02, y.shape)
    log = tmp_path / "log.csv"
    table = np.column_stack([time, y, torques])
    np.savetxt(log, table, delimiter=",", comments="", header="time,position_shoulder,position_elbow,torque_shoulder,torque_elbow")
    found = gelenk.identify(guess, log, tmp_path / "found.toml", effort="joint")
    assert [joint["name"] for joint in found.found["joints"]] == ["shoulder", "elbow"]
    again = gelenk.load(found.description, functions=["inverse_dynamics", "friction_torques"])
    error = again.inverse_dynamics(y, v, a) - truth.inverse_dynamics(y, v, a)
    assert np.abs(error).max() < 0.05 * np.abs(torques).max()
    assert again.friction_torques(np.array([0.0, 1.0]))[1] == pytest.approx(0.7, rel=0.05)


def _described(file: Path, friction: float) -> Path:
    limits = ", limits = { position = [-1.5, 1.5], velocity = 3.0, effort = 80 }"
    text = ARM.replace('axis = [0, 1, 0]', 'axis = [0, 1, 0]' + limits)
    file.write_text(text.replace("viscous = 0.2", f"viscous = {friction}"), "utf-8")
    return file


def test_documentation_has_equations_shapes_and_units(powercube: gelenk.Robot) -> None:
    text = powercube.linearize.__doc__
    for part in [
        "    ÿ ≈ A_y y + A_v ẏ + B_x u + c",
        "y : (..., 2)\n    coordinates: beta, gamma in rad\n",
        "g : (...)\n    gravity (m/s²); described as 9.80665\n",
        "a_y, A_y : (..., 2, 2)\n    ∂ÿ/∂y, row i = acceleration i\n",
        "Cost: ",
    ]:
        assert part in text, part
    result = powercube.linearize(np.zeros(2), np.zeros(2), np.zeros(2))
    assert result._fields == ("a_y", "a_v", "b_x", "c") and type(result).__name__ == "Linearize"
    assert type(result).a_y.__doc__ == "A_y: ∂ÿ/∂y, row i = acceleration i"


def test_a_stub_is_python_and_names_everything(powercube: gelenk.Robot) -> None:
    tree = ast.parse(powercube.stub())
    classes = {each.name: each for each in tree.body if isinstance(each, ast.ClassDef)}
    robot = classes["PowercubeParameters"]
    functions = {each.name: each for each in robot.body if isinstance(each, ast.FunctionDef)}
    assert functions.keys() == set(powercube.FUNCTIONS)
    assert [each.arg for each in functions["step"].args.args] == ["y", "v", "u", "period"]
    assert [each.arg for each in functions["step"].args.kwonlyargs][:2] == ["parameters", "g"]
    assert "Linearize" in classes
    constants = {each.target.id for each in robot.body if isinstance(each, ast.AnnAssign)}
    assert {"JOINT_NAMES", "POSITION_LIMITS", "N", "SUBSTEPS"} <= constants
