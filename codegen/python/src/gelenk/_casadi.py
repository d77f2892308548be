"""Functions of a robot for CasADi."""

from __future__ import annotations

import ctypes
import importlib
import os
from pathlib import Path
from typing import Any, Iterable, Iterator, Mapping

from . import _program
from ._robot import again, compiled, generated, read


class CasadiFunctions:
    """External functions of CasADi with their derivatives, as attributes: `robot.dynamics(x, u)`.

    - `dynamics(x, u)` returns xdot, with the state x = (y, ẏ) and the inputs u
    - `inverse_dynamics(y, v, a)` returns b_u, the forces of the drives at the joints
    - `step(x, u, period)` returns x_next, the state after the period in s
    - `frame_<name>(y)` returns position and rotation

    If joints have quaternions, functions take `d` instead of positions: a small motion from reference positions, y = y_ref ⊕ d,
    with the state x = (d, v). The function `difference(y_ref, y)` of `load` computes d = y ⊖ y_ref. All functions then take
    `y_ref` after the arguments above. `step` also takes `y_ref_next`, the reference of x_next. Quaternions of references are
    normalized.

    If the robot has free parameters, the last argument `p` of each function has all of them, in the order of `parameters`. First
    derivatives with respect to all arguments are analytic. Second derivatives are central differences of the first derivatives.
    """

    def __init__(
        self, library: str, functions: dict[str, Any], parameters: dict[str, float], made_of: tuple[str, list[str], str]
    ):
        self.library = library
        """Path of the shared library, for `casadi.external`."""
        self.parameters = parameters
        """Values of the free parameters in the description, by name."""
        self._functions = functions
        self._made_of = made_of

    def __reduce__(self) -> Any:
        return again, (loaded, *self._made_of)

    def __getattr__(self, name: str) -> Any:
        try:
            return self.__dict__["_functions"][name]
        except KeyError:
            known = ", ".join(self.__dict__.get("_functions", {}))
            raise AttributeError(f"there is no function `{name}` for CasADi; the functions are {known}") from None

    def __iter__(self) -> Iterator[str]:
        return iter(self._functions)

    def __dir__(self) -> list[str]:
        return [*super().__dir__(), *self._functions]


def casadi(
    description: str | os.PathLike[str],
    *,
    functions: Iterable[str] | None = None,
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
) -> CasadiFunctions:
    """Loads a description and returns external functions of CasADi. CasADi must be installed.

    Robots with dry friction need `smooth_sign`, because solvers use derivatives and the derivative of the exact sign is zero. All
    keywords are those of `load`. If you choose `functions`, include the functions that compute the derivatives.
    """
    options = _program.switches({
        "functions": [functions] if isinstance(functions, str) else functions, "snap_angles": snap_angles,
        "no_friction": no_friction, "ignore_mimic": ignore_mimic, "base": base, "smooth_sign": smooth_sign,
        "accept_unphysical": accept_unphysical, "body": body, "hold": hold, "fused_multiply_add": fused_multiply_add,
        "max_operations": max_operations,
    })
    return loaded(str(Path(description).absolute()), options, 4)


def loaded(description: str, options: list[str], depth: int) -> CasadiFunctions:
    """Returns the functions of a description.

    - `options`: options of the command line
    - `depth`: number of calls between `read` and the code of the user, for the place of warnings
    """
    path = Path(description)
    module = generated(path, options, "casadi")
    told, _ = read(module, path, depth)
    library, found = external(module, told)
    parameters = {each["name"]: each["default"] for each in told["interface"]["parameters"]}
    return CasadiFunctions(library, found, parameters, (description, options, module.name))


def external(module: Path, told: Mapping[str, Any]) -> tuple[str, dict[str, Any]]:
    """Returns the path of the compiled library of a module, and its functions for CasADi by name."""
    tool = importlib.import_module("casadi")
    library = str(compiled(module, told["files"]))
    symbols = ctypes.CDLL(library)
    interface = told["interface"]
    poses = [each["name"] for each in interface["functions"] if each["name"].endswith("_pose")]
    names = ["dynamics", "inverse_dynamics", "step", *(pose.removesuffix("_pose") for pose in poses)]
    prefix = f"{interface['prefix']}_casadi_"
    return library, {name: tool.external(prefix + name, library) for name in names if hasattr(symbols, prefix + name)}
