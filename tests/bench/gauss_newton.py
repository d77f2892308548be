"""Time of an optimal control problem of an arm with seven axes in CasADi: `gelenk.gauss_newton`, beside the same problem with other
solvers, all on the same external functions, in turns in one run.

    sh tests/bench/gauss_newton.sh
"""

from __future__ import annotations

import statistics
import tempfile
import time
from pathlib import Path
from typing import Any

import casadi as ca
import gelenk
import numpy as np

from conftest import SEVEN

COUNT, PERIOD, ROUNDS = 20, 0.05, 21
QUIET = {"print_time": False, "print_header": False, "print_iteration": False, "print_status": False}
SILENT = {"error_on_fail": False, "print_iter": False, "print_header": False, "print_info": False}
SOLVERS: dict[str, tuple[str, dict[str, Any]]] = {
    **{f"sqpmethod, hpipm, {mode}": ("sqpmethod", {**QUIET, "qpsol": "hpipm", "qpsol_options": {"hpipm": {"mode": mode}, "error_on_fail": False}})
       for mode in ("balance", "speed")},
    **{f"sqpmethod, {name}": ("sqpmethod", {**QUIET, "qpsol": name, "qpsol_options": SILENT}) for name in ("qrqp", "ipqp")},
    "ipopt": ("ipopt", {"print_time": False, "ipopt": {"print_level": 0, "sb": "yes"}}),
}


def main() -> None:
    file = Path(tempfile.mkdtemp()) / "seven.toml"
    file.write_text(SEVEN, "utf-8")
    robot = gelenk.casadi(file)
    start = np.concatenate([[0, 0.6, 0, 0.9, 0, 0.5, 0], np.zeros(7)])
    goal = np.concatenate([[0.5, 0.9, -0.3, 1.2, 0.4, 0.8, -0.5], np.zeros(7)])
    q, r = np.repeat([100.0, 1.0], 7), np.full(7, 1e-4)
    effort, free = np.array([80.0, 80, 50, 50, 50, 20, 20]), np.full(7, np.inf)
    for speed in (1.8, 0.9):
        sides = np.concatenate([free, np.full(7, speed)])
        own = gelenk.gauss_newton(
            lambda x, u, p: robot.step(x, u, PERIOD), lambda x, u, p: ca.vertcat(x - p, u), lambda x, p: x - p,
            states=14, inputs=7, parameters=14, intervals=COUNT, weights=np.concatenate([q, r]), terminal_weights=100 * q,
            state_limits=[-sides, sides], input_limits=[-effort, effort],
        )
        calls = {"gelenk.gauss_newton": lambda: own.solve(start, goal).cost}
        # By hand: stages in order, the state at the begin as bounds, residuals as one vector with the whole Jacobian.
        x, u = [ca.MX.sym("x", 14) for _ in range(COUNT + 1)], [ca.MX.sym("u", 7) for _ in range(COUNT)]
        w = ca.vertcat(*[each for pair in zip(x, u) for each in pair], x[-1])
        gaps = ca.vec(robot.step.map(COUNT)(ca.horzcat(*x[:-1]), ca.horzcat(*u), PERIOD) - ca.horzcat(*x[1:]))
        terms = [each for a, b in zip(x, u) for each in (np.sqrt(q) * (a - goal), np.sqrt(r) * b)]
        residual = ca.vertcat(*terms, np.sqrt(100 * q) * (x[-1] - goal))
        jacobian = ca.jacobian(residual, w)
        factor, multipliers = ca.MX.sym("f"), ca.MX.sym("g", gaps.numel())
        hessian = ca.Function(
            "nlp_hess_l", [w, ca.MX(0, 1), factor, multipliers], [factor * ca.triu(ca.mtimes(jacobian.T, jacobian))],
            ["x", "p", "lam_f", "lam_g"], ["triu_hess_gamma_x_x"],
        )
        problem = {"x": w, "f": ca.sumsqr(residual) / 2, "g": gaps}
        high = np.concatenate([np.tile(np.concatenate([sides, effort]), COUNT), sides])
        low = -high
        low[:14] = high[:14] = start
        guess = np.concatenate([np.tile(np.concatenate([start, np.zeros(7)]), COUNT), start])
        for name, (plugin, options) in SOLVERS.items():
            solver = ca.nlpsol("solver", plugin, problem, {**options, "hess_lag": hessian})
            calls[name] = lambda solver=solver: float(solver(x0=guess, lbx=low, ubx=high, lbg=0, ubg=0)["f"])
        times: dict[str, list[float]] = {name: [] for name in calls}
        costs = {}
        for _ in range(ROUNDS):
            for name, call in calls.items():
                begin = time.thread_time()
                costs[name] = call()
                times[name].append(time.thread_time() - begin)
        lowest = costs["gelenk.gauss_newton"]
        best = min(statistics.median(times[name]) for name in SOLVERS if abs(costs[name] / lowest - 1) < 1e-6)
        print(f"speeds up to {speed} rad/s: CPU time of a solution in ms, times the best by hand, error of the cost")
        for name in calls:
            median = statistics.median(times[name])
            print(f"  {name:24} {1e3 * median:8.1f} {median / best:6.2f} {abs(costs[name] / lowest - 1):9.1e}")
    limited = {"print_time": False, "ipopt": {"print_level": 0, "sb": "yes", "hessian_approximation": "limited-memory"}}
    solver = ca.nlpsol("solver", "ipopt", problem, limited)
    begin = time.thread_time()
    solver(x0=guess, lbx=low, ubx=high, lbg=0, ubg=0)
    print(f"  ipopt, limited memory    {1e3 * (time.thread_time() - begin):8.1f} {solver.stats()['return_status']}")


if __name__ == "__main__":
    main()
