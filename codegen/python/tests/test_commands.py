"""The program's commands, type stubs and documentation."""

from __future__ import annotations

import ast
import inspect
import re
import subprocess
from pathlib import Path

import gelenk
import numpy as np
import pytest

from gelenk import _program

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


# Options that are separate functions, options of other functions, and options of the command line only.
ALONE = {"format", "help"}
OF_PLANS = {"seconds", "rate", "acceleration", "position_share", "speed_share", "effort_share", "harmonics", "seed",
            "start", "turn"}
OF_ANOTHER_FUNCTION = {
    "generate": set(),
    "load": {"output", "language", "for", "self_test", "control_model"},
    "report": set(),
    "identify": {"plan", "reduce", "online", *OF_PLANS},
    "online": {"plan", "reduce", "merge", "online", "output", "bandwidth", "validate", "payload", "payload_on", "load_friction",
               "friction_on", "friction", "method", "threshold", "derivative", "accept_poor", *OF_PLANS},
    "plan": {"plan", "reduce", "merge", "online", "report", "columns", "hold", "separator", "effort", "gravity_compensated", "bandwidth", "delay",
             "validate", "payload", "payload_on", "load_friction", "friction", "method", "threshold", "derivative", "accept_poor"},
    "reduce": {"plan", "reduce", "merge", "online", "report", "validate", "payload", "payload_on", "load_friction", "friction",
               "method", "threshold", "derivative", *OF_PLANS},
    "merge": {"plan", "reduce", "merge", "online", "report", "columns", "hold", "separator", "effort", "gravity_compensated", "bandwidth", "delay",
              "validate", "payload", "payload_on", "load_friction", "friction", "method", "threshold", "derivative",
              "accept_poor", *OF_PLANS},
}


@pytest.mark.parametrize("function", OF_ANOTHER_FUNCTION)
def test_every_switch_of_the_program_is_a_keyword(function: str) -> None:
    command = {"load": "generate", "online": "identify", "plan": "identify", "reduce": "identify", "merge": "identify"}.get(function, function)
    text = subprocess.run([_program.find(), command, "--help"], capture_output=True, encoding="utf-8", check=True).stdout
    switches = {word.replace("-", "_") for word in re.findall(r"^ +(?:-\w, )?--([a-z-]+)", text, re.MULTILINE)}
    expected = switches - ALONE - OF_ANOTHER_FUNCTION[function]
    renamed = {"tools": "for"} if function == "generate" else {}
    arguments = inspect.signature(getattr(gelenk, function)).parameters
    keywords = {renamed.get(name, name) for name in arguments} - {"description", "logs", "moments"}
    assert keywords == expected


def test_moments_are_reduced_merged_and_identified(tmp_path: Path) -> None:
    """Two logs that are reduced separately give the results of both logs together."""
    arm = _described(tmp_path / "arm.toml", friction=0.2)
    logs = [_simulated_log(tmp_path, friction=0.7, seed=seed) for seed in (1, 2)]
    moments = [gelenk.reduce(arm, log, log.with_suffix(".moments"), effort="joint", bandwidth=10, delay=0) for log in logs]
    merged = gelenk.merge(arm, moments, tmp_path / "both.moments")
    by_parts = gelenk.identify(arm, merged, tmp_path / "parts.toml", merge=True)
    both = gelenk.reduce(arm, logs, tmp_path / "whole.moments", effort="joint", bandwidth=10, delay=0)
    at_once = gelenk.identify(arm, both, tmp_path / "whole.toml", merge=True)
    assert by_parts.found["joints"] == at_once.found["joints"]
    with pytest.raises(ValueError, match="reduce and merge write"):
        gelenk.identify(arm, logs, tmp_path / "all.moments")
    with pytest.raises(ValueError, match="not arm_identified.toml"):
        gelenk.merge(arm, moments, "arm_identified.toml")


def test_poor_logs_are_reduced_where_they_are_accepted(tmp_path: Path) -> None:
    """Torques in mN m exceed the described limits by far."""
    arm = _described(tmp_path / "arm.toml", friction=0.2)
    log = _simulated_log(tmp_path, friction=0.7, seed=3)
    header, *rows = log.read_text().splitlines()
    table = np.loadtxt(rows, delimiter=",") * [1, 1, 1, 1000, 1000]
    np.savetxt(log, table, delimiter=",", comments="", header=header)
    with pytest.raises(gelenk.GelenkError, match="the described limits are"):
        gelenk.reduce(arm, log, tmp_path / "log.moments", effort="joint")
    moments = gelenk.reduce(arm, log, tmp_path / "log.moments", effort="joint", accept_poor=True)
    assert moments.exists()


