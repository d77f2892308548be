"""Loads a description as an object with the functions of the robot."""

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
"""Version of the contents of cache entries."""

CLOCK = 0.05
"""Largest error of file times in seconds, because operating systems take them from a coarse clock."""


class Robot:
    """A robot with functions over NumPy arrays. `gelenk.load` makes it.

    The object has the functions and constants of the generated module: `robot.inverse_dynamics(y, v, a)`, `robot.N`,
    `robot.JOINT_NAMES`. `help(robot.inverse_dynamics)` shows the arguments and results of a function. Leading axes of arrays
    are batch axes: they count states, and the loop over them is compiled.
    """

    name: str
    """Name of the robot."""
    description: tuple[str, ...]
    """Lines of the key `description`."""
    dtype: np.dtype[Any]
    """Type of all numbers."""
    notes: tuple[Diagnostic, ...]
    """Notes and warnings of the program about the description."""
    default_parameters: dict[str, float]
    """Values of the free parameters in the description."""
    folder: Path
    """Folder with the module in C and its compiled library."""
    N: int
    """Number of coordinates."""
    M: int
    """Number of inputs."""

    def pack_parameters(self, **values: Any) -> np.ndarray:
        """Packs all free parameters into one array, for the keyword `parameters` of every function.

        Parameters without a value have the value of the description. Calls in a loop are faster with this array than with
        one keyword per parameter. Raises `TypeError` for an unknown name.
        """
        unknown = [name for name in values if name not in self._parameters.fields]
        if unknown:
            known = ", ".join(self._parameters.fields) or "none"
            raise TypeError(f"{self.name} has no parameter `{unknown[0]}`; it has {known}")
        return self._parameters.pack(None, **values)

    def stub(self) -> str:
        """Returns the text of a type stub: a class with the functions and constants of this robot.

        Write the text to `ur5.pyi` and import the class under `if TYPE_CHECKING`. Editors and type checkers then know the
        functions of `robot: "Ur5" = gelenk.load("ur5.toml")`.
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
    """Loads a description (TOML, URDF or MJCF) and returns the robot with its functions.

    The program `gelenk` generates C, and a C compiler compiles it: `CC` if it is set, otherwise cc, gcc, clang or zig cc.
    Module and library are cached by content, so the next call only reads the description.

    - `functions`: names of the functions; by default the functions in the description, otherwise all
    - `lanes`: functions that compute eight states of a batch at once even if this makes their code large; straight-line
      functions always do
    - `scalar`: `"f64"`, or `"f32"` for functions in single precision
    - `base`: `"floating"` for a robot with a floating base
    - all other keywords: options of `gelenk generate --help`

    Raises `DescriptionError` for a wrong description, `CompilerError`, `ProgramError`, and `ValueError` for an option that the
    program rejects.
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
    """Returns the robot of a description.

    - `options`: options of the command line
    - `depth`: number of calls between `read` and the code of the user, for the place of warnings
    """
    path = Path(description)
    module = generated(path, options, "python")
    told, notes = read(module, path, depth)
    library = compiled(module, told["files"])
    made = robot(told, notes, library, np.dtype(np.float32 if "--scalar=f32" in options else np.float64))
    made._made_of = description, options, module.name
    return made


def again(make: Callable[[str, list[str], int], Any], description: str, options: list[str], module: str) -> Any:
    """Loads the robot of a pickled object again in this process.

    Raises `GelenkError` if the description or the program has changed since the object was pickled.
    """
    made = make(description, options, 5)
    if made._made_of[2] != module:
        raise GelenkError(f"{description} or the program `gelenk` has changed since this robot was pickled: load it and pickle it again")
    return made


def read(module: Path, description: Path, depth: int = 3) -> tuple[dict[str, Any], tuple[Diagnostic, ...]]:
    """Reads the output of the program for a module, and its notes. Warnings become Python warnings at the line that loads the robot."""
    told = json.loads((module / "module.json").read_text("utf-8"))
    folder = description.parent
    notes = _program.diagnostics(_at(note, lambda file: os.path.join(folder, file)) for note in told["notes"])
    for note in notes:
        if note.severity == "warning":
            warnings.warn(str(note), DescriptionWarning, stacklevel=depth)
    return told, notes


