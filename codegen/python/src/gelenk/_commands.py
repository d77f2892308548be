"""The program's commands as functions."""

from __future__ import annotations

import os
from dataclasses import dataclass
from pathlib import Path
from typing import Any, Iterable, Mapping

from . import _program
from .errors import GelenkError

PathLike = str | os.PathLike[str]


def generate(
    description: PathLike,
    output: PathLike | None = None,
    *,
    language: str = "rust",
    tools: Iterable[str] = (),
    functions: Iterable[str] | None = None,
    lanes: Iterable[str] | None = None,
    scalar: str = "f64",
    control_model: float | None = None,
    self_test: bool = False,
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
) -> list[Path]:
    """Writes the module of a description, as `gelenk generate` does; the files.

    - `output`: a file, or in C a folder
    - `tools`: further files beside a module in C, the program's `--for`
    - all others: as `gelenk generate --help` says
    """
    options = {
        "output": output, "language": language, "for": list(tools), "functions": functions, "lanes": lanes,
        "scalar": scalar, "control_model": control_model, "self_test": self_test, "snap_angles": snap_angles,
        "no_friction": no_friction, "ignore_mimic": ignore_mimic, "base": base,
        "smooth_sign": smooth_sign, "accept_unphysical": accept_unphysical, "body": body, "hold": hold, "fused_multiply_add": fused_multiply_add,
        "max_operations": max_operations,
    }
    written = _program.run(["generate", description, *_program.switches(options)])
    return [Path(file) for module in written for file in module["files"]]


def report(
    description: PathLike,
    output: PathLike | None = None,
    *,
    snap_angles: float | None = None,
    no_friction: bool = False,
    ignore_mimic: bool = False,
    base: str | None = None,
    smooth_sign: float | None = None,
    accept_unphysical: bool = False,
    body: str | None = None,
    hold: Mapping[str, float] | Iterable[str] = (),
    max_operations: int | None = None,
) -> Path:
    """Writes a page about a robot, as `gelenk report` does; its `index.html`.

    Raises `GelenkError` where the functions of the robot disagree with each other, after the page is written.
    """
    options = {
        "output": output, "snap_angles": snap_angles, "no_friction": no_friction, "ignore_mimic": ignore_mimic,
        "base": base, "smooth_sign": smooth_sign, "accept_unphysical": accept_unphysical, "body": body, "hold": hold, "max_operations": max_operations,
    }
    result = _program.run(["report", description, *_program.switches(options)], may_fail=True)
    page = next(Path(file) for file in result["files"] if Path(file).name == "index.html")
    failed = [check["id"] for check in result["self_check"] if check["verdict"] != "holds"]
    if failed:
        raise GelenkError(f"the functions of {result['robot']} disagree with each other: {', '.join(failed)}; see {page}")
    return page


@dataclass(frozen=True)
class Identified:
    """What `identify` wrote and found."""

    description: Path
    """The description with the results, which `load` reads."""
    files: tuple[Path, ...]
    """The page and its files, where a page was asked for."""
    found: Mapping[str, Any]
    """All results: joints, parameters with their uncertainties, warnings."""


