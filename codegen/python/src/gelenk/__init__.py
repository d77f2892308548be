"""Robot dynamics from a description, over NumPy arrays.

    import gelenk
    import numpy as np

    robot = gelenk.load("ur5.toml")
    y = np.zeros((1000, robot.N))
    torques = robot.inverse_dynamics(y, 0 * y, 0 * y)

`load` generates C with the program `gelenk`, compiles it with a C compiler of the system, and caches module and library.
`generate`, `report`, `identify`, `online`, `plan`, `reduce` and `merge` run the commands of the program.
"""

from ._acados import acados
from ._casadi import CasadiFunctions, casadi
from ._commands import Identified, generate, identify, merge, online, plan, reduce, report
from ._gauss_newton import Motion, Shooting, gauss_newton
from ._robot import Robot, load
from .errors import (
    CacheError,
    CompilerError,
    DescriptionError,
    DescriptionWarning,
    Diagnostic,
    GelenkError,
    ProgramError,
)

__all__ = [
    "CacheError",
    "CasadiFunctions",
    "CompilerError",
    "DescriptionError",
    "DescriptionWarning",
    "Diagnostic",
    "GelenkError",
    "Identified",
    "Motion",
    "ProgramError",
    "Robot",
    "Shooting",
    "acados",
    "casadi",
    "gauss_newton",
    "generate",
    "identify",
    "load",
    "merge",
    "online",
    "plan",
    "reduce",
    "report",
]
