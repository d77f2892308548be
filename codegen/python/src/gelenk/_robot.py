"""From a description to an object with its functions."""

from __future__ import annotations

import ctypes
import json
import os
import re
import shutil
import sys
import tempfile
import time
import warnings
from pathlib import Path
from typing import Any, Callable, Iterable, Mapping

import numpy as np

from . import _cache, _compiler, _program
from ._functions import Function, Parameters, identifier
from ._numpy import gufunc
from .errors import DescriptionWarning, Diagnostic, GelenkError

FORMAT = 2
"""Changes with what entries of the cache hold."""

CLOCK = 0.05
"""Seconds by which the times of files may be late: systems take them from a coarse clock."""


class Robot:
    """A robot's functions over NumPy arrays, as `gelenk.load` makes them.

    Functions and constants are those of the generated module: `robot.inverse_dynamics(y, v, a)`, `robot.N`,
    `robot.JOINT_NAMES`. `help(robot.inverse_dynamics)` says what a function takes and returns. Axes in front count states,
    and the loop over them is compiled.
    """

    name: str
    """Name of the robot."""
    description: tuple[str, ...]
    """What its description says about it."""
    dtype: np.dtype[Any]
    """Type of all numbers."""
    notes: tuple[Diagnostic, ...]
    """What the program noted about the description."""
    default_parameters: dict[str, float]
    """The described values of the free parameters."""
    folder: Path
    """Where the module in C and its library lie."""
    N: int
    """Number of coordinates."""
    M: int
    """Number of inputs."""

    def pack_parameters(self, **values: Any) -> np.ndarray:
        """All free parameters in one array, for the keyword `parameters` of every function.

        Those without a value are as described. Calls in a loop are faster with it than with single keywords.
        """
        unknown = [name for name in values if name not in self._parameters.fields]
        if unknown:
            known = ", ".join(self._parameters.fields) or "none"
            raise TypeError(f"{self.name} has no parameter `{unknown[0]}`; it has {known}")
        return self._parameters.pack(None, **values)

    def stub(self) -> str:
        """The text of a type stub: a class with the functions and constants of this robot.

        Written to `ur5.pyi`, and imported where `TYPE_CHECKING`, it tells editors and type checkers what
        `robot: "Ur5" = gelenk.load("ur5.toml")` has.
        """
        return stub(self)

    def __reduce__(self) -> Any:
        return again, (loaded, *self._made_of)

    def __repr__(self) -> str:
        return f"<gelenk robot {self.name}: {self.N} coordinates, {self.M} inputs, {len(self._functions)} functions>"

    _parameters: Parameters
    _functions: list[Function]
    _made_of: tuple[str, list[str], str]


def load(
    description: str | os.PathLike[str],
    *,
    functions: Iterable[str] | None = None,
    lanes: Iterable[str] | None = None,
    scalar: str = "f64",
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
) -> Any:
    """The robot of a description, TOML, URDF or MJCF, as an object with its functions.

    The program generates C, and the compiler at hand compiles it: `CC` where that is set, else cc, gcc, clang or
    zig cc. Both are kept in a cache by their content, so that the next call only reads the description.

    - `functions`: their names; by default those of the description, else all
    - `lanes`: functions that compute eight states of a batch at once even where that makes them large; those that are
      straight-line code do so in any case
    - `scalar`: `f64`, or `f32` for functions in single precision
    - `base`: `"floating"` for a robot whose first link moves freely
    - all others: as `gelenk generate --help` says

    Raises `DescriptionError`, `CompilerError`, `ProgramError`, and `ValueError` for an option that the program refuses.
    """
    options = _program.switches({
        "functions": [functions] if isinstance(functions, str) else functions,
        "lanes": [lanes] if isinstance(lanes, str) else lanes,
        "scalar": scalar,
        "snap_angles": snap_angles,
        "no_friction": no_friction,
        "ignore_mimic": ignore_mimic,
        "base": base,
        "smooth_sign": smooth_sign,
        "accept_unphysical": accept_unphysical,
        "body": body,
        "hold": hold,
        "fused_multiply_add": fused_multiply_add,
        "max_operations": max_operations,
    })
    return loaded(str(Path(description).absolute()), options, 4)


def loaded(description: str, options: list[str], depth: int) -> Any:
    """The robot of a description by words of the command line.

    - `depth`: how many calls above `read` the user stands
    """
    path = Path(description)
    module = generated(path, options, "python")
    told, notes = read(module, path, depth)
    library = compiled(module, told["files"])
    made = robot(told, notes, library, np.dtype(np.float32 if "--scalar=f32" in options else np.float64))
    made._made_of = description, options, module.name
    return made


