"""External functions of CasADi: values and derivatives against Pinocchio's, and an optimal control problem."""

from __future__ import annotations

import json
import pickle
from pathlib import Path
from typing import Any

import gelenk
import numpy as np
import pytest

from conftest import MODELS

ca = pytest.importorskip("casadi", reason="casadi is not installed")

TOLERANCE = 1e-12


def assert_close(found: Any, expected: np.ndarray) -> None:
    found = np.asarray(found)
    assert found.shape == expected.shape
    assert np.abs(found - expected).max() <= TOLERANCE * np.abs(expected).max()


def jacobian(function: Any, *arguments: Any) -> list[np.ndarray]:
    """All blocks, outputs first."""
    blocks = function.jacobian()(*arguments, *[0] * function.n_out())
    return [block.full() for block in (blocks if isinstance(blocks, (tuple, list)) else [blocks])]


def test_values_and_jacobians_agree_with_pinocchio(reference: Path, tmp_path: Path) -> None:
    file = tmp_path / "ur5.toml"
    urdf = MODELS / "urdf" / "ur5.urdf"
    file.write_text(f'name = "ur5"\nurdf = "{urdf}"\n[[frames]]\nname = "last"\nlink = "wrist_3_link"\n', "utf-8")
    functions = ["inverse_dynamics_derivatives_and_mass_matrix", "inverse_dynamics", "linearize", "forward_dynamics", "frames"]
    robot = gelenk.casadi(file, no_friction=True, functions=functions)
    assert list(robot) == ["dynamics", "inverse_dynamics", "frame_last"]
    told = json.loads((reference / "ur5.json").read_text())
    assert told["frame"] == "wrist_3_joint"
    for sample in told["samples"]:
        sample = {key: np.array(value) for key, value in sample.items() if key != "regressor"}
        y, v, a, u = (sample[key] for key in ("y", "v", "a", "tau"))
        x, n = np.concatenate([y, v]), y.size
        assert_close(robot.dynamics(x, u).full().ravel(), np.concatenate([v, sample["fd"]]))
        by_x, by_u = jacobian(robot.dynamics, x, u)
        assert_close(by_x[n:], np.hstack([sample["dfd_dy"], sample["dfd_dv"]]))
        assert np.array_equal(by_x[:n], np.eye(n, 2 * n, n)) and not by_u[:n].any()
        assert_close(by_u[n:], sample["dfd_dtau"])
        assert_close(robot.inverse_dynamics(y, v, a).full().ravel(), sample["id"])
        for block, key in zip(jacobian(robot.inverse_dynamics, y, v, a), ["did_dy", "did_dv", "M"]):
            assert_close(block, sample[key])
        position, rotation = robot.frame_last(y)
        assert_close(position.full().ravel(), sample["p"])
        assert_close(rotation.full(), sample["R"])
        by_position, by_rotation = jacobian(robot.frame_last, y)
        assert_close(by_position, sample["J"][:3])
        # Columns of ω × R, entries of R column by column.
        turned = np.cross(sample["J"][3:].T[:, None, :], sample["R"].T[None]).reshape(n, 9).T
        assert_close(by_rotation, turned)


def test_entries_that_are_always_zero_are_not_there(arm: Any) -> None:
    """The position of the cart has no effect on the dynamics. The first joint moves the hand in a plane."""
    functions = ["linearize", "forward_dynamics"]
    robot = gelenk.casadi(MODELS / "cart_pole.toml", functions=functions, smooth_sign=50)
    module = gelenk.load(MODELS / "cart_pole.toml", functions=functions, smooth_sign=50)
    by_x = np.array(ca.DM(robot.dynamics.jacobian().sparsity_out(0), 1).full(), bool)
    lower = np.hstack([module.A_Y_NONZERO, module.A_V_NONZERO])
    assert np.array_equal(by_x, np.vstack([np.eye(2, 4, 2, dtype=bool), lower])) and not lower[:, 0].any()
    by_y = np.array(ca.DM(arm[0].frame_hand.jacobian().sparsity_out(0), 1).full(), bool)
    assert np.array_equal(by_y, [[1, 1], [0, 1], [1, 1]])


def differences(function: Any, arguments: list[np.ndarray], index: int) -> np.ndarray:
    columns, step = [], 1e-6
    for entry in range(arguments[index].size):
        both = []
        for sign in (1, -1):
            moved = [np.array(each, float) for each in arguments]
            moved[index].flat[entry] += sign * step
            results = function(*moved)
            results = results if isinstance(results, tuple) else (results,)
            both.append(np.concatenate([each.full().ravel("F") for each in results]))
        columns.append((both[0] - both[1]) / (2 * step))
    return np.stack(columns, axis=1)


