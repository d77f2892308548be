"""Optimal control by multiple shooting with Gauss–Newton Hessians, in CasADi."""

from __future__ import annotations

import importlib
from typing import Any, Callable, Mapping, NamedTuple, Sequence

import numpy as np

DEFAULTS = {"error_on_fail": True, "print_time": False, "print_header": False, "print_iteration": False, "print_status": False}
QP = {"qpsol": "hpipm", "qpsol_options": {"hpipm": {"mode": "balance"}, "error_on_fail": False}}
"""Options of the QP solver HPIPM, which finds the stages from the order of variables and constraints. Its mode `speed` takes four
fifths of the time, but does not solve all QPs of the tests. If a QP is not solved, the iterations end without success."""


class Motion(NamedTuple):
    """The solution of an optimal control problem: states, inputs and cost."""

    x: np.ndarray
    """States, one row per stage, including the terminal stage."""
    u: np.ndarray
    """Inputs, one row per interval."""
    cost: float
    """Cost: the sum of ½ rᵀ W r over all stages, with the residuals r and weights W."""


class Shooting:
    """An optimal control problem with its solver. `gelenk.gauss_newton` makes it."""

    def __init__(self, solver: Any, sizes: Sequence[int], stage: np.ndarray, rows: np.ndarray):
        self.solver = solver
        """Solver of CasADi. Its variables are (x_0, u_0, x_1, …, x_N). Each interval has the constraints (x_{k+1} − x⁺, rows), with
        the state x⁺ after the step. Its parameters are p_0, …, p_N."""
        self._sizes, self._stage, self._rows = tuple(sizes), stage, rows

    def solve(self, x0: Any, p: Any = (), guess: Motion | None = None) -> Motion:
        """Returns the optimal motion from the initial state `x0`.

        - `p`: parameters, of shape [parameters] for all stages together, or [N + 1, parameters] for each stage
        - `guess`: start of the iterations; by default the state `x0` at all stages, with inputs 0

        Raises CasADi's `RuntimeError` if the solver does not succeed. If its option `error_on_fail` is false, nothing is raised, and
        `solver.stats()` has the status.
        """
        nx, nu, parameters, n = self._sizes
        x0 = np.asarray(x0, float)
        if x0.shape != (nx,):
            raise ValueError(f"`x0` has the shape {x0.shape}, expected ({nx},)")
        p = np.broadcast_to(np.asarray(p, float), (n + 1, parameters))
        given = guess or Motion(np.tile(x0, (n + 1, 1)), np.zeros((n, nu)), 0.0)
        low, high = (np.tile(side, n + 1)[: n * (nx + nu) + nx] for side in self._stage)
        low[:nx] = high[:nx] = x0
        start = np.concatenate([np.hstack([given.x[:-1], given.u]).ravel(), given.x[-1]])
        sides = (np.tile(np.concatenate([np.zeros(nx), side]), n) for side in self._rows)
        found = self.solver(x0=start, p=p.ravel(), lbx=low, ubx=high, **dict(zip(("lbg", "ubg"), sides)))
        w = found["x"].full().ravel()
        stages = w[:-nx].reshape(n, nx + nu)
        return Motion(np.vstack([stages[:, :nx], w[-nx:]]), stages[:, nx:].copy(), float(found["f"]))


