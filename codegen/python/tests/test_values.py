"""Compares results with Pinocchio's values and with the Rust modules of the same robots."""

from __future__ import annotations

import json
import multiprocessing
import os
import pickle
from pathlib import Path
from typing import Any, Callable

import gelenk
import numpy as np
import pytest

from conftest import ARM, MODELS, write

FUNCTIONS = [
    "mass_matrix", "bias_forces", "gravity_forces", "inverse_dynamics", "forward_dynamics",
    "inverse_dynamics_derivatives", "linearize", "step_derivatives", "kinetic_energy",
]


@pytest.fixture(scope="module")
def ur5() -> gelenk.Robot:
    return gelenk.load(MODELS / "ur5.toml", functions=FUNCTIONS)


def assert_close(found: np.ndarray, expected: np.ndarray, tolerance: float = 1e-12) -> None:
    error = np.abs(found - expected).max() / np.abs(expected).max()
    assert error <= tolerance


@pytest.fixture(scope="module")
def samples(reference: Path) -> dict[str, np.ndarray]:
    """All states of the reference as arrays."""
    entries = json.loads((reference / "ur5.json").read_text())["samples"]
    return {key: np.array([entry[key] for entry in entries]) for key in entries[0]}


def test_a_urdf_agrees_with_pinocchio_in_one_call_for_all_states(samples: dict[str, np.ndarray]) -> None:
    robot = gelenk.load(MODELS / "urdf" / "ur5.urdf", no_friction=True, functions=FUNCTIONS)
    y, v, a = samples["y"], samples["v"], samples["a"]
    assert_close(robot.mass_matrix(y), samples["M"])
    assert_close(robot.bias_forces(y, v), samples["c"] + samples["g"])
    assert_close(robot.gravity_forces(y), -samples["g"])
    assert_close(robot.kinetic_energy(y, v), samples["kinetic"])
    assert_close(robot.inverse_dynamics(y, v, a), samples["id"])
    forces, by_y, by_v = robot.inverse_dynamics_derivatives(y, v, a)
    assert_close(forces, samples["id"])
    assert_close(by_y, samples["did_dy"])
    assert_close(by_v, samples["did_dv"])
    assert_close(robot.forward_dynamics(y, v, samples["tau"]), samples["fd"])
    linearization = robot.linearize(y, v, samples["tau"])
    assert_close(linearization.a_y, samples["dfd_dy"])
    assert_close(linearization.a_v, samples["dfd_dv"])
    assert_close(linearization.b_x, samples["dfd_dtau"])


def test_a_base_is_freed_by_a_keyword(arm_file: Path) -> None:
    robot = gelenk.load(arm_file, base="floating", functions=["mass_matrix"])
    mass = robot.mass_matrix(robot.NEUTRAL)
    assert mass.shape == (8, 8)
    # The base is first, with its linear velocity, which moves all masses.
    assert_close(mass[:3, :3], 5.0 * np.eye(3))


def test_the_bits_are_those_of_rust(ur5: gelenk.Robot, powercube: gelenk.Robot) -> None:
    file = os.environ.get("GELENK_RUST_VALUES")
    if file is None:
        pytest.skip("GELENK_RUST_VALUES names no values: `cargo test -p gelenk-tests --test all python::` writes them")
    robots = {"ur5": ur5, "powercube_parameters": powercube}
    calls = json.loads(Path(file).read_text())
    assert {call["robot"] for call in calls} == robots.keys()
    for call in calls:
        robot = robots[call["robot"]]
        function = getattr(robot, call["function"])
        keywords = dict(zip(robot.default_parameters, call["parameters"]))
        arguments = [np.array(each) if isinstance(each, list) else each for each in call["arguments"]]
        results = function(*arguments, **keywords)
        results = results if isinstance(results, tuple) else (results,)
        found = np.concatenate([np.ravel(each) for each in results])
        assert found.tobytes() == np.array(call["results"]).tobytes(), call["function"]


def test_batches_are_the_single_calls(ur5: gelenk.Robot) -> None:
    y, v, a = np.random.default_rng(4).uniform(-3, 3, (3, 2, 5, 6))
    batch = ur5.inverse_dynamics_derivatives(y, v, a)
    for index in np.ndindex(2, 5):
        single = ur5.inverse_dynamics_derivatives(y[index], v[index], a[index])
        for many, one in zip(batch, single):
            assert np.array_equal(many[index], one)


def bits(numbers: np.ndarray) -> bytes:
    """Returns all bits, except those of NaN, because IEEE 754 does not define the sign of NaN."""
    copy = np.array(numbers, ndmin=1)
    copy[np.isnan(copy)] = np.nan
    return copy.tobytes()


