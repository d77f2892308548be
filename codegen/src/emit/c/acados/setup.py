"""A robot for acados: defines an optimal control problem with the robot's dynamics and limits.

    import gelenk_acados as robot

    ocp = robot.ocp(intervals=20, period=0.02)
    robot.track(ocp, state_weight, input_weight)
    solver = robot.solver(ocp)

STATE `acados_template` and `casadi` have to be installed.
"""

from __future__ import annotations

import ctypes
import importlib.util
import os
import sys
import warnings
from pathlib import Path
from typing import Any, Mapping

import casadi
import numpy as np


def _find_template() -> None:
    """Makes `acados_template` importable if the wheel `acados` contains it together with the libraries of acados."""
    wheel = importlib.util.find_spec("acados")
    if importlib.util.find_spec("acados_template") is not None or wheel is None or wheel.origin is None:
        return
    package = Path(wheel.origin).parent
    sys.path.append(str(package))
    os.environ.setdefault("ACADOS_SOURCE_DIR", str(package / "install"))
    os.environ.setdefault("ACADOS_PYTHON_INTERFACE_PATH", str(package / "acados_template"))
    # libacados needs these libraries, but does not find them.
    for name in ("blasfeo", "hpipm", "qpOASES_e"):
        for library in sorted((package / "install" / "lib").glob(f"lib{name}.*")):
            ctypes.CDLL(str(library))


_find_template()
from acados_template import AcadosModel, AcadosOcp, AcadosOcpSolver  # noqa: E402

FOLDER = Path(__file__).resolve().parent
"""Folder of the C sources."""
# constants

UNLIMITED = 1e9
"""Value of an infinite bound for acados."""


# parameters


def model() -> AcadosModel:
    """Returns the model: symbols of states, inputs and parameters, and the functions of the dynamics."""
    made = AcadosModel()
    made.name = NAME
    made.x = casadi.SX.sym("x", 2 * N)
    made.xdot = casadi.SX.sym("xdot", 2 * N)
    made.u = casadi.SX.sym("u", M)
    made.p = casadi.SX.sym("p", parameters(0.0).size)
    made.dyn_ext_fun_type = "generic"
    made.dyn_generic_source = SOURCE
    made.dyn_disc_fun = STEP
    made.dyn_disc_fun_jac = STEP_DERIVATIVES
    return made


def ocp(
    intervals: int,
    period: float,
    *,
    values: Mapping[str, float] | None = None,
    peak: bool = True,
    compile_flags: str = "-O2",
) -> AcadosOcp:
    """Returns a problem over `intervals` periods, with the robot's dynamics and limits, and without a cost.

    - `period`: length of a period in s
    - `values`: values of free parameters; all other parameters have the values of the description
    - `peak`: whether the peak limits of motors and joints are used instead of the nominal limits
    - `compile_flags`: flags of the C compiler, e.g. `"-O3 -march=native"`

    The problem is solved by real-time iterations with Gauss-Newton Hessians. Its initial state is x = 0 until
    `solver.set(0, "lbx", x)` and `solver.set(0, "ubx", x)` set another state.
    """
    made = AcadosOcp()
    made.model = model()
    options = made.solver_options
    if hasattr(options, "N_horizon"):
        options.N_horizon = intervals
    else:
        made.dims.N = intervals
    options.tf = intervals * period
    options.integrator_type = "DISCRETE"
    options.nlp_solver_type = "SQP_RTI"
    options.hessian_approx = "GAUSS_NEWTON"
    options.qp_solver = "PARTIAL_CONDENSING_HPIPM"
    # The source includes the module, which is in the folder of this file.
    options.ext_fun_compile_flags = f'{compile_flags} -I"{FOLDER}"'
    made.parameter_values = parameters(period, values)
    made.constraints.x0 = np.zeros(2 * N)
    limit(made, peak=peak)
    return made