def gauss_newton(
    step: Callable[[Any, Any, Any], Any],
    residual: Callable[[Any, Any, Any], Any],
    terminal: Callable[[Any, Any], Any],
    *,
    states: int,
    inputs: int,
    intervals: int,
    parameters: int = 0,
    weights: Any = 1.0,
    terminal_weights: Any = 1.0,
    state_limits: Any = None,
    input_limits: Any = None,
    rows: Callable[[Any, Any, Any], Any] | None = None,
    row_limits: Any = None,
    options: Mapping[str, Any] | None = None,
) -> Shooting:
    """Returns an optimal control problem over N = `intervals`. CasADi solves it by SQP with Gauss–Newton Hessians JᵀWJ:

        min  Σ ½ r(x_k, u_k, p_k)ᵀ W r + ½ r_N(x_N, p_N)ᵀ W_N r_N    subject to    x_{k+1} = step(x_k, u_k, p_k)

    - `step`, `residual`, `terminal`: functions from CasADi symbols x [states], u [inputs], p [parameters] to the expressions
      x_{k+1}, r and r_N, for example `lambda x, u, p: robot.step(x, u, 0.02)`; `terminal` takes only x and p
    - `states`, `inputs`, `parameters`: lengths of x, u and p
    - `weights`, `terminal_weights`: W and W_N, as numbers or diagonals
    - `state_limits`, `input_limits`: lowest and highest values, of shapes [2, states] and [2, inputs]; the initial state is fixed
    - `rows`: function for further expressions, which the limits `row_limits` of shape [2, rows] bound in every interval
    - `options`: options of CasADi's `sqpmethod`; by default HPIPM solves the QPs
    """
    if (rows is None) != (row_limits is None):
        raise ValueError("`rows` and `row_limits` belong together: give both or neither")
    ca = importlib.import_module("casadi")
    n, size = intervals, states + inputs
    x, u, p = (ca.MX.sym(name, count) for name, count in [("x", states), ("u", inputs), ("p", parameters)])
    further = ca.MX(0, 1) if rows is None else rows(x, u, p)
    # Separate functions, so that the evaluation of a Hessian or a cost does not evaluate the step.
    constraint = ca.Function("constraint", [x, u, p], [ca.vertcat(step(x, u, p), further)])
    cost, hessian = _cost(ca, residual(x, u, p), [x, u, p], ca.vertcat(x, u), weights)
    last_cost, last_hessian = _cost(ca, terminal(x, p), [x, p], x, terminal_weights)
    w, all_p = ca.MX.sym("w", n * size + states), ca.MX.sym("p", parameters, n + 1)
    stages = ca.reshape(w[: n * size], size, n)
    each, last = [stages[:states, :], stages[states:, :], all_p[:, :n]], [w[n * size :], all_p[:, n]]
    following = ca.vertcat(ca.horzcat(stages[:states, 1:], last[0]), ca.MX(further.numel(), n))
    gaps = constraint.map(n)(*each) - following
    total = ca.sum2(cost.map(n)(*each)) + last_cost(*last)
    problem = {"x": w, "p": ca.vec(all_p), "f": total, "g": ca.vec(gaps)}
    hessians = ca.diagcat(*ca.horzsplit(hessian.map(n)(*each), size), last_hessian(*last))
    factor, multipliers = ca.MX.sym("lam_f"), ca.MX.sym("lam_g", problem["g"].numel())
    lagrangian = ca.Function(
        "nlp_hess_l", [w, problem["p"], factor, multipliers], [factor * hessians],
        ["x", "p", "lam_f", "lam_g"], ["triu_hess_gamma_x_x"],
    )
    chosen = dict(options or {})
    chosen = {**DEFAULTS, **({} if "qpsol" in chosen else QP), **chosen, "hess_lag": lagrangian}
    solver = ca.nlpsol("gauss_newton", "sqpmethod", problem, chosen)
    limits = np.hstack([_limits("state_limits", state_limits, states), _limits("input_limits", input_limits, inputs)])
    return Shooting(solver, [states, inputs, parameters, n], limits, _limits("row_limits", row_limits, further.numel()))


def _cost(ca: Any, r: Any, arguments: list[Any], z: Any, weights: Any) -> tuple[Any, Any]:
    """Returns the cost ½ rᵀ W r and the upper triangle of its Gauss–Newton Hessian JᵀWJ as functions."""
    diagonal = ca.DM(np.broadcast_to(np.asarray(weights, float), (r.numel(),)).copy())
    jacobian = ca.jacobian(r, z)
    hessian = ca.triu(ca.mtimes(jacobian.T, ca.mtimes(ca.diag(diagonal), jacobian)))
    return ca.Function("cost", arguments, [ca.dot(r, diagonal * r) / 2]), ca.Function("hessian", arguments, [hessian])


def _limits(name: str, limits: Any, count: int) -> np.ndarray:
    if limits is None:
        return np.stack([np.full(count, -np.inf), np.full(count, np.inf)])
    limits = np.asarray(limits, float)
    if limits.shape != (2, count):
        raise ValueError(f"`{name}` has the shape {limits.shape}, expected (2, {count})")
    return limits
