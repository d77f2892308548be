"""Discrete dynamics for acados of robots with quaternions: values, Jacobians, limits about references, and a flight."""

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
pytest.importorskip("casadi", reason="casadi is not installed")

WALKER = """\
name = "walker"
base = { link = "hull", type = "floating" }
bodies = [
    { name = "hull", link = "hull", mass = 4, inertia = [0.2, 0.3, 0.4] },
    { name = "leg", link = "leg", mass = 1, center_of_mass = [0, 0.1, 0], inertia = [0.01, 0.02, 0.02] },
    { name = "boom", link = "boom", mass = "load", center_of_mass = [0, 0, 0.5], inertia = [0.1, 0.1, 0.01] },
    { name = "follower", link = "follower", mass = 0.1, inertia = 0.01 },
]
joints = [
    { name = "boom", parent = "hull", type = "spherical" },
    { name = "leg", parent = "hull", axis = [1, 0, 0], drive = "ideal", limits = { position = [-0.4, 0.9], velocity = 3 } },
    { name = "follower", parent = "hull", axis = [0, 1, 0], follows = { leg = 2 }, offset = 0.1, limits = { position = [-1, 1] } },
]
generate = { substeps = 2 }
parameters = { load = 1.5 }
"""

PERIOD, INTERVALS = 0.02, 15


class Problem:
    """A robot for acados, compiled, and the same robot for CasADi."""

    def __init__(self, description: Path, folder: Path):
        functions = ["step", "step_derivatives"]
        self.casadi, self.robot = (load(description, functions=functions) for load in (gelenk.casadi, gelenk.load))
        self.module = module = gelenk.acados(description)
        self.ocp = module.ocp(INTERVALS, PERIOD, compile_flags="-O1")
        weights = [np.repeat([1e2, 1.0], module.N), np.full(module.M, 1e-2)]
        module.track(self.ocp, *weights, terminal_weight=weights[0])
        self.ocp.code_export_directory = str(folder / "generated")
        self.solver = module.solver(self.ocp, json_file=str(folder / "ocp.json"), verbose=False)


class Listener:
    """Records the values that are set in a solver."""

    def __init__(self) -> None:
        self.told: dict[int, dict[str, np.ndarray]] = {}

    def set(self, stage: int, name: str, values: np.ndarray) -> None:
        self.told.setdefault(stage, {})[name] = values

    constraints_set = set


@pytest.fixture(scope="module")
def walker(tmp_path_factory: pytest.TempPathFactory, cache: Path) -> Problem:
    folder = tmp_path_factory.mktemp("walker")
    file = folder / "walker.toml"
    file.write_text(WALKER, "utf-8")
    return Problem(file, folder)


@pytest.fixture(scope="module")
def quadrotor(tmp_path_factory: pytest.TempPathFactory, cache: Path) -> Problem:
    return Problem(MODELS / "quadrotor.toml", tmp_path_factory.mktemp("quadrotor"))


@pytest.mark.parametrize("name", ["walker", "quadrotor"])
def test_values_and_jacobians_are_those_for_casadi(name: str, request: Any) -> None:
    problem = request.getfixturevalue(name)
    module, robot = problem.module, problem.robot
    n, rng = module.N, np.random.default_rng(5)
    externals = Externals(problem.solver)
    free = [[1.2]] if module.PARAMETERS else []
    values = dict(zip(module.PARAMETERS, *free)) if free else {}
    for size in (0.0, 0.3, 1.2):
        y_ref = robot.integrate(robot.NEUTRAL, rng.uniform(-1, 1, n))
        y_ref_next = robot.integrate(y_ref, rng.uniform(-0.1, 0.1, n))
        x, u = rng.uniform(-1, 1, 2 * n), rng.uniform(0, 5, module.M)
        x[:n] *= size
        parameters = module.parameters(0.02, values, y_ref, y_ref_next)
        found, jacobian = externals.call(module.STEP_DERIVATIVES, x, u, parameters)
        alone, _ = externals.call(module.STEP, x, u, parameters)
        arguments = [x, u, 0.02, y_ref, y_ref_next, *free]
        expected = problem.casadi.step(*arguments).full().ravel()
        by_x, by_u, *_ = problem.casadi.step.jacobian()(*arguments, 0)
        both = np.hstack([by_u.full(), by_x.full()])
        for value in (alone, found):
            assert np.abs(value - expected).max() <= 1e-14 * np.abs(expected).max()
        assert np.abs(jacobian - both).max() <= 1e-13 * np.abs(both).max()