def limit(ocp: AcadosOcp, *, peak: bool = True) -> None:
    """Sets the limits of the description as hard bounds: inputs, positions and velocities of joints, joints that follow others, forces
    at joints on which several inputs act, and torque-speed lines of motors."""
    for what in LEFT_OUT:
        warnings.warn(f"{what} are not among the bounds, because they are not constant bounds of x and u", stacklevel=3)
    constraints = ocp.constraints
    bounds, rows = input_limits(peak)
    constraints.idxbu, constraints.lbu, constraints.ubu = _finite(bounds)
    speeds = np.stack([-VELOCITY_LIMITS, VELOCITY_LIMITS], axis=1)
    states = _finite(np.concatenate([POSITION_LIMITS, speeds]))
    constraints.idxbx, constraints.lbx, constraints.ubx = states
    constraints.idxbx_e, constraints.lbx_e, constraints.ubx_e = states
    # Rows lg <= C x + D u <= ug. Rows with u are omitted at the last stage, which has no input.
    of_states, sides = _of_followers()
    by_states, by_inputs, line_sides = _of_motors()
    constraints.C = np.concatenate([of_states, np.zeros((len(rows), 2 * N)), by_states])
    constraints.D = np.concatenate([np.zeros((len(sides), M)), rows[:, :M], by_inputs])
    constraints.lg, constraints.ug = _within(np.concatenate([sides, rows[:, M:], line_sides]))
    constraints.C_e = of_states
    constraints.lg_e, constraints.ug_e = _within(sides)


def input_limits(peak: bool = True) -> tuple[np.ndarray, np.ndarray]:
    """Returns the lowest and highest value of each input from the limits of motors and joints, and a row (entries of B, lowest force,
    highest force) for each joint on which several inputs act."""
    motors = PEAK_INPUT_LIMITS if peak else INPUT_LIMITS
    low, high = np.maximum(-motors, INPUT_RANGES[:, 0]), np.minimum(motors, INPUT_RANGES[:, 1])
    rows = []
    for effort, row in zip(PEAK_EFFORT_LIMITS if peak else EFFORT_LIMITS, INPUT_MATRIX):
        acting = np.flatnonzero(row)
        if acting.size == 1:
            most = effort / abs(row[acting])
            low[acting], high[acting] = np.maximum(low[acting], -most), np.minimum(high[acting], most)
        elif acting.size > 1 and np.isfinite(effort):
            rows.append([*row, -effort, effort])
    return np.stack([low, high], axis=1), np.array(rows).reshape(len(rows), M + 2)


def soften(ocp: AcadosOcp, linear: float, quadratic: float) -> None:
    """Makes the bounds of states soft. A violation s costs linear s + quadratic s² / 2 per second; at the last stage it counts for one
    period. Rows with inputs stay hard."""
    constraints, cost, steps = ocp.constraints, ocp.cost, _intervals(ocp)
    constraints.idxsbx, constraints.idxsbx_e = np.arange(constraints.idxbx.size), np.arange(constraints.idxbx_e.size)
    followers = np.flatnonzero(np.any(constraints.C, axis=1) & ~np.any(constraints.D, axis=1))
    constraints.idxsg, constraints.idxsg_e = followers, np.arange(constraints.lg_e.size)
    count, count_e = constraints.idxbx.size + followers.size, constraints.idxbx_e.size + constraints.lg_e.size
    cost.zl = cost.zu = np.full(count, linear)
    cost.Zl = cost.Zu = np.full(count, quadratic)
    last = ocp.solver_options.tf / steps
    cost.zl_e = cost.zu_e = np.full(count_e, linear * last)
    cost.Zl_e = cost.Zu_e = np.full(count_e, quadratic * last)


