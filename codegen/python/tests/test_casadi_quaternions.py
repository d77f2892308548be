"""External functions of robots with quaternions, about reference positions: values and Jacobians against Pinocchio's, and IPOPT."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import gelenk
import numpy as np
import pytest

import mechanisms
from conftest import MODELS

ca = pytest.importorskip("casadi", reason="casadi is not installed")

FUNCTIONS = ["inverse_dynamics_derivatives_and_mass_matrix", "inverse_dynamics", "linearize", "forward_dynamics", "frames"]


def assert_close(found: Any, expected: np.ndarray, tolerance: float = 1e-12) -> None:
    found = np.asarray(found)
    assert found.shape == expected.shape
    assert np.abs(found - expected).max() <= tolerance * np.abs(expected).max()


def jacobian(function: Any, *arguments: Any) -> list[np.ndarray]:
    """All blocks, outputs first."""
    blocks = function.jacobian()(*arguments, *[0] * function.n_out())
    return [block.full() for block in (blocks if isinstance(blocks, (tuple, list)) else [blocks])]


def loaded(name: str, reference: Path, folder: Path, functions: list[str]) -> tuple[Any, Any, Path]:
    """The robot for CasADi and its functions of positions, and Pinocchio's values."""
    values = reference / "mechanisms" / f"{name}.json"
    file = folder / f"{name}.toml"
    file.write_text(mechanisms.description(values), "utf-8")
    robot = gelenk.casadi(file, functions=functions, accept_unphysical=True)
    return robot, gelenk.load(file, functions=["potential_energy"], accept_unphysical=True), values


@pytest.mark.parametrize("name", ["go2_floating", "iris_floating"])
def test_values_and_jacobians_agree_with_pinocchio(name: str, reference: Path, tmp_path: Path) -> None:
    """The reference is d = 0.1 v away, because Pinocchio's values have the derivatives of ⊕ for this d."""
    robot, module, values = loaded(name, reference, tmp_path, FUNCTIONS)
    assert list(robot) == ["dynamics", "inverse_dynamics", "frame_last"]
    for sample in mechanisms.samples(values):
        y, v, a, u = (sample[key] for key in ("q", "v", "a", "tau"))
        d, n = 0.1 * v, v.size
        y_ref, x = module.integrate(y, -d), np.concatenate([d, v])
        by_d, by_y = sample["qplus_by_d"], sample["qplus_by_q"]
        # Converts small motions of the reference to changes of its entries.
        rates = mechanisms.small_motions(module.JOINT_POSITIONS, y_ref)

        rate, acceleration = np.split(robot.dynamics(x, u, y_ref).full().ravel(), 2)
        assert_close(by_d @ rate, v)
        assert_close(acceleration, sample["fd"])
        by_x, by_u, by_ref = jacobian(robot.dynamics, x, u, y_ref)
        assert_close(by_d @ by_x[:n, n:], np.eye(n))
        assert_close(by_x[n:], np.hstack([sample["dfd_dq"] @ by_d, sample["dfd_dv"]]))
        assert_close(by_ref[n:] @ rates, sample["dfd_dq"] @ by_y)
        assert not by_u[:n].any() and not by_ref[:n].any()
        # Lengths of quaternions have no effect.
        assert_close(by_ref @ rates @ np.linalg.pinv(rates), by_ref)

        assert_close(robot.inverse_dynamics(d, v, a, y_ref).full().ravel(), sample["id"])
        blocks = jacobian(robot.inverse_dynamics, d, v, a, y_ref)
        blocks[3] = blocks[3] @ rates
        for block, expected in zip(blocks, [sample["did_dq"] @ by_d, sample["did_dv"], sample["M"], sample["did_dq"] @ by_y]):
            assert_close(block, expected)

        position, rotation = robot.frame_last(d, y_ref)
        assert_close(position.full().ravel(), sample["p"])
        assert_close(rotation.full(), sample["R"])
        position_by_d, position_by_ref, rotation_by_d, rotation_by_ref = jacobian(robot.frame_last, d, y_ref)
        for by, of_position, of_rotation in [
            (by_d, position_by_d, rotation_by_d), (by_y, position_by_ref @ rates, rotation_by_ref @ rates)
        ]:
            moved = sample["J"] @ by
            assert_close(of_position, moved[:3])
            # Columns of ω × R, entries of R column by column.
            assert_close(of_rotation, np.cross(moved[3:].T[:, None, :], sample["R"].T[None]).reshape(n, 9).T)