def test_differences_are_those_of_the_module(walker: Problem) -> None:
    module, robot = walker.module, walker.robot
    rng = np.random.default_rng(6)
    for size in (0, 1e-9, 1e-3, 0.19, 0.5, 1.7):
        y = robot.integrate(robot.NEUTRAL, rng.uniform(-2, 2, module.N))
        d = rng.uniform(-1, 1, module.N) * size
        other = robot.integrate(y, d)
        assert np.abs(module.difference(y, other) - d).max() <= 1e-14 * max(1, size)
    # Both signs of a quaternion are the same attitude, and its length has no effect.
    other[3:7] *= -2
    assert np.abs(module.difference(y, other) - d).max() <= 1e-14 * size
    other[3:7] = 0
    with pytest.raises(ValueError, match="has no direction"):
        module.difference(y, other)
    with pytest.raises(ValueError, match=r"positions have the shape \(3,\), not \(12,\)"):
        module.parameters(0.02, y_ref=np.zeros(3))
    with pytest.raises(ValueError, match="walker has no parameter `mass`; it has load"):
        module.parameters(0.02, {"mass": 1})


def test_limits_move_with_references(walker: Problem) -> None:
    module, ocp, solver = walker.module, walker.ocp, walker.solver
    constraints = ocp.constraints
    leg = module.VELOCITY_NAMES.index("leg")
    assert np.array_equal(constraints.idxbx, [leg, module.N + leg])
    assert np.array_equal(constraints.ubx, [0.9, 3]) and np.array_equal(constraints.C[0, [leg]], [2])
    references = np.tile(module.NEUTRAL, (INTERVALS + 1, 1))
    place = dict(zip(module.FIRST_VELOCITIES, module.FIRST_POSITIONS))[leg]
    references[:, place] = np.linspace(0, 0.3, INTERVALS + 1)
    module.refer(solver, ocp, references)
    heard = Listener()
    module.refer(heard, ocp, references)
    for stage, shift in enumerate(references[:, place]):
        told = heard.told[stage]
        assert ("ubx" in told) == (stage > 0), "the first state is given"
        if stage > 0:
            assert np.allclose(told["lbx"], [-0.4 - shift, -3]) and np.allclose(told["ubx"], [0.9 - shift, 3])
        assert np.allclose(told["lg"], [-1.1 - 2 * shift]) and np.allclose(told["ug"], [0.9 - 2 * shift])
        if stage < INTERVALS:
            assert np.array_equal(told["p"], module.parameters(PERIOD, None, *references[stage : stage + 2]))
    with pytest.raises(ValueError, match="references have the shape"):
        module.refer(solver, ocp, references[1:])
    module.refer(solver, ocp, np.tile(module.NEUTRAL, (INTERVALS + 1, 1)))


def test_a_quadrotor_follows_turning_references(quadrotor: Problem) -> None:
    """The robot climbs and makes two turns about the vertical. It starts 0.4 rad away; the plant is the model with shorter steps."""
    module, robot, solver = quadrotor.module, quadrotor.robot, quadrotor.solver
    n, hover, count = module.N, np.full(module.M, 1.52 * 9.81 / 4), 150
    turned = 4 * np.pi / count * np.arange(count + INTERVALS + 1)
    references = np.zeros((turned.size, module.NY))
    references[:, 2] = 0.2 * turned
    references[:, 5:] = np.stack([np.sin(turned / 2), np.cos(turned / 2)], axis=1)
    speed = module.difference(references[0], references[1]) / PERIOD
    x_d = np.concatenate([np.zeros(n), speed])
    y, v = robot.integrate(references[0], np.array([0.1, 0, 0, 0.4, 0, 0])), speed
    for stage in range(INTERVALS):
        solver.set(stage, "u", hover)
        solver.set(stage, "x", x_d)
        solver.set(stage, "yref", np.concatenate([x_d, hover]))
    for name in ("x", "yref"):
        solver.set(INTERVALS, name, x_d)
    for k in range(count):
        module.refer(solver, quadrotor.ocp, references[k : k + INTERVALS + 1])
        inputs = solver.solve_for_x0(np.concatenate([module.difference(references[k], y), v]))
        assert solver.status == 0 and inputs.min() >= -1e-6 and inputs.max() <= 8 + 1e-6
        for _ in range(4):
            y, v = robot.step(y, v, inputs, PERIOD / 4)
    assert np.abs(module.difference(references[count], y)).max() < 0.02
