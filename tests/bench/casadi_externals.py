"""Evaluates gelenk's external functions and CasADi's own over the same states; prints ratios of their times."""

from __future__ import annotations

import os
import shlex
import statistics
import subprocess
import sys
import time
from pathlib import Path

import casadi as ca
import numpy as np
import rbd_symbolic as symbolic

STATES = 1000
ROUNDS = 31
COMPILER = [*shlex.split(os.environ.get("CC", "cc")), *shlex.split(os.environ.get("CFLAGS", "-O3 -march=native")), "-fPIC", "-shared"]


def main() -> None:
    robot, work = sys.argv[1], Path(sys.argv[2])
    library = compiled(work / f"lib{robot}.so", [work / f"{robot}.c", work / f"{robot}_casadi.c"])
    own = {name: ca.external(f"{robot}_casadi_{name}", library) for name in ("inverse_dynamics", "dynamics")}
    others = [generated(robot, work, base) for base in (False, True)]
    print(f"{robot}: times as fast as CasADi's own C, the faster of two, with and without what an empty function takes; µs per evaluation")
    for name, inputs in (("inverse_dynamics", 3), ("dynamics", 2)):
        arguments = [ca.DM(np.random.default_rng(index).uniform(-1, 1, (own[name].size1_in(index), STATES))) for index in range(inputs)]
        compare(name, own[name], [[other[name]] for other in others], arguments, hollow(own[name], work))
        outputs = ca.DM.zeros(own[name].size1_out(0), STATES)
        jacobians = [[jacobian for key, jacobian in other.items() if key.startswith(f"jac_{name}")] for other in others]
        derivative = own[name].jacobian()
        compare(f"Jacobian of {name}", derivative, jacobians, [*arguments, outputs], hollow(derivative, work))


def compiled(library: Path, sources: list[Path]) -> str:
    subprocess.run([*COMPILER, "-o", library, *sources, "-lm"], check=True)
    return str(library)


def generated(robot: str, work: Path, base: bool) -> dict[str, ca.Function]:
    """CasADi's own functions. `base`: with the inertial parameters regrouped and common subexpressions taken out."""
    model = symbolic.Model(str(work / "models" / f"{robot}.txt"), base=base)
    name = f"{robot}_{'regrouped' if base else 'described'}"
    functions = [tidy(each) if base else each for each in expressions(model)]
    generator = ca.CodeGenerator(f"{name}.c")
    for each in functions:
        generator.add(each)
    generator.generate(f"{work}/")
    library = compiled(work / f"lib{name}.so", [work / f"{name}.c"])
    return {each.name(): ca.external(each.name(), library) for each in functions}


def tidy(function: ca.Function) -> ca.Function:
    symbols = function.sx_in()
    return ca.Function(function.name(), symbols, ca.cse(function.call(symbols)))


def expressions(model: symbolic.Model) -> list[ca.Function]:
    """Inverse dynamics and ẋ = f(x, u), and their Jacobians by CasADi; that of f by the inverse dynamics too."""
    n = model.n
    y, v, a, u = (ca.SX.sym(name, n) for name in "yvau")
    entries = lambda x: [x[i] for i in range(n)]
    column = lambda xs: ca.vertcat(*[ca.SX(x) for x in xs])
    sines, cosines = [ca.sin(y[i]) for i in range(n)], [ca.cos(y[i]) for i in range(n)]
    torques = column(symbolic.rnea(model, sines, cosines, entries(v), entries(a)))
    acceleration = column(symbolic.aba(model, sines, cosines, entries(v), entries(u)))
    inverse = ca.Function("inverse_dynamics", [y, v, a], [torques])
    x = ca.vertcat(y, v)
    free = ca.SX.sym("x", 2 * n)
    forward = ca.Function("dynamics_of", [x, u], [ca.vertcat(v, acceleration)])
    dynamics = ca.Function("dynamics", [free, u], [forward(free, u)])
    by_inverse = implicit(model, [sines, cosines], torques, [y, v, a, u])
    unused, unused_torques = ca.SX.sym("o", 2 * n), ca.SX.sym("t", n)
    blocks = [ca.jacobian(dynamics(free, u), each) for each in (free, u)]
    return [
        inverse,
        ca.Function("jac_inverse_dynamics", [y, v, a, unused_torques], [ca.jacobian(torques, each) for each in (y, v, a)]),
        dynamics,
        ca.Function("jac_dynamics", [free, u, unused], blocks),
        ca.Function("jac_dynamics_implicit", [free, u, unused], list(by_inverse(free[:n], free[n:], u))),
    ]


