"""Finds acados, also where it comes from the wheel of a third party (`comma-deps-acados`), which holds it and its template in one
package."""

from __future__ import annotations

import ctypes
import importlib.util
import os
import sys
from pathlib import Path

LIBRARIES = ["libblasfeo.so", "libhpipm.so", "libqpOASES_e.so.3.1"]
"""What `libacados.so` needs, and does not find by itself in that wheel."""


def find() -> bool:
    """Makes `acados_template` importable; whether it is."""
    wheel = importlib.util.find_spec("acados")
    if importlib.util.find_spec("acados_template") is None and wheel is not None and wheel.origin is not None:
        folder = Path(wheel.origin).parent
        sys.path.append(str(folder))
        os.environ.setdefault("ACADOS_SOURCE_DIR", str(folder / "install"))
        os.environ.setdefault("ACADOS_PYTHON_INTERFACE_PATH", str(folder / "acados_template"))
        for name in LIBRARIES:
            ctypes.CDLL(str(folder / "install" / "lib" / name), ctypes.RTLD_GLOBAL)
    return importlib.util.find_spec("acados_template") is not None
