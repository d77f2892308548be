"""Time of whole control steps: acados' real-time iterations on gelenk's functions, and the LTV-MPC and NMPC of the runtime.

All of them solve the same problems (model, horizon, weights, limits, reference, initial state), each in a closed loop of its
own, in turns on one core. `acados.sh` builds what is needed and calls this with the library of `step_plugin.rs`.

Times are CPU times of the thread around one call in C, so that other programs on the machine count little. acados' call
is `…_acados_solve`: linearization and QP; references are set before. The calls of the others are the whole step: reference,
feed-forward, observer, linearization and QP.
"""

from __future__ import annotations

import contextlib
import ctypes
import os
import re
import sys
import tempfile
from pathlib import Path
from time import thread_time_ns
from typing import Any

import numpy as np

import acados_wheel
import gelenk

ROBOTS = ["powercube", "ur5", "panda"]
MODELS = Path(__file__).resolve().parents[2] / "models"
FLAGS = "-O3 -march=native"

# How acados solves its QPs; the table has the fastest for each robot.
SETTINGS: dict[str, dict[str, Any]] = {
    "as by default": {},
    "condensed to 5 stages": {"qp_solver_cond_N": 5},
    "condensed to 5 stages, SPEED": {"qp_solver_cond_N": 5, "hpipm_mode": "SPEED"},
    "condensed fully": {"qp_solver": "FULL_CONDENSING_HPIPM"},
}
ROUNDS = 3


def array(numbers: np.ndarray) -> Any:
    return numbers.ctypes.data_as(ctypes.c_void_p)


class Ours:
    """A controller of the runtime."""

    def __init__(self, library: Any, robot: int, nonlinear: bool):
        self.library = library
        self.handle = ctypes.c_void_p(library.steps_create(robot, int(nonlinear)))
        assert self.handle.value, "there is no such controller"
        sizes = np.zeros(6)
        library.steps_sizes(self.handle, array(sizes))
        self.n, self.m, self.horizon, self.substeps = (int(sizes[i]) for i in (0, 1, 2, 4))
        self.period, self.seconds = sizes[3], sizes[5]

    def settings(self) -> list[np.ndarray]:
        """Weights of states and inputs, lowest and highest inputs, lowest and highest states, penalties."""
        lengths = [2 * self.n, self.m, self.m, self.m, 2 * self.n, 2 * self.n, 2]
        numbers = np.zeros(sum(lengths))
        self.library.steps_settings(self.handle, array(numbers))
        return np.split(numbers, np.cumsum(lengths)[:-1])

    def reference(self, time: float) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
        k, nx, m = self.horizon, 2 * self.n, self.m
        numbers = np.zeros((k + 1) * nx + k * m + nx * nx)
        self.library.steps_reference(self.handle, ctypes.c_double(time), array(numbers))
        states, inputs, terminal = np.split(numbers, np.cumsum([(k + 1) * nx, k * m]))
        return states.reshape(k + 1, nx), inputs.reshape(k, m), terminal.reshape(nx, nx)

    def after(self, state: np.ndarray, inputs: np.ndarray) -> np.ndarray:
        state = state.copy()
        self.library.steps_plant(self.handle, array(state), array(inputs))
        return state

    def restart(self, state: np.ndarray, last: np.ndarray) -> None:
        self.last = last.copy()

    def step(self, time: float, state: np.ndarray) -> tuple[np.ndarray, float]:
        words = self.handle, ctypes.c_double(time), array(state), array(self.last)
        begin = thread_time_ns()
        status = self.library.steps_step(*words)
        spent = thread_time_ns() - begin
        assert status >= 0, "the controller refuses"
        return self.last, spent * 1e-9


class Acados:
    """The same problem for acados."""

    def __init__(self, robot: str, ours: Ours, options: dict[str, Any], folder: Path):
        self.ours, self.n, self.m, self.horizon = ours, ours.n, ours.m, ours.horizon
        module = gelenk.acados(description(robot, ours.substeps, folder))
        period = ours.period
        problem = module.ocp(ours.horizon, period, compile_flags=FLAGS)
        q, r, low, high, least, most, (linear, quadratic) = ours.settings()
        limits = problem.constraints
        limits.idxbu, limits.lbu, limits.ubu = np.arange(self.m), low, high
        limited = np.flatnonzero(np.isfinite(most))
        assert np.array_equal(limits.idxbx, limited) and np.allclose(limits.lbx, least[limited])
        assert np.allclose(limits.ubx, most[limited])
        # acados multiplies costs of stages by their period.
        module.track(problem, q / period, r / period, ours.reference(0.0)[2])
        module.soften(problem, linear / period, quadratic / period)
        for name, value in options.items():
            setattr(problem.solver_options, name, value)
        problem.code_export_directory = str(folder / "generated")
        self.solver = module.solver(problem, json_file=str(folder / "ocp.json"), verbose=False)
        self.solve = getattr(self.solver.shared_lib, f"{module.NAME}_acados_solve")
        self.solve.argtypes, self.solve.restype = [ctypes.c_void_p], ctypes.c_int

    def restart(self, state: np.ndarray, last: np.ndarray) -> None:
        states, inputs, _ = self.ours.reference(0.0)
        self.guess = states.copy(), inputs.copy()
        self.solver.reset()

    def step(self, time: float, state: np.ndarray) -> tuple[np.ndarray, float]:
        solver, horizon = self.solver, self.horizon
        states, inputs, terminal = self.ours.reference(time)
        for k in range(horizon):
            solver.set(k, "yref", np.concatenate([states[k], inputs[k]]))
            solver.set(k, "x", self.guess[0][k])
            solver.set(k, "u", self.guess[1][k])
        solver.set(horizon, "x", self.guess[0][horizon])
        solver.set(horizon, "yref", states[horizon])
        solver.cost_set(horizon, "W", terminal)
        solver.set(0, "lbx", state)
        solver.set(0, "ubx", state)
        begin = thread_time_ns()
        status = self.solve(solver.capsule)
        spent = thread_time_ns() - begin
        assert status == 0, f"acados ended with status {status} at {time} s"
        found = [solver.get(k, "x") for k in range(horizon + 1)], [solver.get(k, "u") for k in range(horizon)]
        # The next guess: this plan one period later, its end the reference.
        after = self.ours.reference(time + self.ours.period)
        self.guess = np.array([*found[0][1:], after[0][-1]]), np.array([*found[1][1:], after[1][-1]])
        return found[1][0], spent * 1e-9