def again(make: Callable[[str, list[str], int], Any], description: str, options: list[str], module: str) -> Any:
    """What was pickled, in this process.

    Raises `GelenkError` where the description is another one than at that time.
    """
    made = make(description, options, 5)
    if made._made_of[2] != module:
        raise GelenkError(f"{description} or the program `gelenk` has changed since this robot was pickled: load it and pickle it again")
    return made


def read(module: Path, description: Path, depth: int = 3) -> tuple[dict[str, Any], tuple[Diagnostic, ...]]:
    """What the program said about a module, and its notes. Warnings become those of Python, in the name of whoever loads the robot."""
    told = json.loads((module / "module.json").read_text("utf-8"))
    folder = description.parent
    notes = _program.diagnostics(_at(note, lambda file: os.path.join(folder, file)) for note in told["notes"])
    for note in notes:
        if note.severity == "warning":
            warnings.warn(str(note), DescriptionWarning, stacklevel=depth)
    return told, notes


def _at(note: dict[str, Any], place: Callable[[str], str]) -> dict[str, Any]:
    """A note on the file at another place."""
    if note["file"] is None:
        return note
    file = place(note["file"])
    return {**note, "file": file, "text": note["text"].replace(f"--> {note['file']}:", f"--> {file}:", 1)}


def generated(description: Path, options: list[str], tool: str) -> Path:
    """The folder with the module in C and what the program said about it.

    - `tool`: for whom there are files beside the module: `python`, `casadi` or `acados`

    The cache remembers which files the program read for a description and a choice of options, and the module for
    their contents. Where they lie does not matter, except to each other.
    """
    program = _program.find()
    content = _cache.fingerprint(description)
    asked = _cache.key(FORMAT, description.name, content, options, tool, _program.identity(program))
    known = _cache.read_json("asked", _asked(asked, description, _cache.read_json("read", asked) or []))
    place = known and _cache.find("modules", known)
    return place or _generate(description, options, tool, asked)


def _asked(asked: str, description: Path, read: list[str]) -> str:
    return _cache.key(asked, [(file, _cache.fingerprint(description.parent / file)) for file in read])


def _generate(description: Path, options: list[str], tool: str, asked: str) -> Path:
    scratch = Path(tempfile.mkdtemp(prefix=".new-", dir=_cache.kind_folder("modules")))
    try:
        start = time.time()
        words = ["generate", str(description), "--language=c", f"--for={tool}", f"--output={scratch}{os.sep}", *options]
        # A module says how it was made, from where the program runs.
        [told] = _program.run(words, folder=scratch)
        told["files"] = [Path(file).name for file in told["files"]]
        told["notes"] = [_at(note, lambda file: os.path.relpath(file, description.parent)) for note in told["notes"]]
        texts = {name: (scratch / name).read_text("utf-8") for name in told["files"]}
        kept = {key: told[key] for key in ("robot", "files", "notes", "interface")}

        def fill(place: Path) -> None:
            for file in told["files"]:
                shutil.copy(scratch / file, place / file)
            (place / "module.json").write_text(json.dumps(kept), "utf-8")

        name = _cache.key(FORMAT, kept, texts)
        place = _cache.entry("modules", name, fill)
        # A file that was written while the program read may have another content than it read: the next call asks again.
        if all(Path(file).stat().st_mtime < start - CLOCK for file in told["read"]):
            read = [os.path.relpath(file, description.parent) for file in told["read"]]
            _cache.write_json("read", asked, read)
            _cache.write_json("asked", _asked(asked, description, read), name)
        return place
    finally:
        shutil.rmtree(scratch, ignore_errors=True)


def compiled(module: Path, files: Iterable[str]) -> Path:
    """The shared library of a module with these files."""
    sources = [name for name in files if name.endswith(".c")]

    def fill(place: Path) -> None:
        for file in module.iterdir():
            shutil.copy(file, place / file.name)
        print(f"gelenk: compiling {', '.join(sources)}, once: the library is kept in {_cache.folder()}", file=sys.stderr)
        _compiler.compile(place, sources)

    name = _cache.key(FORMAT, module.name, sources, _compiler.identity())
    return _cache.entry("libraries", name, fill) / _compiler.LIBRARY


