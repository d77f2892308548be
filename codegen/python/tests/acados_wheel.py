"""Finds acados, also where it comes from the wheel of a third party (`comma-deps-acados`), which holds it and its template in one
package."""

from __future__ import annotations

import importlib.util


def find() -> bool:
    """Whether there is an acados, for which the generated files look by themselves."""
    return any(importlib.util.find_spec(name) is not None for name in ("acados_template", "acados"))