@pytest.mark.parametrize("name", ["zoo_1", "zoo_2", "zoo_3", "zoo_4"])
def test_joints_of_every_kind_agree_with_pinocchio(name: str, reference: Path, tmp_path: Path) -> None:
    """Velocities of a planar joint are in the body's frame in Pinocchio, and in the parent's frame in gelenk."""
    functions = ["inverse_dynamics_derivatives_and_mass_matrix", "inverse_dynamics", "forward_dynamics"]
    robot, module, values = loaded(name, reference, tmp_path, functions)
    planar = mechanisms.planar_joints(values)
    for sample in mechanisms.samples(values):
        planars = [mechanisms.Planar(sample, *place) for place in planar]
        y = mechanisms.without_cosines(sample["q"], planars)
        n = sample["v"].size
        turn, rate = np.eye(n), np.zeros((n, n))
        by_d = sample["qplus_by_d"].copy()
        for each in planars:
            each.place(turn, rate, by_d)
        v = turn @ sample["v"]
        a = turn @ sample["a"] + rate @ sample["v"]
        d = 0.1 * v
        y_ref = module.integrate(y, -d)
        forces = robot.inverse_dynamics(d, v, a, y_ref).full().ravel()
        assert_close(turn.T @ forces, sample["id"])
        of_d, of_v, of_a, _ = jacobian(robot.inverse_dynamics, d, v, a, y_ref)
        assert_close(turn.T @ of_a @ turn, sample["M"])
        of_rate = rate.copy()
        for each in planars:
            of_rate[:, each.velocity + 2] += each.by_speed(n)
        assert_close(turn.T @ (of_v @ turn + of_a @ of_rate), sample["did_dv"])
        expected = sample["did_dq"].copy()
        found = turn.T @ of_d @ np.linalg.inv(by_d) @ turn
        # Pinocchio's velocities of a planar joint rotate with the joint, so their columns are another derivative.
        kept = np.ones(n, bool)
        for each in planars:
            kept[each.velocity + 2] = False
        assert_close(found[:, kept], expected[:, kept])
        accelerations = robot.dynamics(np.concatenate([d, v]), np.linalg.solve(turn.T, sample["tau"]), y_ref).full().ravel()[n:]
        assert_close(np.linalg.solve(turn, accelerations - rate @ sample["v"]), sample["fd"], 1e-11)


FLOATING = """\
name = "floating"
base = { link = "hull", type = "floating" }
bodies = [
    { name = "hull", link = "hull", mass = 4, inertia = [0.2, 0.3, 0.4] },
    { name = "wheel", link = "wheel", mass = 1, inertia = [0.01, 0.02, 0.02] },
    { name = "boom", link = "boom", mass = "load", center_of_mass = [0, 0, 0.5], inertia = [0.1, 0.1, 0.01] },
]
joints = [
    { name = "wheel", parent = "hull", type = "continuous", axis = [1, 0, 0], drive = "ideal" },
    { name = "boom", parent = "hull", type = "spherical" },
]
frames = [{ name = "tip", link = "boom", origin = { xyz = [0.1, 0, 1] } }]
generate = { substeps = 2 }
parameters = { load = 1.5 }
"""