def identify(
    description: PathLike,
    logs: PathLike | Iterable[PathLike],
    output: PathLike | None = None,
    *,
    report: PathLike | None = None,
    validate: PathLike | Iterable[PathLike] = (),
    payload: PathLike | Iterable[PathLike] = (),
    payload_on: str | None = None,
    columns: str | Mapping[str, str] | None = None,
    hold: Mapping[str, float] | Iterable[str] = (),
    separator: str | None = None,
    effort: str | None = None,
    gravity_compensated: bool = False,
    bandwidth: float | None = None,
    delay: float | None = None,
    load_friction: bool = False,
    friction_on: str | None = None,
    friction: str | Iterable[str] | None = None,
    method: str | None = None,
    threshold: float | None = None,
    derivative: str | None = None,
    accept_poor: bool = False,
    merge: bool = False,
    snap_angles: float | None = None,
    no_friction: bool = False,
    ignore_mimic: bool = False,
    base: str | None = None,
    smooth_sign: float | None = None,
    accept_unphysical: bool = False,
    body: str | None = None,
) -> Identified:
    """Finds friction, inertias and drive gains in logs, as `gelenk identify` does, and writes a description with them.

    - `output`: where the description goes; by default <name>_identified.toml in the current folder
    - `payload`: logs with a load in the robot's hand, `logs` being those without: the description has the load as a body
    - `columns`: which columns are what, `{"position": "pos_{}", "torque": "tau_{}"}`
    - `hold`: joints that the logs leave out, at rest at a position in rad or m, `{"finger_*": 0.02}`
    - `friction`: terms that friction laws are chosen from, `["viscous", "coulomb", "tanh(50*v)"]`, or `"stribeck"`
    - `method`: how the terms are chosen, `"subset"`, `"stls"`, `"lasso"` or `"all"`
    - `derivative`: how positions are differentiated, `"filter"` or `"tvdiff"`
    - `merge`: `logs` are files of moments, which `reduce` wrote
    - all others: as `gelenk identify --help` says
    """
    if output is not None and _is_moments(output):
        raise ValueError("identify writes a description: reduce and merge write *.moments")
    options = {
        "output": output, "report": report, "payload_on": payload_on, "columns": _patterns(columns), "separator": separator,
        "effort": effort,
        "gravity_compensated": gravity_compensated, "bandwidth": bandwidth, "delay": delay,
        "load_friction": load_friction, "friction_on": friction_on, "friction": _listed(friction), "method": method,
        "threshold": threshold, "derivative": derivative,
        "accept_poor": accept_poor,
        "merge": merge,
        "snap_angles": snap_angles, "no_friction": no_friction, "ignore_mimic": ignore_mimic, "base": base,
        "smooth_sign": smooth_sign, "accept_unphysical": accept_unphysical, "body": body, "hold": hold,
    }
    held_out = [f"--validate={os.fspath(log)}" for log in _paths(validate)]
    loaded = [f"--payload={os.fspath(log)}" for log in _paths(payload)]
    found = _program.run(["identify", description, *_paths(logs), *held_out, *loaded, *_program.switches(options)])
    return Identified(Path(found["description"]), tuple(map(Path, found["files"])), found)


def online(
    description: PathLike,
    logs: PathLike | Iterable[PathLike],
    *,
    report: PathLike | None = None,
    columns: str | Mapping[str, str] | None = None,
    hold: Mapping[str, float] | Iterable[str] = (),
    separator: str | None = None,
    effort: str | None = None,
    gravity_compensated: bool = False,
    delay: float | None = None,
    snap_angles: float | None = None,
    no_friction: bool = False,
    ignore_mimic: bool = False,
    base: str | None = None,
    smooth_sign: float | None = None,
    accept_unphysical: bool = False,
    body: str | None = None,
) -> Mapping[str, Any]:
    """Replays logs through the estimator of friction of the control loop, as `gelenk identify --online` does; all results.

    - all keywords: as those of `identify`
    """
    options = {
        "report": report, "columns": _patterns(columns), "separator": separator, "effort": effort,
        "gravity_compensated": gravity_compensated, "delay": delay,
        "snap_angles": snap_angles, "no_friction": no_friction, "ignore_mimic": ignore_mimic, "base": base,
        "smooth_sign": smooth_sign, "accept_unphysical": accept_unphysical, "body": body, "hold": hold,
    }
    return _program.run(["identify", "--online", description, *_paths(logs), *_program.switches(options)])