def description(robot: str, substeps: int, folder: Path) -> Path:
    """The robot with as many Runge-Kutta steps in a period as the controllers take, whose traits count their own."""
    path = MODELS / f"{robot}.toml"
    text = path.read_text("utf-8")
    known = re.search(r"^substeps = (\d+)", text, re.MULTILINE)
    if known is None:
        assert substeps == 1, f"{path} says nothing of substeps"
        return path
    file = folder / path.name
    file.write_text(text.replace(known[0], f"substeps = {substeps}"), "utf-8")
    return file


@contextlib.contextmanager
def quiet() -> Any:
    """acados tells of all that it does."""
    sys.stdout.flush()
    kept, nothing = os.dup(1), os.open(os.devnull, os.O_WRONLY)
    os.dup2(nothing, 1)
    try:
        yield
    finally:
        sys.stdout.flush()
        os.dup2(kept, 1)


def measure(robot: str, library: Any, folder: Path) -> None:
    index = ROBOTS.index(robot)
    ours = {"LTV-MPC": Ours(library, index, False), "NMPC": Ours(library, index, True)}
    first = ours["LTV-MPC"]
    contenders: dict[str, Any] = dict(ours)
    with quiet():
        for number, (name, options) in enumerate(SETTINGS.items()):
            place = folder / f"{robot}_{number}"
            place.mkdir()
            contenders[f"acados, {name}"] = Acados(robot, first, options, place)
    times: dict[str, list[float]] = {name: [] for name in contenders}
    errors = {name: 0.0 for name in contenders}
    apart = {name: 0.0 for name in contenders}
    periods = round(first.seconds / first.period) + 20
    for turn in range(ROUNDS):
        # Controllers of the runtime begin anew.
        for number, name in enumerate(ours):
            contenders[name] = Ours(library, index, number == 1)
        references, inputs, _ = first.reference(0.0)
        states = {name: references[0].copy() for name in contenders}
        for contender in contenders.values():
            contender.restart(references[0], inputs[0])
        for k in range(periods):
            names = list(contenders)
            names = names[k % len(names) :] + names[: k % len(names)]
            chosen = {}
            for name in names:
                found, seconds = contenders[name].step(k * first.period, states[name])
                times[name].append(1e6 * seconds)
                chosen[name] = found.copy()
                states[name] = first.after(states[name], found)
            desired = first.reference((k + 1) * first.period)[0][0][: first.n]
            for name in names:
                errors[name] = max(errors[name], np.abs(states[name][: first.n] - desired).max())
                apart[name] = max(apart[name], (np.abs(chosen[name] - chosen["NMPC"]) / first.settings()[3]).max())
    for name in contenders:
        numbers = np.array(times[name])
        print(
            f"{robot:<10} {name:<40} median {np.median(numbers):7.1f} us, 95 % {np.quantile(numbers, 0.95):7.1f} us, "
            f"tracking error {errors[name]:.1e}, inputs from NMPC's {apart[name]:.1e} of the limit"
        )
    print(f"{robot:<10} {len(times['NMPC'])} steps each, {first.substeps} steps of Runge-Kutta in a period", flush=True)


def main() -> None:
    if not acados_wheel.find():
        print("skipped: acados is not installed")
        return
    library = ctypes.CDLL(sys.argv[1])
    library.steps_create.restype = ctypes.c_void_p
    library.steps_step.restype = ctypes.c_double
    if hasattr(os, "sched_setaffinity"):
        os.sched_setaffinity(0, {max(os.sched_getaffinity(0))})
    with tempfile.TemporaryDirectory() as place:
        for robot in sys.argv[2:] or ROBOTS:
            measure(robot, library, Path(place))


if __name__ == "__main__":
    main()
