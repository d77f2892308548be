"""Loops of a compiled module as NumPy's generalized universal functions.

NumPy's C interface is a table of pointers, which compiled extensions read from a capsule. The order of the table never
changes, because extensions depend on it. This module reads `PyUFunc_FromFuncAndDataAndSignature` from the table. A call
therefore costs as much as a call of a NumPy function, and loading a robot needs no headers of Python or NumPy.
"""

from __future__ import annotations

import ctypes
import importlib
from typing import Any

import numpy as np

try:
    _umath = importlib.import_module("numpy._core._multiarray_umath")
except ImportError:  # before NumPy 2
    _umath = importlib.import_module("numpy.core._multiarray_umath")

FROM_FUNCTION_WITH_SIGNATURE = 31
"""Index of `PyUFunc_FromFuncAndDataAndSignature` in the table `_UFUNC_API`, from `numpy/__ufunc_api.h`."""

NO_IDENTITY = -1

_kept: list[Any] = []
"""Objects to which NumPy keeps pointers without a reference. They must live as long as the process, because a ufunc may."""


def _maker() -> Any:
    api = ctypes.pythonapi
    api.PyCapsule_GetName.restype = ctypes.c_char_p
    api.PyCapsule_GetName.argtypes = [ctypes.py_object]
    api.PyCapsule_GetPointer.restype = ctypes.c_void_p
    api.PyCapsule_GetPointer.argtypes = [ctypes.py_object, ctypes.c_char_p]
    capsule = _umath._UFUNC_API
    table = api.PyCapsule_GetPointer(capsule, api.PyCapsule_GetName(capsule))
    pointer = ctypes.cast(table, ctypes.POINTER(ctypes.c_void_p))[FROM_FUNCTION_WITH_SIGNATURE]
    integer, text, address = ctypes.c_int, ctypes.c_char_p, ctypes.c_void_p
    arguments = [address, address, text, integer, integer, integer, integer, text, text, integer, text]
    return ctypes.PYFUNCTYPE(ctypes.py_object, *arguments)(pointer)


_make = _maker()


def gufunc(
    library: ctypes.CDLL,
    symbol: str,
    name: str,
    inputs: list[tuple[int, ...]],
    results: list[tuple[int, ...]],
    dtype: np.dtype[Any],
) -> np.ufunc:
    """Returns a loop of the library as a function of arrays.

    - `symbol`: name of the loop in the library
    - `inputs`, `results`: shapes for one state, all with entries
    """
    def shapes(all: list[tuple[int, ...]]) -> str:
        return ",".join("(" + ",".join(map(str, shape)) + ")" for shape in all)

    signature = f"{shapes(inputs)}->{shapes(results)}"
    loop = ctypes.cast(getattr(library, symbol), ctypes.c_void_p).value
    loops, data = (ctypes.c_void_p * 1)(loop), (ctypes.c_void_p * 1)(None)
    types = bytes([dtype.num] * (len(inputs) + len(results)))
    texts = name.encode(), b"", signature.encode()
    _kept.append((library, loops, data, types, texts))
    made = _make(
        ctypes.addressof(loops), ctypes.addressof(data), types, 1, len(inputs), len(results), NO_IDENTITY,
        texts[0], texts[1], 0, texts[2],
    )
    if not isinstance(made, np.ufunc) or made.signature != signature:
        raise RuntimeError(f"NumPy {np.__version__} made {made!r} instead of {name} with {signature}")
    return made
