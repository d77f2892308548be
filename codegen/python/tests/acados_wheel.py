"""Finds acados, also in the wheel of a third party (`comma-deps-acados`), which contains acados and its template in one package."""

from __future__ import annotations

import importlib.util


def find() -> bool:
    """Returns whether acados is installed. The generated files find it without help."""
    return any(importlib.util.find_spec(name) is not None for name in ("acados_template", "acados"))