def _at(note: dict[str, Any], place: Callable[[str], str]) -> dict[str, Any]:
    """Returns the note with the path of its file replaced by `place(file)`."""
    if note["file"] is None:
        return note
    file = place(note["file"])
    return {**note, "file": file, "text": note["text"].replace(f"--> {note['file']}:", f"--> {file}:", 1)}


def generated(description: Path, options: list[str], tool: str) -> Path:
    """Returns the folder with the module in C and the output of the program.

    - `tool`: tool that gets additional files: `python`, `casadi` or `acados`

    One cache entry has the list of files that the program reads for a description and its options. Another has the module
    for the contents of these files. The key contains only relative paths between the files.
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
        # The header of the module has the command, with paths relative to the folder of the program.
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
        # A file that changed while the program ran may differ from the text that was read. The next call then runs the program again.
        if all(Path(file).stat().st_mtime < start - CLOCK for file in told["read"]):
            read = [os.path.relpath(file, description.parent) for file in told["read"]]
            _cache.write_json("read", asked, read)
            _cache.write_json("asked", _asked(asked, description, read), name)
        return place
    finally:
        shutil.rmtree(scratch, ignore_errors=True)


def compiled(module: Path, files: Iterable[str]) -> Path:
    """Returns the path of the shared library of a module with these files."""
    sources = [name for name in files if name.endswith(".c")]

    def fill(place: Path) -> None:
        for file in module.iterdir():
            shutil.copy(file, place / file.name)
        print(f"gelenk: compiling {', '.join(sources)}, once: the library is kept in {_cache.folder()}", file=sys.stderr)
        _compiler.compile(place, sources)

    name = _cache.key(FORMAT, module.name, sources, _compiler.identity())
    return _cache.entry("libraries", name, fill) / _compiler.LIBRARY


def robot(told: Mapping[str, Any], notes: tuple[Diagnostic, ...], path: Path, dtype: np.dtype[Any]) -> Robot:
    """Returns the robot of a compiled module."""
    interface = told["interface"]
    library = ctypes.CDLL(str(path))
    arguments = {each["name"] for function in interface["functions"] for each in function["arguments"]}
    parameters = Parameters(interface["parameters"], sorted(arguments), dtype)
    # Functions of positions only have no parameters.
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
            raise ValueError(f"the module has a function `{function.name}`, but a constant or attribute of the robot has this name")
        inputs, results = function.operands()
        symbol = f"{interface['prefix']}_python_{function.told['name']}"
        call = gufunc(library, symbol, function.name, inputs, results, dtype) if results else None
        names[function.name] = function.define(call)
    made: Robot = type(class_name(told["robot"]), (Robot,), names)()
    return made


def constant(told: Mapping[str, Any], dtype: np.dtype[Any]) -> Any:
    """Returns a constant of the module. Numbers are read-only arrays, names are tuples."""
    kind, value = told["kind"], told["value"]
    if kind == "count":
        return value
    if kind == "names":
        return tuple(value)
    if kind == "sparse":
        return tuple((row, column, dtype.type(float(number))) for row, column, number in value)
    types = {"indices": np.dtype(int), "numbers": dtype, "pattern": np.dtype(bool)}
    # JSON has infinity as a text, which `float` can read.
    array = np.array(value, np.float64 if kind == "numbers" else types[kind]).astype(types[kind])
    array.flags.writeable = False
    return array


def class_name(name: str) -> str:
    """Returns the class name for the name of a robot."""
    words = [word for word in re.split(r"[^0-9A-Za-z]+", name) if word]
    joined = "".join(word[0].upper() + word[1:] for word in words)
    return identifier(joined if joined[:1].isalpha() else f"Robot{joined}")


def stub(robot: Robot) -> str:
    """Returns the text of a type stub for the robot."""
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