def robot(told: Mapping[str, Any], notes: tuple[Diagnostic, ...], path: Path, dtype: np.dtype[Any]) -> Robot:
    """The object over a compiled module."""
    interface = told["interface"]
    library = ctypes.CDLL(str(path))
    arguments = {each["name"] for function in interface["functions"] for each in function["arguments"]}
    parameters = Parameters(interface["parameters"], sorted(arguments), dtype)
    # Functions of positions alone take no parameters.
    none = Parameters([], [], dtype)
    functions = [Function(each, parameters if each["takes_parameters"] else none, dtype) for each in interface["functions"]]
    names: dict[str, Any] = {each["name"]: constant(each, dtype) for each in interface["constants"]}
    names |= {
        "__doc__": "\n\n".join([f"The robot {told['robot']}.", *interface["description"]]),
        "N": interface["coordinates"],
        "M": interface["inputs"],
        "name": told["robot"],
        "description": tuple(interface["description"]),
        "dtype": dtype,
        "notes": notes,
        "folder": path.parent,
        "default_parameters": dict(zip(parameters.fields, parameters.defaults.tolist())),
        "_parameters": parameters,
        "_functions": functions,
    }
    for function in functions:
        if hasattr(Robot, function.name) or function.name in names:
            raise ValueError(f"the module has a function `{function.name}`, which is the name of something else")
        inputs, results = function.operands()
        symbol = f"{interface['prefix']}_python_{function.told['name']}"
        call = gufunc(library, symbol, function.name, inputs, results, dtype) if results else None
        names[function.name] = function.define(call)
    made: Robot = type(class_name(told["robot"]), (Robot,), names)()
    return made


def constant(told: Mapping[str, Any], dtype: np.dtype[Any]) -> Any:
    """A constant of the module: numbers as arrays that cannot be written, names as tuples."""
    kind, value = told["kind"], told["value"]
    if kind == "count":
        return value
    if kind == "names":
        return tuple(value)
    if kind == "sparse":
        return tuple((row, column, dtype.type(float(number))) for row, column, number in value)
    types = {"indices": np.dtype(int), "numbers": dtype, "pattern": np.dtype(bool)}
    # Infinity is a text in JSON, which float understands.
    array = np.array(value, np.float64 if kind == "numbers" else types[kind]).astype(types[kind])
    array.flags.writeable = False
    return array


def class_name(name: str) -> str:
    """The name of a robot as that of a class."""
    words = [word for word in re.split(r"[^0-9A-Za-z]+", name) if word]
    joined = "".join(word[0].upper() + word[1:] for word in words)
    return identifier(joined if joined[:1].isalpha() else f"Robot{joined}")


def stub(robot: Robot) -> str:
    """The text of a type stub."""
    cls = type(robot)
    lines = [
        "from typing import NamedTuple", "", "import numpy as np", "from numpy.typing import ArrayLike, NDArray", "",
        "import gelenk", "",
    ]
    array = f"NDArray[np.{robot.dtype}]"
    for function in robot._functions:
        if len(function.results) > 1:
            lines += ["", f"class {function.result_name}(NamedTuple):"]
            for name, each in zip(function.results, function.told["results"]):
                lines += [f"    {name}: {array}", f"    {_quoted(each['meaning'])}"]
    lines += ["", "", f"class {cls.__name__}(gelenk.Robot):"]
    for name, value in vars(cls).items():
        if name.isupper():
            lines.append(f"    {name}: {_type_name(value)}")
    for function in robot._functions:
        result = function.result_name if len(function.results) > 1 else array
        arrays = f"tuple[{', '.join([array] * len(function.results))}]" if len(function.results) > 1 else array
        words = ["self", *(f"{name}: ArrayLike" for name in function.arguments), "*", f"out: {arrays} | None = None"]
        if function.parameters.fields:
            words += [f"{name}: ArrayLike | None = None" for name in ["parameters", *function.parameters.fields]]
        lines += ["", f"    def {function.name}({', '.join(words)}) -> {result}:"]
        lines += [f"        {_quoted(function.documentation())}", "        ..."]
    return "\n".join(lines) + "\n"


def _quoted(text: str) -> str:
    return json.dumps(text, ensure_ascii=False)


def _type_name(value: Any) -> str:
    if isinstance(value, np.ndarray):
        return f"NDArray[np.{'bool' if value.dtype == bool else value.dtype}]"
    if isinstance(value, tuple):
        return "tuple[str, ...]" if all(isinstance(each, str) for each in value) else "tuple[tuple[int, int, float], ...]"
    return type(value).__name__