def implicit(model: symbolic.Model, angles: list[list[ca.SX]], torques: ca.SX, symbols: list[ca.SX]) -> ca.Function:
    """∂f/∂x and ∂f/∂u by a = M⁻¹ (u − k): ∂a = −M⁻¹ ∂τ(y, v, a)."""
    n = model.n
    y, v, a, u = symbols
    column = lambda xs: ca.vertcat(*[ca.SX(x) for x in xs])
    mass = symbolic.crba(model, *angles)
    bias = symbolic.rnea(model, *angles, [v[i] for i in range(n)], [0.0] * n)
    right = [symbolic.sub(u[i], bias[i]) for i in range(n)]
    unit = [[1.0 if i == j else 0.0 for i in range(n)] for j in range(n)]
    solved = symbolic.ldl_solve(mass, [right, *unit])
    by_state = ca.Function("by_state", [y, v, a], [ca.jacobian(torques, y), ca.jacobian(torques, v)])
    columns = []
    for block in by_state(y, v, column(solved[0])):
        columns += symbolic.ldl_solve(mass, [[-block[i, j] for i in range(n)] for j in range(n)])
    upper = ca.horzcat(ca.SX(n, n), ca.SX.eye(n))
    by_x = ca.vertcat(upper, ca.horzcat(*[column(each) for each in columns]))
    by_u = ca.vertcat(ca.SX(n, n), ca.horzcat(*[column(each) for each in solved[1:]]))
    return ca.Function("implicit", [y, v, u], [by_x, by_u])


def hollow(function: ca.Function, work: Path) -> ca.Function:
    """A function of the same inputs and outputs that stores zeros: what CasADi takes to call one."""
    name = f"hollow_{function.name()}"
    inputs = [ca.SX.sym(f"i{index}", function.sparsity_in(index)) for index in range(function.n_in())]
    outputs = [ca.SX(ca.DM(function.sparsity_out(index), 0.0)) for index in range(function.n_out())]
    generator = ca.CodeGenerator(f"{name}.c")
    generator.add(ca.Function(name, inputs, outputs))
    generator.generate(f"{work}/")
    return ca.external(name, compiled(work / f"lib{name}.so", [work / f"{name}.c"]))


def compare(
    name: str, own: ca.Function, others: list[list[ca.Function]], arguments: list[ca.DM], empty: ca.Function
) -> None:
    contenders = [own, *[each for other in others for each in other]]
    batches = [each.map(STATES) for each in contenders]
    values = [batch(*arguments) for batch in batches]
    values = [each if isinstance(each, (tuple, list)) else [each] for each in values]
    for each in values[1:]:
        for found, expected in zip(each, values[0], strict=True):
            difference = np.abs(found.full() - expected.full()).max()
            assert difference <= 1e-9 * np.abs(expected.full()).max(), (name, difference)
    batches.append(empty.map(STATES))
    times = [[] for _ in batches]
    buffers = [buffered(batch, arguments) for batch in batches]
    for _ in range(ROUNDS):
        for measured, (_, evaluate) in zip(times, buffers):
            start = time.perf_counter()
            evaluate()
            measured.append((time.perf_counter() - start) / STATES)
    ratios = [min(other) / mine for mine, *other, _ in zip(*times)]
    net = [(min(other) - empty) / (mine - empty) for mine, *other, empty in zip(*times)]
    medians = " ".join(f"{1e6 * statistics.median(each):.2f}" for each in times)
    print(f"  {name}: {statistics.median(ratios):.2f} {statistics.median(net):.2f}   (gelenk, the others, an empty function: {medians})")


def buffered(batch: ca.Function, arguments: list[ca.DM]):
    """An evaluation over memory of ours, without conversions of arguments and results."""
    buffer, evaluate = batch.buffer()
    kept = [np.array(each.full(), order="F") for each in arguments]
    results = [np.zeros(batch.nnz_out(index)) for index in range(batch.n_out())]
    for index, each in enumerate(kept):
        buffer.set_arg(index, memoryview(each.ravel(order="F")))
    for index, each in enumerate(results):
        buffer.set_res(index, memoryview(each))
    return (buffer, kept, results), evaluate


if __name__ == "__main__":
    main()
