"""Optimal control problem of a robot for acados."""

from __future__ import annotations

import os
from pathlib import Path
from types import ModuleType
from typing import Any, Iterable, Mapping

from . import _program
from ._casadi import external
from ._robot import generated, read

FUNCTIONS = ("step", "step_derivatives", "input_matrix", "frames")
"""Functions that acados and the generated Python file need, and poses of frames for costs and constraints."""


def acados(
    description: str | os.PathLike[str],
    *,
    functions: Iterable[str] = FUNCTIONS,
    snap_angles: float | None = None,
    no_friction: bool = False,
    ignore_mimic: bool = False,
    base: str | None = None,
    smooth_sign: float | None = None,
    accept_unphysical: bool = False,
    body: str | None = None,
    hold: Mapping[str, float] | Iterable[str] = (),
    fused_multiply_add: bool = False,
    max_operations: int | None = None,
) -> ModuleType:
    """Loads a description and returns a Python module for acados. `acados_template` must be installed.

    - `ocp(intervals, period)`: returns a problem with the discrete dynamics and the limits of the robot
    - `track(ocp, state_weight, input_weight, terminal_weight)`: sets the cost of following references
    - `soften(ocp, linear, quadratic)`: makes the bounds of the states soft
    - `solver(ocp)`: returns the compiled solver
    - `parameters(period, values)`: returns the parameters of a stage
    - `model()`: returns the model; the limits of the description are constants
    - `frame_<name>(y)` and the other functions of `gelenk.casadi`, if `functions` contains them, for costs and constraints

    The module is the file `NAME_acados.py` that `gelenk generate --language c --for acados` writes. acados compiles in the folder
    `ocp.code_export_directory`, by default `c_generated_code` in the current folder. Robots with dry friction need `smooth_sign`,
    because solvers use derivatives and the derivative of the exact sign is zero. All keywords are those of `load`.
    """
    options = _program.switches({
        "functions": [functions] if isinstance(functions, str) else list(functions), "snap_angles": snap_angles,
        "no_friction": no_friction, "ignore_mimic": ignore_mimic, "base": base, "smooth_sign": smooth_sign,
        "accept_unphysical": accept_unphysical, "body": body, "hold": hold, "fused_multiply_add": fused_multiply_add,
        "max_operations": max_operations,
    })
    path = Path(description).absolute()
    folder = generated(path, options, "acados,casadi")
    told, _ = read(folder, path)
    [file] = [name for name in told["files"] if name.endswith(".py")]
    module = ModuleType(Path(file).stem)
    module.__file__ = str(folder / file)
    # An import would write a file into the cache, whose entries are never changed.
    text = (folder / file).read_text("utf-8")
    exec(compile(text, module.__file__, "exec"), module.__dict__)
    sources = [name for name in told["files"] if not name.endswith("_acados.c")]

    def further(name: str) -> Any:
        # The functions are compiled at the first request. The source of the solver contains them too, so it is left out.
        functions = {} if name.startswith("_") else external(folder, {**told, "files": sources})[1]
        if name not in functions:
            raise AttributeError(f"module {module.__name__!r} has no attribute {name!r}")
        return functions[name]

    module.__dict__["__getattr__"] = further
    return module