def plan(
    description: PathLike,
    output: PathLike | None = None,
    *,
    seconds: float | None = None,
    rate: float | None = None,
    acceleration: float | None = None,
    position_share: float | None = None,
    turn: float | None = None,
    speed_share: float | None = None,
    effort_share: float | None = None,
    harmonics: int | None = None,
    start: str | None = None,
    seed: int | None = None,
    friction_on: str | None = None,
    snap_angles: float | None = None,
    no_friction: bool = False,
    ignore_mimic: bool = False,
    base: str | None = None,
    smooth_sign: float | None = None,
    accept_unphysical: bool = False,
    body: str | None = None,
) -> Path:
    """Plans a motion that shows the parameters, as `gelenk identify --plan` does; the CSV file."""
    options = {
        "output": output, "seconds": seconds, "rate": rate, "acceleration": acceleration, "position_share": position_share,
        "turn": turn, "speed_share": speed_share, "effort_share": effort_share, "harmonics": harmonics, "start": start,
        "seed": seed, "friction_on": friction_on, "snap_angles": snap_angles, "no_friction": no_friction, "ignore_mimic": ignore_mimic,
        "base": base, "smooth_sign": smooth_sign, "accept_unphysical": accept_unphysical, "body": body,
    }
    found = _program.run(["identify", "--plan", description, *_program.switches(options)])
    return Path(found["file"])


def reduce(
    description: PathLike,
    logs: PathLike | Iterable[PathLike],
    output: PathLike,
    *,
    columns: str | Mapping[str, str] | None = None,
    hold: Mapping[str, float] | Iterable[str] = (),
    separator: str | None = None,
    effort: str | None = None,
    gravity_compensated: bool = False,
    bandwidth: float | None = None,
    delay: float | None = None,
    friction_on: str | None = None,
    accept_poor: bool = False,
    snap_angles: float | None = None,
    no_friction: bool = False,
    ignore_mimic: bool = False,
    base: str | None = None,
    smooth_sign: float | None = None,
    accept_unphysical: bool = False,
    body: str | None = None,
) -> Path:
    """Reduces logs to their moments, as `gelenk identify --reduce` does; the file `output`, which ends in .moments.

    The keywords are those of `identify`. All moments that are merged have to be made with the same ones.
    """
    options = {
        "output": output, "columns": _patterns(columns), "separator": separator, "effort": effort,
        "gravity_compensated": gravity_compensated, "bandwidth": bandwidth, "delay": delay, "friction_on": friction_on,
        "accept_poor": accept_poor,
        "snap_angles": snap_angles, "no_friction": no_friction, "ignore_mimic": ignore_mimic, "base": base,
        "smooth_sign": smooth_sign, "accept_unphysical": accept_unphysical, "body": body, "hold": hold,
    }
    found = _program.run(["identify", "--reduce", description, *_paths(logs), *_program.switches(options)])
    return Path(found["moments"])


def merge(
    description: PathLike,
    moments: PathLike | Iterable[PathLike],
    output: PathLike,
    *,
    friction_on: str | None = None,
    snap_angles: float | None = None,
    no_friction: bool = False,
    ignore_mimic: bool = False,
    base: str | None = None,
    smooth_sign: float | None = None,
    accept_unphysical: bool = False,
    body: str | None = None,
) -> Path:
    """Adds up files of moments, as `gelenk identify --merge` does; the file `output`, which ends in .moments.

    `identify` with `merge=True` identifies from such files.
    """
    if not _is_moments(output):
        raise ValueError(f"merge writes *.moments, not {os.fspath(output)}: identify(..., merge=True) writes a description")
    options = {
        "output": output, "friction_on": friction_on, "snap_angles": snap_angles, "no_friction": no_friction,
        "ignore_mimic": ignore_mimic, "base": base, "smooth_sign": smooth_sign, "accept_unphysical": accept_unphysical, "body": body,
    }
    found = _program.run(["identify", "--merge", description, *_paths(moments), *_program.switches(options)])
    return Path(found["moments"])


def _listed(terms: str | Iterable[str] | None) -> str | None:
    """Terms as the program takes them."""
    return terms if terms is None or isinstance(terms, str) else ",".join(terms)


def _is_moments(path: PathLike) -> bool:
    return Path(path).suffix == ".moments"


def _patterns(columns: str | Mapping[str, str] | None) -> str | None:
    if isinstance(columns, Mapping):
        return ",".join(f"{what}={pattern}" for what, pattern in columns.items())
    return columns


def _paths(one_or_several: PathLike | Iterable[PathLike]) -> list[PathLike]:
    if isinstance(one_or_several, (str, os.PathLike)):
        return [one_or_several]
    return list(one_or_several)
