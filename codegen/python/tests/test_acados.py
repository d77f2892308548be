"""Discrete dynamics for acados: values, Jacobians, limits, and robots that its solver controls."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import gelenk
import numpy as np
import pytest

import acados_wheel
from blasfeo import Externals
from conftest import MODELS

if not acados_wheel.find():
    pytest.skip("acados is not installed", allow_module_level=True)
ca = pytest.importorskip("casadi", reason="casadi is not installed")

ARM = """\
name = "arm"
gravity = [0, 0, "-g"]
joints = [
    { name = "a", axis = [0, 1, 0], drive = "ideal", friction = { viscous = 0.3 } },
    { name = "b", axis = [0.6, 0.8, 0], origin = { xyz = [0.1, 0, 0.4] }, drive = "ideal" },
    { name = "c", axis = [1, 0, 0], origin = { xyz = [0, 0, 0.2] } },
]
bodies = [
    { link = "a", mass = 3.0, center_of_mass = [0, 0, 0.2], inertia = 0.04 },
    { link = "b", mass = "load", center_of_mass = [0, 0.05, 0.15], inertia = 0.02 },
    { link = "c", mass = 0.5, center_of_mass = [0, 0.05, 0.15], inertia = 0.01 },
]
generate = { substeps = 3 }
parameters = { g = 9.81, load = 2.0 }
"""


@pytest.fixture(scope="module")
def arm_with_parameters(tmp_path_factory: pytest.TempPathFactory, cache: Path) -> Path:
    """Three coordinates, two inputs, two parameters."""
    file = tmp_path_factory.mktemp("arm") / "arm.toml"
    file.write_text(ARM, "utf-8")
    return file


PERIOD, INTERVALS = 0.02, 15


class Problem:
    """Returns a compiled solver that tracks a reference, with soft bounds of the states. Errors vanish in tenths of a second."""

    def __init__(self, robot: str, description: Path, folder: Path):
        description = description if robot == "arm" else MODELS / f"{robot}.toml"
        functions = ["step", "step_derivatives", "inverse_dynamics"]
        # The same module, compiled separately.
        self.casadi = gelenk.casadi(description, functions=functions, smooth_sign=50)
        self.module = module = gelenk.acados(description, smooth_sign=50)
        self.ocp = module.ocp(INTERVALS, PERIOD, compile_flags="-O1")
        limits = self.ocp.constraints
        self.most = limits.ubu if limits.ubu.size else np.full(module.M, 100.0)
        weights = [np.repeat([1e4, 1e2], module.N) / PERIOD, 1e-3 / self.most**2 / PERIOD]
        module.track(self.ocp, *weights, terminal_weight=10 * weights[0] * PERIOD)
        module.soften(self.ocp, 1e4 / PERIOD, 1e5 / PERIOD)
        self.ocp.code_export_directory = str(folder / "generated")
        self.solver = module.solver(self.ocp, json_file=str(folder / "ocp.json"), verbose=False)


@pytest.fixture(scope="module")
def problem(request: Any, arm_with_parameters: Path, tmp_path_factory: pytest.TempPathFactory) -> Problem:
    return Problem(request.param, arm_with_parameters, tmp_path_factory.mktemp(request.param))


def runge_kutta(dynamics: Any, x: Any, u: Any, period: float, steps: int, p: list[Any]) -> Any:
    """Runge–Kutta step in CasADi, which differentiates the step."""
    h = period / steps
    for _ in range(steps):
        a = dynamics(x, u, *p)
        b = dynamics(x + 0.5 * h * a, u, *p)
        c = dynamics(x + 0.5 * h * b, u, *p)
        x = x + h / 6 * (a + 2 * b + 2 * c + dynamics(x + h * c, u, *p))
    return x


@pytest.mark.parametrize("problem", ["arm", "powercube", "ur5", "panda"], indirect=True)
def test_values_have_the_bits_of_step_and_jacobians_are_those_of_casadi(problem: Problem) -> None:
    """CasADi integrates the accelerations and differentiates the integration."""
    module, robot = problem.module, problem.casadi
    externals, n, m = Externals(problem.solver), module.N, module.M
    x, u = ca.MX.sym("x", 2 * n), ca.MX.sym("u", m)
    p = [[9.5, 1.7]] if module.PARAMETERS else []
    values = dict(zip(module.PARAMETERS, *p)) if p else {}
    steps = {"arm": 3, "powercube": 8}.get(module.NAME, 1)
    both = ca.vertcat(u, x)
    for period in (0.002, 0.02):
        after, own = runge_kutta(robot.dynamics, x, u, period, steps, p), robot.step(x, u, period, *p)
        results = [own, ca.jacobian(own, both), after, ca.jacobian(after, both)]
        reference = ca.Function("reference", [x, u], results)
        rng = np.random.default_rng(3)
        for _ in range(3):
            state, inputs = rng.uniform(-1, 1, 2 * n), rng.uniform(-1, 1, m) * 5
            parameters = module.parameters(period, values)
            found, jacobian = externals.call(module.STEP_DERIVATIVES, state, inputs, parameters)
            alone, _ = externals.call(module.STEP, state, inputs, parameters)
            expected, derivatives, integrated, differentiated = (each.full() for each in reference(state, inputs))
            assert np.array_equal(alone, expected.ravel()) and np.array_equal(jacobian, derivatives)
            for value in (alone, found):
                assert np.abs(value - integrated.ravel()).max() <= 1e-13 * np.abs(integrated).max()
            assert np.abs(jacobian - differentiated).max() <= 1e-12 * np.abs(differentiated).max()


def wrist(folder: Path) -> Path:
    """Two motors move both joints of the wrist. One motor has a small torque limit."""
    text = (MODELS / "differential_wrist.toml").read_text("utf-8")
    without = "limits = { position = [-1.8, 1.8], velocity = 4 }"
    assert without in text
    file = folder / "wrist.toml"
    file.write_text(text.replace(without, without.replace(" }", ", effort = 10 }")), "utf-8")
    return file


def test_limits_of_motors_and_joints_are_bounds_of_inputs(tmp_path: Path) -> None:
    module = gelenk.acados(wrist(tmp_path))
    for peak, most in [(True, [1.0, 0.6, 0.2, 0.2]), (False, [0.6, 0.35, 0.1, 0.1])]:
        limits = module.ocp(5, 0.01, peak=peak).constraints
        assert np.array_equal(limits.idxbu, range(4))
        assert np.allclose(limits.ubu, most, rtol=1e-15) and np.array_equal(limits.lbu, -limits.ubu)
        # The torque–speed lines of the motors contain speeds in addition to the inputs.
        forces = np.flatnonzero(~limits.C.any(axis=1))
        assert np.array_equal(limits.D[forces], [[0, 0, 80, 80]])
        assert np.array_equal(np.stack([limits.lg, limits.ug])[:, forces], [[-10], [10]])
        assert limits.lg_e.size == 0
        states = np.array([2, 2.4, 1.8, 3, 2, 2.5, 4, 4])
        for lower, upper, which in [("lbx", "ubx", "idxbx"), ("lbx_e", "ubx_e", "idxbx_e")]:
            assert np.array_equal(getattr(limits, which), range(8))
            assert np.array_equal(getattr(limits, upper), states) and np.array_equal(getattr(limits, lower), -states)
    with pytest.raises(ValueError, match="differential_wrist has no parameter `mass`; it has none"):
        module.parameters(0.01, {"mass": 1.0})


def test_limits_of_joints_that_follow_others_are_rows(tmp_path: Path) -> None:
    module = gelenk.acados(MODELS / "palletizer.toml")
    robot = gelenk.load(MODELS / "palletizer.toml", functions=["mass_matrix"])
    limits = module.ocp(5, 0.01).constraints
    low, high = (robot.DEPENDENT_POSITION_LIMITS - robot.DEPENDENT_JOINT_OFFSETS[:, None]).T
    limited = np.isfinite(low)
    assert limited.any() and limits.C_e.shape[1] == 2 * robot.N
    count = limited.sum()
    assert np.array_equal(limits.C_e[:count, : robot.N], robot.DEPENDENT_JOINT_RATIOS[limited])
    assert not limits.C_e[:count, robot.N :].any()
    assert np.array_equal(limits.lg_e[:count], low[limited]) and np.array_equal(limits.ug_e[:count], high[limited])
    assert np.array_equal(limits.C[: len(limits.C_e)], limits.C_e)


def weak_at_speed(folder: Path) -> Path:
    """A wrist whose two motors move both joints, and an elbow. The torque of all motors falls with speed."""
    text = (MODELS / "differential_wrist.toml").read_text("utf-8")
    drive = "torque = { nominal = 0.35, peak = 0.7 } }"
    assert text.count(drive) == 1
    file = folder / "weak.toml"
    file.write_text(text.replace(drive, drive[:-2] + ", stall_torque = 0.4, no_load_speed = 250 }"), "utf-8")
    return file


def test_torque_speed_lines_are_hard_rows_of_speeds_and_inputs(tmp_path: Path) -> None:
    """Rows |u + C v| <= limit from the data sheets: C is the loss of torque per speed, with the gear and the weights of the joints."""
    module = gelenk.acados(weak_at_speed(tmp_path))
    assert module.LEFT_OUT == ()
    ocp = module.ocp(5, 0.01)
    limits, n = ocp.constraints, module.N
    assert np.array_equal(limits.D, np.eye(4)[1:]) and not limits.C[:, :n].any()
    left, right = np.array([0, 0, 80, 80]), np.array([0, 0, 80, -80])
    slopes = [0.4 / 250 * np.array([0, 100, 0, 0]), 0.24 / 600 * left, 0.24 / 600 * right]
    assert np.allclose(limits.C[:, n:], slopes, rtol=1e-15)
    assert np.array_equal(limits.ug, [0.4, 0.24, 0.24]) and np.array_equal(limits.lg, -limits.ug)
    assert limits.lg_e.size == 0 and limits.C_e.size == 0
    module.soften(ocp, 1e4, 1e5)
    assert limits.idxsg.size == 0, "they stay hard"


def test_acados_keeps_torque_speed_lines(tmp_path: Path) -> None:
    """A motion of elbow and wrist that is too fast for their motors: the rows hold at all stages, and some are active."""
    module = gelenk.acados(weak_at_speed(tmp_path), smooth_sign=50)
    ocp, n, intervals = module.ocp(20, 0.02, compile_flags="-O1"), module.N, 20
    module.track(ocp, [1e3] * n + [1.0] * n, [1e-2] * module.M)
    module.soften(ocp, 1e4, 1e5)
    ocp.code_export_directory = str(tmp_path / "generated")
    solver = module.solver(ocp, json_file=str(tmp_path / "ocp.json"), verbose=False)
    target = np.concatenate([[0.0, 1.5, 1.0, 1.5], np.zeros(n)])
    for stage in range(intervals):
        solver.set(stage, "yref", np.concatenate([target, np.zeros(module.M)]))
    solver.set(intervals, "yref", target)
    for _ in range(15):
        solver.solve_for_x0(np.zeros(2 * n))
    assert solver.status == 0
    x, u = (np.array([solver.get(stage, name) for stage in range(intervals)]) for name in "xu")
    taken = (u + x[:, n:] @ module.TORQUE_SPEED_SLOPES.T) / module.TORQUE_SPEED_LIMITS
    assert np.abs(taken).max() <= 1 + 1e-6
    # Without the rows, the solver would command torques above the lines but below the peak torques.
    assert np.abs(taken[:, 1]).max() > 1 - 1e-3 and np.abs(x[:, n + 1]).max() > 0.5


def test_limits_that_are_no_constant_bounds_are_told(tmp_path: Path) -> None:
    text = (MODELS / "excavator.toml").read_text("utf-8")
    file = tmp_path / "excavator.toml"
    file.write_text(text.replace("velocity = 0.9 }", "velocity = 0.9, effort = 9e4 }"), "utf-8")
    module = gelenk.acados(file)
    with pytest.warns(UserWarning, match="limits of forces at the joints are not among the bounds"):
        limits = module.ocp(5, 0.01).constraints
    # Cylinders push farther than they pull.
    assert [-60e3, 35e3] in np.stack([limits.lbu, limits.ubu], axis=1).tolist()


def test_robots_and_functions_that_there_are_not_are_refused(tmp_path: Path) -> None:
    with pytest.raises(gelenk.DescriptionError, match="functions for acados are not available, because the motion of joint"):
        gelenk.acados(MODELS / "rail_arm.toml")
    with pytest.raises(gelenk.DescriptionError, match="acados needs the function `step_derivatives`"):
        gelenk.acados(MODELS / "ur5.toml", functions=["step", "input_matrix"])


def rest_to_rest(start: np.ndarray, end: np.ndarray, seconds: float, time: np.ndarray) -> tuple[np.ndarray, ...]:
    """Positions, velocities and accelerations of a polynomial motion at these times."""
    s = np.clip(time / seconds, 0, 1)[:, None]
    way = end - start
    y = start + way * s**3 * (10 - 15 * s + 6 * s**2)
    v = way * 30 * s**2 * (1 - s) ** 2 / seconds
    return y, v, way * 60 * s * (1 - s) * (1 - 2 * s) / seconds**2


MOTIONS = {
    "powercube": ([-0.8, -1.0], [0.6, 0.9], 5.0),
    "ur5": ([0.0, -1.2, 1.0, -0.5, 0.5, 0.0], [1.0, -0.6, 1.6, -1.2, 1.0, 0.8], 1.0),
    "panda": ([0.0, -0.8, 0.0, -2.2, 0.0, 1.5, 0.8], [0.6, -0.1, -0.4, -1.6, 0.4, 2.0, 0.2], 1.0),
}


@pytest.mark.parametrize("problem", list(MOTIONS), indirect=True)
def test_robots_are_tracked_by_real_time_iterations(problem: Problem) -> None:
    """The motion starts 0.02 away from the reference. The plant is the model with shorter steps."""
    module, solver, most = problem.module, problem.solver, problem.most
    start, end, seconds = MOTIONS[module.NAME]
    robot, n = problem.casadi, module.N
    count = round(seconds / PERIOD)
    time = PERIOD * np.arange(count + INTERVALS + 1)
    y, v, _ = rest_to_rest(np.array(start), np.array(end), seconds, time)
    x = np.concatenate([y, v], axis=1)
    middle = rest_to_rest(np.array(start), np.array(end), seconds, time + 0.5 * PERIOD)
    forces = robot.inverse_dynamics(*[each.T for each in middle]).full()
    u = np.linalg.solve(module.INPUT_MATRIX, forces).T
    assert (np.abs(u) < most).all()
    state = x[0] + np.concatenate([np.full(n, 0.02), np.zeros(n)])
    for stage in range(INTERVALS + 1):
        solver.set(stage, "x", x[stage])
    for k in range(count):
        for stage in range(INTERVALS):
            solver.set(stage, "yref", np.concatenate([x[k + stage], u[k + stage]]))
        solver.set(INTERVALS, "yref", x[k + INTERVALS])
        inputs = solver.solve_for_x0(state)
        assert solver.status == 0 and (np.abs(inputs) <= most * (1 + 1e-6)).all()
        for _ in range(4):
            state = robot.step(state, inputs, PERIOD / 4).full().ravel()
        if k >= 25:
            assert np.abs(state - x[k + 1])[:n].max() < 1e-3, k
    assert np.abs(state - x[count])[:n].max() < 2e-4


def test_the_height_of_a_tool_is_limited(seven_file: Path, tmp_path: Path) -> None:
    """The inputs are those of CasADi's solver, for a robot that is not in `models/`."""
    module = gelenk.acados(seven_file)
    count, period, height = 20, 0.05, 1.16
    q, r = np.repeat([100.0, 1.0], 7), np.full(7, 1e-4)
    start = np.concatenate([[0, 0.6, 0, 0.9, 0, 0.5, 0], np.zeros(7)])
    goal = np.concatenate([[0.5, 0.9, -0.3, 1.2, 0.4, 0.8, -0.5], np.zeros(7)])
    ocp = module.ocp(count, period, compile_flags="-O1")
    module.track(ocp, q / period, r / period, 100 * q)
    ocp.model.con_h_expr = module.frame_tool(ocp.model.x[:7])[0][2]
    ocp.constraints.lh, ocp.constraints.uh = np.array([height]), np.array([module.UNLIMITED])
    ocp.solver_options.nlp_solver_type, ocp.solver_options.nlp_solver_max_iter = "SQP", 50
    ocp.code_export_directory = str(tmp_path / "generated")
    solver = module.solver(ocp, json_file=str(tmp_path / "ocp.json"), verbose=False)
    for stage in range(count):
        solver.set(stage, "yref", np.concatenate([goal, np.zeros(7)]))
        solver.set(stage, "x", start)
    solver.set(count, "yref", goal)
    solver.set(count, "x", start)
    solver.set(0, "lbx", start)
    solver.set(0, "ubx", start)
    assert solver.solve() == 0
    heights = [float(module.frame_tool(solver.get(stage, "x")[:7])[0][2]) for stage in range(1, count)]
    assert min(heights) == pytest.approx(height, abs=1e-5)
    robot = gelenk.casadi(seven_file)
    other = gelenk.gauss_newton(
        lambda x, u, p: robot.step(x, u, period), lambda x, u, p: ca.vertcat(x - p, u), lambda x, p: x - p,
        states=14, inputs=7, parameters=14, intervals=count, weights=np.concatenate([q, r]), terminal_weights=100 * q,
        rows=lambda x, u, p: robot.frame_tool(x[:7])[0][2], row_limits=[[height], [np.inf]],
        # CasADi would load the HPIPM of acados in this process, because both libraries have the same name.
        options={"qpsol": "qrqp", "qpsol_options": {"print_iter": False, "print_header": False, "print_info": False}},
    )
    inputs = np.array([solver.get(stage, "u") for stage in range(count)])
    expected = other.solve(start, goal).u
    assert np.abs(inputs - expected).max() < 1e-3 * np.abs(expected).max()
    with pytest.raises(AttributeError, match="has no attribute 'frame_foot'"):
        module.frame_foot