ARM = """\
name = "arm"
gravity = [0, 0, "-g"]
joints = [
    { name = "a", axis = [0, 1, 0], drive = "ideal", friction = { viscous = 0.3, coulomb = { free = 0.5, name = "dry" } } },
    { name = "b", axis = [0.6, 0.8, 0], origin = { xyz = [0.1, 0, "length"] }, drive = "ideal" },
]
bodies = [
    { link = "a", mass = 3.0, center_of_mass = [0, 0, 0.2], inertia = 0.04 },
    { link = "b", mass = "load", center_of_mass = [0, 0.05, 0.15], inertia = 0.02 },
]
frames = [{ name = "hand", link = "b", origin = { xyz = [0, 0, "length"] } }]

[generate]
substeps = 3

[parameters]
g = 9.81
load = 2.0
length = 0.4
"""


@pytest.fixture(scope="module")
def arm(tmp_path_factory: pytest.TempPathFactory, cache: Path) -> Any:
    file = tmp_path_factory.mktemp("arm") / "arm.toml"
    file.write_text(ARM, "utf-8")
    return gelenk.casadi(file, smooth_sign=20), gelenk.load(file, smooth_sign=20)


def test_all_inputs_have_their_derivatives(arm: Any) -> None:
    robot, _ = arm
    rng = np.random.default_rng(16)
    assert list(robot.parameters) == ["g", "load", "length", "dry"]
    p = np.array(list(robot.parameters.values()))
    for name in robot:
        function = getattr(robot, name)
        sizes = [function.numel_in(index) for index in range(function.n_in())]
        arguments = [rng.uniform(-1, 1, size) for size in sizes]
        arguments[-1] = p
        if name == "step":
            arguments[2] = np.array([0.05])
        blocks = jacobian(function, *arguments)
        count = function.n_in()
        for index in range(count):
            found = np.concatenate([blocks[output * count + index] for output in range(function.n_out())])
            expected = differences(function, arguments, index)
            assert np.abs(found - expected).max() <= 1e-8 * max(1, np.abs(expected).max()), (name, function.name_in(index))


def test_second_derivatives_are_those_of_the_module(seven_file: Path) -> None:
    """The module's Hessian of λᵀ b_u is analytic; CasADi's comes from differences."""
    robot = gelenk.casadi(seven_file)
    module = gelenk.load(seven_file, functions=["inverse_dynamics_hessian"])
    rng = np.random.default_rng(18)
    z, weights = ca.MX.sym("z", 21), ca.MX.sym("weights", 7)
    force = ca.dot(weights, robot.inverse_dynamics(z[:7], z[7:14], z[14:]))
    hessian = ca.Function("hessian", [z, weights], [ca.hessian(force, z)[0]])
    for _ in range(3):
        y, v, a, given = rng.uniform(-1, 1, (4, 7))
        h = module.inverse_dynamics_hessian(y, v, a, given)
        none = np.zeros((7, 7))
        expected = np.block([[h.h_yy, h.h_yv, h.h_ya], [h.h_yv.T, h.h_vv, none], [h.h_ya.T, none, none]])
        found = hessian(np.concatenate([y, v, a]), given).full()
        assert np.abs(found - expected).max() <= 1e-7 * np.abs(expected).max()


def test_all_inputs_have_their_second_derivatives(arm: Any) -> None:
    """Compares blocks with differences of another step, and with zero for the outputs, which derivatives do not read."""
    robot, _ = arm
    rng = np.random.default_rng(19)
    for name in robot:
        first = getattr(robot, name).jacobian()
        arguments = [rng.uniform(-1, 1, first.size_in(index)) for index in range(first.n_in())]
        function = getattr(robot, name)
        arguments[function.n_in() - 1] = np.array([list(robot.parameters.values())]).T
        if name == "step":
            arguments[2] = np.array([[0.05]])
        blocks = jacobian(first, *arguments)
        count = first.n_in()
        for index in range(count):
            found = np.concatenate([blocks[output * count + index] for output in range(first.n_out())])
            expected = differences(first, arguments, index)
            assert np.abs(found - expected).max() <= 1e-6 * max(1, np.abs(expected).max()), (name, first.name_in(index))