def test_what_was_identified_is_loaded_again(tmp_path: Path) -> None:
    """Identifies a description from a plan and a simulated log with the true friction of the robot."""
    guess = _described(tmp_path / "arm.toml", friction=0.2)
    log = _simulated_log(tmp_path, friction=0.7, seed=9)
    found = gelenk.identify(guess, log, tmp_path / "found.toml", effort="joint")
    assert [joint["name"] for joint in found.found["joints"]] == ["shoulder", "elbow"]
    again = gelenk.load(found.description, functions=["inverse_dynamics", "friction_torques"])
    truth = gelenk.load(_described(tmp_path / "truth.toml", friction=0.7), functions=["inverse_dynamics"])
    y, v, a = _planned(tmp_path / "plan.csv")
    torques = truth.inverse_dynamics(y, v, a)
    assert np.abs(again.inverse_dynamics(y, v, a) - torques).max() < 0.05 * np.abs(torques).max()
    assert again.friction_torques(np.array([0.0, 1.0]))[1] == pytest.approx(0.7, rel=0.05)


def test_friction_is_learned_online(tmp_path: Path) -> None:
    """The true friction is 0.7 N m s/rad at the elbow, the described friction is 0.6."""
    guess = _described(tmp_path / "arm.toml", friction=0.6)
    log = _simulated_log(tmp_path, friction=0.7, seed=9)
    elbow = gelenk.online(guess, log, effort="joint")["joints"][1]
    friction = elbow["friction"]
    assert friction["described"] == pytest.approx(0.6 * friction["speed"])
    assert friction["learned"] == pytest.approx(0.7 * friction["speed"], rel=0.05)
    assert elbow["errors"]["learned"] < elbow["errors"]["described"]


def test_joints_that_a_log_leaves_out_are_held(tmp_path: Path) -> None:
    guess = _described(tmp_path / "arm.toml", friction=0.2)
    full = _simulated_log(tmp_path, friction=0.7, seed=4)
    y, v, a = _planned(tmp_path / "plan.csv")
    truth = gelenk.load(tmp_path / "truth.toml", functions=["inverse_dynamics"])
    moving = np.array([0.0, 1.0])
    torques = truth.inverse_dynamics(y * moving + [0.3, 0], v * moving, a * moving)
    time = np.loadtxt(full, delimiter=",", skiprows=1)[:, 0]
    log = tmp_path / "elbow.csv"
    table = np.column_stack([time, y[:, 1], torques[:, 1]])
    np.savetxt(log, table, delimiter=",", comments="", header="time,position_elbow,torque_elbow")
    found = gelenk.identify(guess, log, tmp_path / "found.toml", effort="joint", hold={"shoulder": 0.3})
    again = gelenk.load(found.description, functions=["friction_torques"])
    assert again.friction_torques(np.array([1.0, 1.0])) == pytest.approx([0.0, 0.7], rel=0.05)


def _simulated_log(folder: Path, friction: float, seed: int) -> Path:
    """Writes the log of a robot with this friction that follows a plan, with noise on its torques."""
    truth = gelenk.load(_described(folder / "truth.toml", friction), functions=["inverse_dynamics"])
    plan = gelenk.plan(folder / "truth.toml", folder / "plan.csv", seconds=10, rate=200)
    time = np.loadtxt(plan, delimiter=",", skiprows=1)[:, 0]
    y, v, a = _planned(plan)
    torques = truth.inverse_dynamics(y, v, a) + np.random.default_rng(seed).normal(0, 0.02, y.shape)
    log = folder / f"log_{seed}.csv"
    table = np.column_stack([time, y, torques])
    np.savetxt(log, table, delimiter=",", comments="", header="time,position_shoulder,position_elbow,torque_shoulder,torque_elbow")
    return log


def _planned(plan: Path) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Returns the positions of a plan, with their differences as velocities and accelerations."""
    names = [name.strip() for name in plan.read_text().splitlines()[0].split(",")]
    rows = np.loadtxt(plan, delimiter=",", skiprows=1)
    time, y = rows[:, 0], rows[:, [names.index(f"q_{each}") for each in ("shoulder", "elbow")]]
    v = np.gradient(y, time, axis=0)
    return y, v, np.gradient(v, time, axis=0)


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
    assert [each.arg for each in functions["step"].args.args] == ["self", "y", "v", "u", "period"]
    assert [each.arg for each in functions["step"].args.kwonlyargs][:3] == ["out", "parameters", "g"]
    assert "Linearize" in classes
    constants = {each.target.id for each in robot.body if isinstance(each, ast.AnnAssign)}
    assert {"JOINT_NAMES", "POSITION_LIMITS", "N", "SUBSTEPS"} <= constants