def assert_batch_is_single_calls(function: Callable[..., Any], *arguments: np.ndarray, **keywords: Any) -> None:
    """Each state of a batch has the same bits as a single call."""
    batch = function(*arguments, **keywords)
    for state in range(len(arguments[0])):
        one = function(*(each[state] for each in arguments), **keywords)
        for many, single in zip(batch if isinstance(batch, tuple) else (batch,), one if isinstance(one, tuple) else (one,)):
            assert bits(many[state]) == bits(single), (function.__name__, state)


@pytest.mark.parametrize("count", [1, 7, 8, 9, 16, 27])
def test_batches_of_any_size_have_the_bits_of_single_calls(ur5: gelenk.Robot, count: int) -> None:
    # Some angles are beyond the fast path of sine and cosine, and some are NaN.
    y, v, a = np.random.default_rng(count).uniform(-3, 3, (3, count, 6))
    y[count // 2, 1], y[count // 3, 4], v[count // 3, 2] = 3e5, np.inf, np.nan
    for function in (ur5.inverse_dynamics, ur5.linearize, ur5.inverse_dynamics_derivatives):
        assert_batch_is_single_calls(function, y, v, a)
    assert_batch_is_single_calls(ur5.mass_matrix, y)
    assert_batch_is_single_calls(ur5.kinetic_energy, y, v)


def test_states_of_a_batch_may_stand_apart_or_count_for_all(ur5: gelenk.Robot) -> None:
    y, v, u = np.random.default_rng(11).uniform(-3, 3, (3, 40, 6))
    expected = ur5.linearize(y[::2], v[:20], u[0])
    padded = np.zeros((20, 9))
    padded[:, :6] = y[::2]
    others = [
        (y[::2].copy(), v[:20].copy(), np.tile(u[0], (20, 1))),
        (padded[:, :6], v[19::-1][::-1], np.broadcast_to(u[0], (20, 6))),
        (np.asfortranarray(y[::2]), np.asfortranarray(v[:20]), u[0]),
    ]
    for arguments in others:
        for found, wanted in zip(ur5.linearize(*arguments), expected):
            assert found.tobytes() == wanted.tobytes()
    grid = ur5.inverse_dynamics(y[:, None], v[None, :9], np.zeros(6))
    assert grid[31, 8].tobytes() == ur5.inverse_dynamics(y[31], v[8], np.zeros(6)).tobytes()


def test_batches_in_single_precision_have_the_bits_of_single_calls(arm_file: Path) -> None:
    short = gelenk.load(arm_file, scalar="f32", functions=["inverse_dynamics", "linearize"])
    y, v, a = np.random.default_rng(12).uniform(-3, 3, (3, 19, 2)).astype(np.float32)
    y[3, 1] = 1e6
    assert_batch_is_single_calls(short.inverse_dynamics, y, v, a)
    assert_batch_is_single_calls(short.linearize, y, v, a)


def test_parameters_count_for_all_states_of_a_batch_or_for_one(powercube: gelenk.Robot) -> None:
    y, v, a = np.random.default_rng(13).uniform(-3, 3, (3, 21, 2))
    assert_batch_is_single_calls(powercube.inverse_dynamics, y, v, a)
    name = next(iter(powercube.default_parameters))
    values = powercube.default_parameters[name] * np.linspace(0.5, 2, 21)
    assert_batch_is_single_calls(powercube.inverse_dynamics, y, v, a, **{name: values[7]})
    many = powercube.inverse_dynamics(y, v, a, **{name: values})
    for state in range(21):
        single = powercube.inverse_dynamics(y[state], v[state], a[state], **{name: values[state]})
        assert many[state].tobytes() == single.tobytes()


def test_loops_over_joints_become_lanes_where_that_is_asked_for() -> None:
    panda = gelenk.load(MODELS / "panda.toml", functions=["linearize"], lanes=["linearize"])
    y, v, u = np.random.default_rng(14).uniform(-2, 2, (3, 11, panda.N))
    assert_batch_is_single_calls(panda.linearize, y, v, u)


def test_entries_may_stand_anywhere_in_memory(ur5: gelenk.Robot) -> None:
    y, v, u = np.random.default_rng(5).uniform(-3, 3, (3, 7, 6))
    expected = ur5.linearize(y, v, u)
    wide = np.zeros((7, 12))
    wide[:, ::2] = y
    for other in (np.asfortranarray(y), wide[:, ::2], y[::-1, ::-1].copy()[::-1, ::-1], y.astype(">f8")):
        for found, wanted in zip(ur5.linearize(other, v, u), expected):
            assert np.array_equal(found, wanted)
    read_only = y.copy()
    read_only.flags.writeable = False
    assert np.array_equal(ur5.mass_matrix(read_only), ur5.mass_matrix(y))
    assert np.array_equal(ur5.mass_matrix(y.tolist()), ur5.mass_matrix(y))
    before = y.copy()
    ur5.inverse_dynamics(y, y, y)
    assert np.array_equal(y, before)


def test_a_batch_may_be_empty_and_axes_in_front_are_broadcast(ur5: gelenk.Robot) -> None:
    assert ur5.linearize(np.zeros((0, 6)), np.zeros(6), np.zeros(6)).a_y.shape == (0, 6, 6)
    y, v = np.random.default_rng(6).uniform(-3, 3, (2, 4, 6))
    grid = ur5.bias_forces(y[:, None], v)
    assert grid.shape == (4, 4, 6)
    assert np.array_equal(grid[2, 3], ur5.bias_forces(y[2], v[3]))
    periods = np.array([0.001, 0.01])
    after = ur5.step_derivatives(y[0], v[0], 0 * y[0], periods)
    assert after.dx_next_dx.shape == (2, 2, 2, 6, 6)
    assert np.array_equal(after.y_next[1], ur5.step_derivatives(y[0], v[0], 0 * y[0], 0.01).y_next)


def test_numbers_that_are_not_finite_pass_without_a_word(ur5: gelenk.Robot, recwarn: pytest.WarningsRecorder) -> None:
    y = np.array([np.inf, 0, 0, np.nan, 0, 0])
    assert np.isnan(ur5.bias_forces(y, y)).any()
    assert np.isfinite(ur5.mass_matrix(np.zeros((2, 6)))).all()
    ur5.inverse_dynamics(np.zeros(6), np.full(6, 1e300), np.zeros(6))
    assert not recwarn.list


def test_single_precision_is_described_so(arm_file: Path, arm: gelenk.Robot) -> None:
    short = gelenk.load(arm_file, scalar="f32")
    y = np.array([0.25, 0.5], np.float32)
    torques = short.inverse_dynamics(y, y, y)
    assert torques.dtype == np.float32 and short.GRAVITY.dtype == np.float32
    assert_close(torques, arm.inverse_dynamics(y, y, y), 1e-6)
    with pytest.raises(TypeError, match=r"`y` holds float64, which float32 does not hold exactly; round them yourself"):
        short.mass_matrix(np.zeros(2))


def test_parameters_are_keywords(powercube: gelenk.Robot, tmp_path: Path) -> None:
    y, v, a = np.random.default_rng(7).uniform(-1, 1, (3, 2))
    described = (MODELS / "powercube_parameters.toml").read_text("utf-8")
    described = described.replace('"powercube.toml"', f'"{MODELS / "powercube.toml"}"').replace("value = 9.80665", "value = 1.62")
    moon = tmp_path / "moon.toml"
    moon.write_text(described, "utf-8")
    described = gelenk.load(moon, functions=["inverse_dynamics", "linearize"])
    expected = described.inverse_dynamics(y, v, a)
    assert described.default_parameters["g"] == 1.62
    assert np.array_equal(powercube.inverse_dynamics(y, v, a, g=1.62), expected)
    packed = powercube.pack_parameters(g=1.62)
    assert np.array_equal(powercube.inverse_dynamics(y, v, a, parameters=packed), expected)
    assert not np.array_equal(powercube.inverse_dynamics(y, v, a), expected)
    # A batch over a parameter, and over states.
    both = powercube.linearize(np.stack([y, v]), v, a, g=np.array([1.62, 9.81]))
    assert np.array_equal(both.a_y[0], described.linearize(y, v, a).a_y)
    assert powercube.default_parameters["g"] == 9.80665
    many = powercube.pack_parameters(g=np.array([[1.0], [2.0]]), gamma_sign=np.arange(3))
    assert many.shape == (2, 3, 16)
    assert powercube.gravity_forces(y, parameters=many).shape == (2, 3, 2)


def test_blocks_of_discretize_make_the_matrices_of_the_guide() -> None:
    ur5 = gelenk.load(MODELS / "ur5.toml", functions=["gravity_forces", "discretize", "step"])
    y, v = 0.3 * np.arange(6.0), np.zeros(6)
    u = -ur5.gravity_forces(y)
    a_d, b_d, _ = ur5.discretize(y, v, u, 1e-3)
    A, B = np.block([list(row) for row in a_d]), np.concatenate(b_d)
    assert A.shape == (12, 12) and B.shape == (12, 6)
    # Near an equilibrium the hold is the derivative of `step`.
    for step in 1e-4 * np.eye(18):
        x, w = np.split(step, [12])
        ends = [np.concatenate(ur5.step(y + s * x[:6], v + s * x[6:], u + s * w, 1e-3)) for s in (1, -1)]
        np.testing.assert_allclose(ends[0] - ends[1], 2 * (A @ x + B @ w), rtol=0, atol=1e-9)


def test_a_joint_without_drives_has_empty_inputs(tmp_path: Path) -> None:
    file = tmp_path / "pendulum.toml"
    file.write_text(
        'name = "pendulum"\njoints = [{ name = "swing", axis = [0, 1, 0] }]\n'
        'bodies = [{ link = "swing", mass = 1, center_of_mass = [0, 0, -1], inertia = 0 }]\n', "utf-8"
    )
    robot = gelenk.load(file)
    assert robot.M == 0
    y = np.full((3, 1), 0.5)
    linearization = robot.linearize(y, 0 * y, np.zeros(0))
    assert linearization.b_x.shape == (3, 1, 0)
    assert_close(linearization.a_y[:, 0, 0], np.full(3, -9.81 * np.cos(0.5)))
    assert robot.input_matrix().shape == (1, 0)
    assert robot.linearize(y[0], y[0], np.zeros((5, 0))).c.shape == (5, 1)
    with pytest.raises(ValueError, match=r"`u` has the shape \(1,\), expected \(\.\.\., 0\)"):
        robot.linearize(y, y, np.zeros(1))


def test_all_of_a_robot_is_there(arm: gelenk.Robot) -> None:
    assert (arm.name, arm.N, arm.M, arm.JOINT_NAMES) == ("arm", 2, 2, ("shoulder", "elbow"))
    assert np.array_equal(arm.GEAR_RATIOS, [100, 1]) and np.isinf(arm.POSITION_LIMITS).all()
    assert arm.POSITION_LIMITS[0, 0] == -np.inf and not arm.POSITION_LIMITS.flags.writeable
    assert np.array_equal(arm.input_matrix(), [[100, 0], [0, 1]])
    y, v, a = np.random.default_rng(8).uniform(-1, 1, (3, arm.N))
    values = {"y": y, "v": v, "a": a, "u": a, "period": 0.01}
    for name in arm.FUNCTIONS:
        function = getattr(arm, name)
        told = next(each for each in arm._functions if each.name == name)
        arguments = [values[each] if each in values else np.ones(told.shapes[i]) for i, each in enumerate(told.arguments)]
        results = function(*arguments)
        results = results if len(told.results) > 1 else (results,)
        assert [np.shape(each) for each in results] == told.result_shapes, name


def test_results_are_written_to_given_arrays(powercube: gelenk.Robot, tmp_path: Path) -> None:
    y, v, a = np.random.default_rng(21).uniform(-1, 1, (3, 4, 2))
    place = np.zeros((9, 2, 2))
    assert powercube.mass_matrix(y, out=place[2:6]) is not None
    assert np.array_equal(place[2:6], powercube.mass_matrix(y)) and not place[:2].any() and not place[6:].any()
    expected = powercube.linearize(y, v, a, g=1.62)
    arrays = tuple(np.zeros_like(each) for each in expected)
    found = powercube.linearize(y, v, a, g=1.62, out=arrays)
    assert type(found) is type(expected) and all(one is other for one, other in zip(found, arrays))
    assert all(np.array_equal(one, other) for one, other in zip(arrays, expected))
    # The result may overwrite an argument.
    expected, place = powercube.inverse_dynamics(y, v, a), y.copy()
    powercube.inverse_dynamics(place, v, a, out=place)
    assert np.array_equal(place, expected)
    with pytest.raises(TypeError, match="`out` for `m` holds float32, expected float64"):
        powercube.mass_matrix(y, out=np.zeros((4, 2, 2), np.float32))
    with pytest.raises(TypeError, match="linearize: `out` must be 4 arrays of NumPy: a_y, a_v, b_x, c"):
        powercube.linearize(y, v, a, out=place)
    with pytest.raises(ValueError):
        powercube.mass_matrix(y, out=np.zeros((3, 2, 2)))
    with pytest.raises(ValueError, match="`y` has the shape"):
        powercube.mass_matrix(y[:, :1], out=np.zeros((4, 2, 2)))


def test_robots_and_their_functions_are_pickled(tmp_path: Path) -> None:
    file = tmp_path / "arm.toml"
    write(file, ARM)
    robot = gelenk.load(file, functions=iter(["mass_matrix"]), scalar="f32")
    y = np.array([0.25, 0.5], np.float32)
    again, function = (pickle.loads(pickle.dumps(each)) for each in (robot, robot.mass_matrix))
    assert again.FUNCTIONS == ("mass_matrix",) and again.dtype == np.float32
    assert np.array_equal(again.mass_matrix(y), robot.mass_matrix(y)) and np.array_equal(function(y), robot.mass_matrix(y))
    with multiprocessing.get_context("spawn").Pool(1) as pool:
        [other] = pool.map(robot.mass_matrix, [y])
    assert np.array_equal(other, robot.mass_matrix(y))
    pickled = pickle.dumps(robot)
    write(file, ARM.replace("mass = 2.0", "mass = 2.5"))
    with pytest.raises(gelenk.GelenkError, match="has changed since this robot was pickled"):
        pickle.loads(pickled)