def track(ocp: AcadosOcp, state_weight: Any, input_weight: Any, terminal_weight: Any = None) -> None:
    """Sets the cost of deviations from references x_d and u_d: (x − x_d)ᵀ Q (x − x_d) / 2 + (u − u_d)ᵀ R (u − u_d) / 2 per second.

    - `state_weight`, `input_weight`: Q and R, matrices or their diagonals
    - `terminal_weight`: P of the cost (x − x_d)ᵀ P (x − x_d) / 2 at the last stage; by default Q times the period

    `solver.set(stage, "yref", (x_d, u_d))` sets the references of a stage. The last stage only has x_d. References are 0 until set.
    """
    states, inputs = _square(state_weight), _square(input_weight)
    last = states * ocp.solver_options.tf / _intervals(ocp) if terminal_weight is None else _square(terminal_weight)
    cost = ocp.cost
    cost.cost_type = cost.cost_type_e = "LINEAR_LS"
    cost.W = np.block([[states, np.zeros((2 * N, M))], [np.zeros((M, 2 * N)), inputs]])
    cost.Vx, cost.Vu = np.eye(2 * N + M, 2 * N), np.eye(2 * N + M, M, -2 * N)
    cost.yref = np.zeros(2 * N + M)
    cost.W_e, cost.Vx_e, cost.yref_e = last, np.eye(2 * N), np.zeros(2 * N)


def solver(ocp: AcadosOcp, **options: Any) -> AcadosOcpSolver:
    """Returns the compiled solver of a problem. The period of each stage is taken from the time steps of the problem.

    acados searches sources only in the current folder. Therefore the folder of this file is the current folder during the
    generation. Output files are written to the usual folders. `options` are the options of `AcadosOcpSolver`.
    """
    before = Path.cwd()
    # In later versions of acados, this folder is an option of code generation.
    owner = getattr(ocp, "code_gen_opts", ocp)
    owner.code_export_directory = os.path.abspath(owner.code_export_directory)
    options["json_file"] = os.path.abspath(options.get("json_file", f"{NAME}_acados_ocp.json"))
    os.chdir(FOLDER)
    try:
        made = AcadosOcpSolver(ocp, **options)
    finally:
        os.chdir(before)
    for stage, period in enumerate(ocp.solver_options.time_steps):
        made.set(stage, "p", np.array([period, *ocp.parameter_values[1:]]))
    return made


def _intervals(ocp: AcadosOcp) -> int:
    return getattr(ocp.solver_options, "N_horizon", None) or ocp.dims.N


def _square(weight: Any) -> np.ndarray:
    weight = np.asarray(weight, float)
    return np.diag(weight) if weight.ndim == 1 else weight


def _finite(ranges: np.ndarray) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Returns the indices of ranges with a finite bound, and their lower and upper bounds."""
    limited = np.flatnonzero(np.isfinite(ranges).any(axis=1))
    return limited, *_within(ranges[limited])


def _within(ranges: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    return np.maximum(ranges[:, 0], -UNLIMITED), np.minimum(ranges[:, 1], UNLIMITED)


def _of_followers() -> tuple[np.ndarray, np.ndarray]:
    """Returns rows of x and their bounds, for limited positions and speeds of joints that follow others."""
    ratios = DEPENDENT_JOINT_RATIOS
    none = np.zeros_like(ratios)
    rows = np.concatenate([np.hstack([ratios, none]), np.hstack([none, ratios])])
    speeds = np.stack([-DEPENDENT_VELOCITY_LIMITS, DEPENDENT_VELOCITY_LIMITS], axis=1)
    sides = np.concatenate([DEPENDENT_POSITION_LIMITS - DEPENDENT_JOINT_OFFSETS[:, None], speeds])
    limited = np.isfinite(sides).any(axis=1)
    return rows[limited], sides[limited]


def _of_motors() -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Returns rows of x, rows of u and their bounds, for torque-speed lines |u + C v| <= limit."""
    limited = np.flatnonzero(np.isfinite(TORQUE_SPEED_LIMITS))
    slopes, limits = TORQUE_SPEED_SLOPES[limited], TORQUE_SPEED_LIMITS[limited]
    return np.hstack([np.zeros_like(slopes), slopes]), np.eye(M)[limited], np.stack([-limits, limits], axis=1)