@pytest.fixture(scope="module")
def floating(tmp_path_factory: pytest.TempPathFactory, cache: Path) -> tuple[Any, Any]:
    """A robot with joints of all numbers of position entries, a free parameter, and two steps per period."""
    file = tmp_path_factory.mktemp("floating") / "floating.toml"
    file.write_text(FLOATING, "utf-8")
    robot = gelenk.casadi(file, functions=[*FUNCTIONS, "step", "step_derivatives"])
    return robot, gelenk.load(file, functions=["inverse_dynamics", "step"])


def arguments_of(function: Any, module: Any, size: float, rng: Any) -> list[np.ndarray]:
    """Returns random arguments of a function.

    - `size`: size of the rotations and displacements in d
    """
    arguments: list[np.ndarray] = []
    for index in range(function.n_in()):
        name, count = function.name_in(index), function.numel_in(index)
        if name == "y_ref":
            arguments.append(module.integrate(module.NEUTRAL, rng.uniform(-1, 1, module.N)))
        elif name == "y_ref_next":
            arguments.append(module.integrate(arguments[-1], rng.uniform(-0.2, 0.2, module.N)))
        else:
            numbers = {"period": np.array([0.05]), "p": np.array([1.3])}.get(name)
            arguments.append(rng.uniform(-1, 1, count) if numbers is None else numbers)
            if name in ("x", "d"):
                arguments[-1][: module.N] *= size
    return arguments


def differences(function: Any, arguments: list[np.ndarray], index: int) -> np.ndarray:
    """Returns a central difference of fourth order."""
    columns, step = [], 1e-3

    def moved(entry: int, by: float) -> np.ndarray:
        other = [np.array(each, float) for each in arguments]
        other[index].flat[entry] += by
        results = function(*other)
        results = results if isinstance(results, tuple) else (results,)
        return np.concatenate([each.full().ravel("F") for each in results])

    for entry in range(arguments[index].size):
        near, far = (moved(entry, by) - moved(entry, -by) for by in (step, 2 * step))
        columns.append((8 * near - far) / (12 * step))
    return np.stack(columns, axis=1)


@pytest.mark.parametrize("size", [0.0, 0.3, 1.3])
def test_all_inputs_have_their_derivatives(floating: tuple[Any, Any], size: float) -> None:
    """Derivatives with respect to a reference are with respect to its entries, also if its quaternions have other lengths than 1."""
    robot, module = floating
    assert list(robot) == ["dynamics", "inverse_dynamics", "step", "frame_tip"]
    rng = np.random.default_rng(18)
    for name in robot:
        function = getattr(robot, name)
        arguments = arguments_of(function, module, size, rng)
        for index in range(function.n_in()):
            if size > 1 and function.name_in(index).startswith("y_ref"):
                arguments[index] = arguments[index] * 1.5
        blocks, count = jacobian(function, *arguments), function.n_in()
        for index in range(count):
            found = np.concatenate([blocks[output * count + index] for output in range(function.n_out())])
            expected = differences(function, arguments, index)
            assert np.abs(found - expected).max() <= 1e-9 * max(1, np.abs(expected).max()), (name, function.name_in(index))


def test_the_functions_are_those_of_the_module(floating: tuple[Any, Any]) -> None:
    robot, module = floating
    d, v = np.random.default_rng(19).uniform(-1, 1, (2, module.N))
    y, x, u = module.integrate(module.NEUTRAL, d), np.concatenate([d, v]), [0.3]
    y_next, v_next = module.step(y, v, u, 0.05, load=1.3)
    found = robot.step(x, u, 0.05, module.NEUTRAL, y, 1.3).full().ravel()
    assert np.array_equal(found[module.N :], v_next)
    assert_close(found[: module.N], module.difference(y, y_next), 1e-14)
    found = robot.inverse_dynamics(d, v, v, module.NEUTRAL, 1.3).full().ravel()
    assert np.array_equal(found, module.inverse_dynamics(y, v, v, load=1.3))
    # A quaternion of length 0 is not a reference.
    with pytest.raises(RuntimeError):
        robot.inverse_dynamics(d, v, v, 0 * y, 1.3)
    # For rotations of a whole turn and more, the rate of d does not exist.
    x[3:6] = [0, 0, 2 * np.pi - 1e-3]
    assert np.isfinite(robot.dynamics(x, u, module.NEUTRAL, 1.3).full()).all()
    x[3:6] = [0, 0, 2 * np.pi + 1e-3]
    assert np.isnan(robot.dynamics(x, u, module.NEUTRAL, 1.3).full()).any()


