"""Python functions for the compiled loops of a module: signatures, documentation, and errors with the expected shapes."""

from __future__ import annotations

import keyword
from collections import namedtuple
from typing import Any, Callable, Mapping, Sequence

import numpy as np

PARAMETERS = "parameters"
"""Keyword for the array of all free parameters."""

OUT = "out"
"""Keyword for arrays to which results are written."""


def identifier(name: str, taken: Sequence[str] = ()) -> str:
    """Returns the Python name for a name in C. Keywords and taken names get a final underscore."""
    if not name.isidentifier():
        raise ValueError(f"the module has a function or argument of the name {name!r}")
    while keyword.iskeyword(name) or name in taken or name.startswith("_"):
        name = name.lstrip("_") + "_"
    return name


class Function:
    """One function of a module: its interface, and the Python function that calls it."""

    def __init__(self, told: Mapping[str, Any], parameters: "Parameters", dtype: np.dtype[Any]):
        self.name = identifier(told["name"])
        self.told = told
        self.parameters = parameters
        self.dtype = dtype
        self.arguments = [identifier(each["name"], [OUT]) for each in told["arguments"]]
        self.shapes = [tuple(each["shape"]) for each in told["arguments"]]
        self.results = [identifier(each["name"]) for each in told["results"]]
        self.result_shapes = [tuple(each["shape"]) for each in told["results"]]

    @property
    def result_name(self) -> str:
        """Name of the named tuple of several results."""
        return "".join(word.capitalize() for word in self.name.split("_"))

    def operands(self) -> tuple[list[tuple[int, ...]], list[tuple[int, ...]]]:
        """Returns the shapes of all inputs and all results that have entries."""
        inputs = self.shapes + ([(len(self.parameters.fields),)] if self.parameters.fields else [])
        has_entries = lambda shape: 0 not in shape  # noqa: E731
        return list(filter(has_entries, inputs)), list(filter(has_entries, self.result_shapes))

    def signature(self) -> str:
        """Returns the text of the parameter list for a `def` statement."""
        words = ["_self", "/", *self.arguments, "*", f"{OUT}=None"]
        if self.parameters.fields:
            words += [f"{PARAMETERS}=None", *(f"{field}=None" for field in self.parameters.fields)]
        return ", ".join(words)

    def define(self, call: Callable[..., Any] | None) -> Callable[..., Any]:
        """Defines the method of the robot.

        - `call`: loop of the library as a NumPy function; `None` if no result has entries
        """
        has_empty = any(0 in shape for shape in self.shapes + self.result_shapes)
        used = with_empty(self, call) if has_empty else call
        names: dict[str, Any] = {
            "_call": used,
            "_into": lambda out, values: into(self, used, out, values),
            "_new": tuple.__new__,
            "_explain": lambda error, values: explain(self, error, values),
            "_defaults": self.parameters.defaults,
            "_pack": self.parameters.pack,
        }
        passed = list(self.arguments)
        lines = [f"def {self.name}({self.signature()}):"]
        if self.parameters.fields:
            fields = self.parameters.fields
            are_none = " and ".join(f"{field} is None" for field in fields)
            given = ", ".join(f"{field}={field}" for field in fields)
            lines += [
                f"    if {are_none}:",
                f"        _p = _defaults if {PARAMETERS} is None else {PARAMETERS}",
                "    else:",
                f"        _p = _pack({PARAMETERS}, {given})",
            ]
            passed.append("_p")
        values = "".join(f"{name}, " for name in passed)
        new = "{}"
        if len(self.results) > 1:
            names["_Result"] = self.result_type()
            new = "_new(_Result, {})"
        call_text, into_text = f"_call({', '.join(passed)})", f"_into({OUT}, ({values}))"
        lines += [
            "    try:",
            f"        if {OUT} is not None:",
            f"            return {new.format(into_text)}",
            f"        return {new.format(call_text)}",
            "    except (TypeError, ValueError) as _error:",
            f"        _reason = _explain(_error, ({values}))",
            "    raise _reason",
        ]
        exec("\n".join(lines), names)  # noqa: S102  names are identifiers
        function: Callable[..., Any] = names[self.name]
        function.__doc__ = self.documentation()
        return function

    def result_type(self) -> type:
        """Returns the named tuple type of several results."""
        made = namedtuple(self.result_name, self.results)  # type: ignore[misc]
        made.__doc__ = f"Results of `{self.name}`: {self.told['summary']}"
        for name, told in zip(self.results, self.told["results"]):
            getattr(made, name).__doc__ = f"{told['symbol']}: {told['meaning']}"
        return made

    def documentation(self) -> str:
        told = self.told
        lines = [told["summary"], ""]
        if told["equation"]:
            lines += [f"    {told['equation']}", ""]
        lines += ["Arguments", "---------"]
        for name, each in zip(self.arguments, told["arguments"]):
            lines += [f"{name} : {shape_text(each['shape'])}", f"    {meaning(each)}"]
        if self.parameters.fields:
            for name, each in zip(self.parameters.fields, self.parameters.told):
                unit = f" ({each['unit']})" if each["unit"] else ""
                about = each["description"].strip() or f"parameter {each['name']}"
                lines += [f"{name} : (...)", f"    {about}{unit}; described as {each['default']!r}"]
            lines += [f"{PARAMETERS} : (..., {len(self.parameters.fields)})"]
            lines += ["    array of all free parameters, from `pack_parameters`"]
        lines += [f"{OUT} : " + ("tuple of arrays" if len(self.results) > 1 else "array")]
        lines += [f"    arrays of {self.dtype} to which the results are written; they are also returned"]
        lines += ["", "Returns", "-------"]
        for name, each in zip(self.results, told["results"]):
            symbol = each["symbol"] if each["symbol"] == name else f"{name}, {each['symbol']}"
            lines += [f"{symbol} : {shape_text(each['shape'])}", f"    {each['meaning']}"]
        lines += ["", "Leading axes count states; the leading axes of all arguments are broadcast.", told["cost"]]
        for note in told["notes"]:
            lines += ["", note]
        return "\n".join(lines) + "\n"


