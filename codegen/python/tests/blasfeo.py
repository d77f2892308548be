"""Calls functions of an acados solver as acados does, with parts of BLASFEO vectors and matrices."""

from __future__ import annotations

import ctypes
import os
from pathlib import Path
from typing import Any

import numpy as np


class Vector(ctypes.Structure):
    """BLASFEO's vector."""

    _fields_ = [("memory", ctypes.c_void_p), ("entries", ctypes.POINTER(ctypes.c_double)), ("rest", ctypes.c_int * 16)]


class Matrix(ctypes.Structure):
    """BLASFEO's matrix. Only functions of BLASFEO know its storage order."""

    _fields_ = [("all", ctypes.c_void_p * 16)]


class VectorPart(ctypes.Structure):
    _fields_ = [("vector", ctypes.POINTER(Vector)), ("start", ctypes.c_int)]


class MatrixPart(ctypes.Structure):
    _fields_ = [("matrix", ctypes.POINTER(Matrix)), ("row", ctypes.c_int), ("column", ctypes.c_int)]


def vector(numbers: np.ndarray, start: int) -> VectorPart:
    """A part of a vector, with other numbers around it."""
    padded = np.concatenate([np.full(start, np.nan), numbers, np.full(2, np.nan)])
    made = Vector(None, padded.ctypes.data_as(ctypes.POINTER(ctypes.c_double)))
    made.keep = padded
    return VectorPart(ctypes.pointer(made), start)


def pointers(*parts: Any) -> Any:
    return (ctypes.c_void_p * len(parts))(*[ctypes.addressof(part) for part in parts])


class Externals:
    """Calls the functions of a compiled solver as acados does."""

    def __init__(self, solver: Any):
        self.library = ctypes.CDLL(solver.shared_lib_name)
        self.blasfeo = ctypes.CDLL(str(Path(os.environ["ACADOS_SOURCE_DIR"]) / "lib" / "libblasfeo.so"))

    def call(self, name: str, x: np.ndarray, u: np.ndarray, p: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        nx, nu = x.size, u.size
        state, inputs, after = vector(x, 3), vector(u, 1), vector(np.zeros(nx), 2)
        matrix = Matrix()
        self.blasfeo.blasfeo_allocate_dmat(nu + nx + 5, nx + 3, ctypes.byref(matrix))
        self.blasfeo.blasfeo_dgese.argtypes = [ctypes.c_int, ctypes.c_int, ctypes.c_double, *[ctypes.c_void_p], *[ctypes.c_int] * 2]
        self.blasfeo.blasfeo_dgese(nu + nx + 5, nx + 3, 7.0, ctypes.byref(matrix), 0, 0)
        jacobian = MatrixPart(ctypes.pointer(matrix), 3, 2)
        parameters = p.ctypes.data_as(ctypes.c_void_p)
        assert getattr(self.library, name)(pointers(state, inputs), pointers(after, jacobian), parameters) == 0
        found = np.zeros((nx + 3, nu + nx + 5))
        self.blasfeo.blasfeo_unpack_dmat(
            nu + nx + 5, nx + 3, ctypes.byref(matrix), 0, 0, found.ctypes.data_as(ctypes.c_void_p), nu + nx + 5
        )
        self.blasfeo.blasfeo_free_dmat(ctypes.byref(matrix))
        inner = found[2 : 2 + nx, 3 : 3 + nu + nx].copy()
        found[2 : 2 + nx, 3 : 3 + nu + nx] = 7.0
        assert (found == 7.0).all(), "nothing is written beside the Jacobian"
        around = after.vector.contents
        numbers = np.ctypeslib.as_array(around.entries, (2 + nx + 2,))
        assert np.isnan(numbers[:2]).all() and np.isnan(numbers[-2:]).all()
        return numbers[2 : 2 + nx].copy(), inner
