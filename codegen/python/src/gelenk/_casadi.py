"""A robot's functions for CasADi."""

from __future__ import annotations

import ctypes
import importlib
import os
from pathlib import Path
from typing import Any, Iterable, Iterator, Mapping

from . import _program
from ._robot import again, compiled, generated, read


class CasadiFunctions:
    """External functions of CasADi, with their derivatives, as attributes: `robot.dynamics(x, u)`.

    - `dynamics`: x = (y, ẏ), u gives xdot
    - `inverse_dynamics`: y, v, a gives b_u, the forces of the drives at the joints
    - `step`: x, u, period gives x_next
    - `frame_<name>`: y gives position, rotation

    Where joints have quaternions, positions are given as `d`, a small motion from reference positions: y = y_ref ⊕ d, x = (d, v),
    and d = y ⊖ y_ref is the function `difference(y_ref, y)` of `load`. All functions then take `y_ref` behind the inputs above, and
    `step` also `y_ref_next`, which the state after it is about. Quaternions of a reference are made unit ones.

    Each takes `p` last where the robot has free parameters: all of them, in the order of `parameters`. First derivatives by all
    inputs are analytic, second ones are central differences of these.
    """

    def __init__(
        self, library: str, functions: dict[str, Any], parameters: dict[str, float], made_of: tuple[str, list[str], str]
    ):
        self.library = library
        """The path of the shared library, as `casadi.external` takes it."""
        self.parameters = parameters
        """The free parameters by name, with their described values."""
        self._functions = functions
        self._made_of = made_of

    def __reduce__(self) -> Any:
        return again, (loaded, *self._made_of)

    def __getattr__(self, name: str) -> Any:
        try:
            return self.__dict__["_functions"][name]
        except KeyError:
            known = ", ".join(self.__dict__.get("_functions", {}))
            raise AttributeError(f"there is no function `{name}` for CasADi; there are {known}") from None

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
    """The robot of a description as external functions of CasADi, which has to be installed.

    Dry friction needs `smooth_sign`: solvers follow derivatives, and that of the exact sign is zero. All arguments are those of
    `load`. The functions of a module that derivatives need have to be among `functions` where these are named.
    """
    options = _program.switches({
        "functions": [functions] if isinstance(functions, str) else functions, "snap_angles": snap_angles,
        "no_friction": no_friction, "ignore_mimic": ignore_mimic, "base": base, "smooth_sign": smooth_sign,
        "accept_unphysical": accept_unphysical, "body": body, "hold": hold, "fused_multiply_add": fused_multiply_add,
        "max_operations": max_operations,
    })
    return loaded(str(Path(description).absolute()), options, 4)


def loaded(description: str, options: list[str], depth: int) -> CasadiFunctions:
    """The functions of a description by words of the command line.

    - `depth`: how many calls above `read` the user stands
    """
    path = Path(description)
    module = generated(path, options, "casadi")
    told, _ = read(module, path, depth)
    library, found = external(module, told)
    parameters = {each["name"]: each["default"] for each in told["interface"]["parameters"]}
    return CasadiFunctions(library, found, parameters, (description, options, module.name))


def external(module: Path, told: Mapping[str, Any]) -> tuple[str, dict[str, Any]]:
    """The compiled library of a module, and CasADi's functions in it by name."""
    tool = importlib.import_module("casadi")
    library = str(compiled(module, told["files"]))
    symbols = ctypes.CDLL(library)
    interface = told["interface"]
    poses = [each["name"] for each in interface["functions"] if each["name"].endswith("_pose")]
    names = ["dynamics", "inverse_dynamics", "step", *(pose.removesuffix("_pose") for pose in poses)]
    prefix = f"{interface['prefix']}_casadi_"
    return library, {name: tool.external(prefix + name, library) for name in names if hasattr(symbols, prefix + name)}