def test_entries_that_are_always_zero_are_not_there() -> None:
    """The position of a quadrotor has no effect on its accelerations. Only its rotation rotates the rate of d."""
    robot = gelenk.casadi(MODELS / "quadrotor.toml", functions=["linearize", "forward_dynamics"])
    patterns = [robot.dynamics.jacobian().sparsity_out(index) for index in range(3)]
    by_x, by_u, by_ref = (np.array(ca.DM(each, 1).full(), bool) for each in patterns)
    assert not by_x[3:6, :3].any() and not by_x[6:, :3].any() and by_x[:3, :6].all()
    assert not by_u[:6].any() and not by_ref[:6].any() and not by_ref[6:, :3].any()
    # Gravity rotates in the axes of the body, but the moments do not.
    assert by_ref[6:9, 3:].all() and not by_ref[9:].any()


def test_ipopt_flies_a_quadrotor_between_two_attitudes() -> None:
    """A flip about x from hovering to hovering, one metre to the side, within the limits of the propellers."""
    functions = ["linearize", "step", "step_derivatives"]
    robot, module = (load(MODELS / "quadrotor.toml", functions=functions) for load in (gelenk.casadi, gelenk.load))
    count, period, n = 40, 0.03, module.N
    start = module.NEUTRAL
    end = module.integrate(np.concatenate([[0, 1.0, 0.2], start[3:]]), np.array([0, 0, 0, 0, 0, 1.2]))
    first = module.integrate(start, np.array([0, 0, 0, 0.9, 0, 0]))
    # The references lie on the path, so that d stays small.
    way = module.difference(start, end)
    references = np.stack([module.integrate(start, way * k / count) for k in range(count + 1)])
    x, u = ca.MX.sym("x", 2 * n, count + 1), ca.MX.sym("u", module.M, count)
    steps = robot.step.map(count)(x[:, :-1], u, period, references[:-1].T, references[1:].T)
    begin = np.concatenate([module.difference(start, first), np.zeros(n)])
    constraints = ca.vertcat(ca.vec(x[:, 1:] - steps), x[:, 0] - begin, x[:, -1])
    hover = 1.52 * 9.81 / 4
    cost = period * (ca.sumsqr(u - hover) + 0.1 * ca.sumsqr(x[n:, :]))
    options = {"ipopt.hessian_approximation": "limited-memory", "ipopt.print_level": 0, "print_time": False, "ipopt.sb": "yes"}
    solver = ca.nlpsol("flight", "ipopt", {"x": ca.veccat(x, u), "f": cost, "g": constraints}, options)
    free = np.full(2 * n * (count + 1), np.inf)
    low, high = np.tile(module.INPUT_RANGES.T[:, None], (1, count, 1)).reshape(2, -1)
    guess = np.concatenate([np.zeros(free.size), np.full(module.M * count, hover)])
    found = solver(x0=guess, lbx=np.concatenate([-free, low]), ubx=np.concatenate([free, high]), lbg=0, ubg=0)
    assert solver.stats()["return_status"] == "Solve_Succeeded"
    inputs = found["x"].full().ravel()[free.size :].reshape(count, module.M)
    assert inputs.min() >= -1e-6 and inputs.max() <= 8 + 1e-6
    # A simulation with the module ends at the state of the solution.
    y, v = first, np.zeros(n)
    for each in inputs:
        y, v = module.step(y, v, each, period)
    assert np.abs(module.difference(end, y)).max() < 1e-6 and np.abs(v).max() < 1e-6