def test_the_functions_are_those_of_the_module(arm: Any) -> None:
    robot, module = arm
    y, v, u = np.random.default_rng(17).uniform(-1, 1, (3, 2))
    p = [9.0, 1.0, 0.3, 0.1]
    packed = dict(zip(robot.parameters, p))
    x = np.concatenate([y, v])
    after = module.step(y, v, u, 0.02, **packed)
    assert np.array_equal(robot.step(x, u, 0.02, p).full().ravel(), np.concatenate(after))
    assert np.array_equal(robot.inverse_dynamics(y, v, u, p).full().ravel(), module.inverse_dynamics(y, v, u, **packed))
    position, rotation = module.frame_hand_pose(y, **packed)
    found = robot.frame_hand(y, p)
    assert np.array_equal(found[0].full().ravel(), position) and np.array_equal(found[1].full(), rotation)
    # An argument that CasADi leaves out is zero.
    assert np.array_equal(robot.dynamics(x=x, p=p)["xdot"].full().ravel()[2:], module.forward_dynamics(y, v, 0 * u, **packed))
    with pytest.raises(AttributeError, match="there is no function `frame_foot` for CasADi; the functions are dynamics, inverse_dynamics"):
        robot.frame_foot


def test_what_the_module_lacks_is_not_differentiated(tmp_path: Path) -> None:
    file = tmp_path / "arm.toml"
    file.write_text(ARM, "utf-8")
    robot = gelenk.casadi(file, functions=["forward_dynamics"])
    assert list(robot) == ["dynamics"]
    x = ca.MX.sym("x", 4)
    with pytest.raises(RuntimeError):
        ca.Function("f", [x], [ca.jacobian(robot.dynamics(x, [0, 0], [9.81, 2, 0.4, 0]), x)])


def test_ipopt_solves_an_optimal_control_problem(arm: Any) -> None:
    """Multiple shooting from rest to rest in one second with the least torque. The load is a parameter of the problem."""
    robot, module = arm
    count, period, most = 40, 0.025, 40.0
    x, u, p = ca.MX.sym("x", 4, count + 1), ca.MX.sym("u", 2, count), ca.MX.sym("p", 4)
    steps = robot.step.map(count)(x[:, :-1], u, period, ca.repmat(p, 1, count))
    start, end = np.array([0.0, 0.0, 0, 0]), np.array([1.0, -0.8, 0, 0])
    constraints = ca.vertcat(ca.vec(x[:, 1:] - steps), x[:, 0] - start, x[:, -1] - end)
    problem = {"x": ca.veccat(x, u), "p": p, "f": period * ca.sumsqr(u), "g": constraints}
    options = {"ipopt.hessian_approximation": "limited-memory", "ipopt.print_level": 0, "print_time": False, "ipopt.sb": "yes"}
    solver = ca.nlpsol("swing", "ipopt", problem, options)
    limits = np.concatenate([np.full(4 * (count + 1), np.inf), np.full(2 * count, most)])
    parameters = [9.81, 2.5, 0.4, 0.5]
    found = solver(x0=0, p=parameters, lbx=-limits, ubx=limits, lbg=0, ubg=0)
    assert solver.stats()["return_status"] == "Solve_Succeeded"
    inputs = found["x"].full().ravel()[4 * (count + 1) :].reshape(count, 2)
    assert np.abs(inputs).max() <= most + 1e-6
    # A simulation with the module ends at the state of the solution.
    y, v = start[:2], start[2:]
    for each in inputs:
        y, v = module.step(y, v, each, period, parameters=module.pack_parameters(**dict(zip(robot.parameters, parameters))))
    assert np.abs(np.concatenate([y, v]) - end).max() < 1e-6
    # CasADi's multiplier of a parameter is the negative slope of the optimum, which a second solution shows.
    more = [9.81, 2.51, 0.4, 0.5]
    again = solver(x0=found["x"], p=more, lbx=-limits, ubx=limits, lbg=0, ubg=0)
    slope = float(again["f"] - found["f"]) / 0.01
    assert -float(found["lam_p"][1]) == pytest.approx(slope, rel=0.01)