class Parameters:
    """Free parameters of a module, which are keywords of its functions."""

    def __init__(self, told: Sequence[Mapping[str, Any]], taken: Sequence[str], dtype: np.dtype[Any]):
        self.told = told
        self.fields: list[str] = []
        for each in told:
            self.fields.append(identifier(each["field"], [*taken, PARAMETERS, OUT, *self.fields]))
        self.defaults = np.array([each["default"] for each in told], dtype)
        self.defaults.flags.writeable = False

    def pack(self, parameters: Any = None, **values: Any) -> np.ndarray:
        """Packs all parameters into one array. Parameters without a value keep the value in `parameters`, or in the description."""
        base = self.defaults if parameters is None else np.asarray(parameters)
        if base.ndim == 0 or base.shape[-1] != len(self.fields):
            raise ValueError(
                f"`{PARAMETERS}` has the shape {base.shape}, expected (..., {len(self.fields)}): "
                + ", ".join(self.fields)
            )
        given = {name: np.asarray(value) for name, value in values.items() if value is not None}
        for name, value in given.items():
            check_dtype(f"parameter `{name}`", value, self.defaults.dtype)
        check_dtype(f"`{PARAMETERS}`", base, self.defaults.dtype)
        try:
            batch = np.broadcast_shapes(base.shape[:-1], *(value.shape for value in given.values()))
        except ValueError:
            shapes = ", ".join(f"`{name}` {value.shape}" for name, value in given.items())
            raise ValueError(f"the shapes of the parameters do not broadcast: {shapes}") from None
        packed = np.array(np.broadcast_to(base, (*batch, len(self.fields))), self.defaults.dtype)
        for name, value in given.items():
            packed[..., self.fields.index(name)] = value
        return packed


def shape_text(shape: Sequence[int]) -> str:
    return "(..., " + ", ".join(map(str, shape)) + ")" if shape else "(...)"


def meaning(told: Mapping[str, Any]) -> str:
    """Returns the meaning of an argument with the units of its entries."""
    parts: list[str] = []
    for index, entry in enumerate(told["entries"]):
        following = told["entries"][index + 1 : index + 2]
        is_last = not following or following[0]["unit"] != entry["unit"]
        parts.append(f"{entry['name']} in {entry['unit']}" if is_last else entry["name"])
    entries = ", ".join(parts)
    return f"{told['meaning']}: {entries}" if entries else told["meaning"]


def check_dtype(what: str, value: np.ndarray, dtype: np.dtype[Any]) -> None:
    """Raises `TypeError` if the conversion to the type of the module could change a number."""
    if not np.can_cast(value.dtype, dtype, "safe"):
        hint = ""
        if value.dtype.kind in "fiu":
            hint = f"; round them yourself with numpy.asarray(…, numpy.{dtype}) if this is intended"
        raise TypeError(f"{what} holds {value.dtype}, which {dtype} does not hold exactly{hint}")


def explain(function: Function, error: Exception, values: Sequence[Any]) -> Exception:
    """Returns an error that names the argument, its expected shape and its meaning, for a call that NumPy rejected."""
    batches: list[tuple[str, tuple[int, ...]]] = []
    names, shapes = list(function.arguments), list(function.shapes)
    told = list(function.told["arguments"])
    if function.parameters.fields:
        names.append(PARAMETERS)
        shapes.append((len(function.parameters.fields),))
        told.append({"meaning": ", ".join(function.parameters.fields), "entries": []})
    for name, shape, about, value in zip(names, shapes, told, values):
        try:
            array = np.asarray(value)
        except (TypeError, ValueError) as reason:
            return TypeError(f"{function.name}: `{name}` is not an array of numbers: {reason}")
        try:
            check_dtype(f"{function.name}: `{name}`", array, function.dtype)
        except TypeError as reason:
            return reason
        rank = len(shape)
        if array.ndim < rank or array.shape[array.ndim - rank :] != shape:
            expected = f"expected {shape_text(shape)}: {meaning(about)}"
            return ValueError(f"{function.name}: `{name}` has the shape {array.shape}, {expected}")
        batches.append((name, array.shape[: array.ndim - rank]))
    try:
        np.broadcast_shapes(*(batch for _, batch in batches))
    except ValueError:
        axes = ", ".join(f"{batch} of `{name}`" for name, batch in batches)
        return ValueError(f"{function.name}: the leading axes do not broadcast: {axes}")
    return error


def into(function: Function, call: Callable[..., Any] | None, out: Any, values: Sequence[Any]) -> Any:
    """Calls a function, writes its results to the arrays `out`, and returns these arrays."""
    count = len(function.results)
    arrays = out if count > 1 else (out,)
    expected = f"{count} arrays" if count > 1 else "one array"
    if not isinstance(arrays, tuple) or len(arrays) != count or not all(type(each) is np.ndarray for each in arrays):
        raise TypeError(f"{function.name}: `{OUT}` must be {expected} of NumPy: " + ", ".join(function.results))
    for name, array in zip(function.results, arrays):
        if array.dtype != function.dtype:
            raise TypeError(f"{function.name}: `{OUT}` for `{name}` holds {array.dtype}, expected {function.dtype}")
    if not isinstance(call, np.ufunc):
        # NumPy has no loops for results without entries.
        found = call(*values) if call is not None else ()
        for array, result in zip(arrays, found if count > 1 else (found,)):
            if array.shape != result.shape:
                raise ValueError(f"{function.name}: `{OUT}` has the shape {array.shape}, expected {result.shape}")
            array[...] = result
        return out
    return call(*values, out=arrays)


def with_empty(function: Function, call: Callable[..., Any] | None) -> Callable[..., Any]:
    """Returns a call for arguments or results without entries, which the loops of NumPy do not support."""
    has_entries = [0 not in shape for shape in function.shapes]
    has_entries += [True] * bool(function.parameters.fields)
    shapes = function.shapes + [(len(function.parameters.fields),)] * bool(function.parameters.fields)

    def run(*values: Any) -> Any:
        arrays = [np.asarray(value) for value in values]
        for array, shape in zip(arrays, shapes):
            if array.ndim < len(shape) or array.shape[array.ndim - len(shape) :] != shape:
                raise ValueError("an argument has a wrong shape")
        batch = np.broadcast_shapes(*(a.shape[: a.ndim - len(s)] for a, s in zip(arrays, shapes)))
        passed = [
            np.broadcast_to(array, batch + shape)
            for array, shape, is_passed in zip(arrays, shapes, has_entries) if is_passed
        ]
        made: Any = ()
        if call is not None:
            made = call(*passed)
            made = made if isinstance(made, tuple) else (made,)
            # Without passed arguments the results do not have the batch axes yet.
            made = tuple(np.broadcast_to(each, batch + np.shape(each)) if not passed else each for each in made)
        full = iter(made)
        results = tuple(
            np.zeros(batch + shape, function.dtype) if 0 in shape else next(full) for shape in function.result_shapes
        )
        return results if len(results) > 1 else results[0]

    return run