def test_gauss_newton_finds_what_exact_hessians_find(seven_file: Path) -> None:
    """A motion of one second with active limits, above a plane. IPOPT differentiates the same problem twice."""
    robot = gelenk.casadi(seven_file)
    module = gelenk.load(seven_file, functions=["step"])
    count, period, height = 20, 0.05, 1.16
    effort, speed = np.array([80.0, 80, 50, 50, 50, 20, 20]), np.full(7, 0.9)
    free = np.full(7, np.inf)
    q, r = np.repeat([100.0, 1.0], 7), np.full(7, 1e-4)
    problem = gelenk.gauss_newton(
        lambda x, u, p: robot.step(x, u, period), lambda x, u, p: ca.vertcat(x - p, u), lambda x, p: x - p,
        states=14, inputs=7, parameters=14, intervals=count, weights=np.concatenate([q, r]), terminal_weights=100 * q,
        state_limits=[np.concatenate([-free, -speed]), np.concatenate([free, speed])], input_limits=[-effort, effort],
        rows=lambda x, u, p: robot.frame_tool(x[:7])[0][2], row_limits=[[height], [np.inf]],
    )
    start = np.concatenate([[0, 0.6, 0, 0.9, 0, 0.5, 0], np.zeros(7)])
    goal = np.concatenate([[0.5, 0.9, -0.3, 1.2, 0.4, 0.8, -0.5], np.zeros(7)])
    found = problem.solve(start, goal)
    iterations = problem.solver.stats()["iter_count"]
    assert iterations < 30
    for k in range(count):
        after = np.concatenate(module.step(found.x[k, :7], found.x[k, 7:], found.u[k], period))
        assert np.abs(after - found.x[k + 1]).max() < 1e-6
    heights = [float(robot.frame_tool(x[:7])[0][2]) for x in found.x[1:-1]]
    assert min(heights) == pytest.approx(height, abs=1e-6), "the plane binds"
    assert np.abs(found.x[1:, 7:]).max() == pytest.approx(0.9, abs=1e-6), "so do speeds"

    x, u = ca.MX.sym("x", 14, count + 1), ca.MX.sym("u", 7, count)
    error = x - ca.repmat(ca.DM(goal), 1, count + 1)
    cost = ca.dot(q, ca.sum2(error[:, :-1] ** 2)) / 2 + ca.dot(r, ca.sum2(u**2)) / 2 + 50 * ca.dot(q, error[:, -1] ** 2)
    gaps = robot.step.map(count)(x[:, :-1], u, period) - x[:, 1:]
    heights = [robot.frame_tool(x[:7, k])[0][2] for k in range(1, count)]
    options = {"ipopt.print_level": 0, "print_time": False, "ipopt.sb": "yes", "ipopt.tol": 1e-9}
    exact = ca.nlpsol("exact", "ipopt", {"x": ca.veccat(x, u), "f": cost, "g": ca.vertcat(ca.vec(gaps), *heights)}, options)
    sides = np.concatenate([np.tile(np.concatenate([free, speed]), count + 1), np.tile(effort, count)])
    low, high = -sides, sides.copy()
    low[:14] = high[:14] = start
    floor = np.concatenate([np.zeros(14 * count), np.full(count - 1, height)])
    guess = np.concatenate([np.tile(start, count + 1), np.zeros(7 * count)])
    other = exact(x0=guess, lbx=low, ubx=high, lbg=floor, ubg=np.where(floor > 0, np.inf, 0))
    assert exact.stats()["return_status"] == "Solve_Succeeded"
    assert found.cost == pytest.approx(float(other["f"]), rel=1e-6)
    assert np.abs(found.u.ravel() - other["x"].full().ravel()[14 * (count + 1) :]).max() < 1e-3 * effort.max()
    # The solution is the start of the next solution.
    assert problem.solve(start, goal, found).cost == pytest.approx(found.cost)
    assert problem.solver.stats()["iter_count"] <= iterations / 2
    with pytest.raises(ValueError, match=r"`x0` has the shape \(7,\), expected \(14,\)"):
        problem.solve(start[:7], goal)
    with pytest.raises(RuntimeError):
        problem.solve(np.concatenate([start[:7], np.full(7, 5.0)]), goal)


def test_functions_are_pickled_and_their_library_is_one_of_casadi(arm: Any) -> None:
    robot, _ = arm
    again = pickle.loads(pickle.dumps(robot))
    assert list(again) == list(robot) and again.library == robot.library and again.parameters == robot.parameters
    dynamics = ca.external("arm_casadi_dynamics", robot.library)
    p = list(robot.parameters.values())
    assert np.array_equal(dynamics(1, 0.5, p).full(), again.dynamics(1, 0.5, p).full())


def test_rows_and_their_limits_belong_together() -> None:
    for given in ({"rows": lambda x, u, p: x}, {"row_limits": [[0.0], [1.0]]}):
        with pytest.raises(ValueError, match="belong together"):
            gelenk.gauss_newton(
                lambda x, u, p: x, lambda x, u, p: x, lambda x, p: x, states=1, inputs=1, intervals=2, **given
            )
