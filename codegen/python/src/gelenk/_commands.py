"""Functions that run the commands of the program."""

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
    """Writes the module of a description with `gelenk generate`. Returns the paths of the written files.

    - `output`: a file or a folder
    - `tools`: tools that get additional files next to a module in C (option `--for`)
    - all other keywords: options of `gelenk generate --help`
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
    """Writes a page about a robot with `gelenk report`. Returns the path of its `index.html`.

    Raises `GelenkError` if the self-check of the page fails. The page is written nevertheless.
    """
    options = {
        "output": output, "snap_angles": snap_angles, "no_friction": no_friction, "ignore_mimic": ignore_mimic,
        "base": base, "smooth_sign": smooth_sign, "accept_unphysical": accept_unphysical, "body": body, "hold": hold, "max_operations": max_operations,
    }
    result = _program.run(["report", description, *_program.switches(options)], may_fail=True)
    page = next(Path(file) for file in result["files"] if Path(file).name == "index.html")
    failed = [check["id"] for check in result["self_check"] if check["verdict"] != "holds"]
    if failed:
        raise GelenkError(f"the self-check of {result['robot']} failed: {', '.join(failed)}; see {page}")
    return page


@dataclass(frozen=True)
class Identified:
    """Results of `identify`: paths of the written files, and the identified values."""

    description: Path
    """Path of the description with the results, for `load`."""
    files: tuple[Path, ...]
    """Paths of the page and its files; empty without `report`."""
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
    """Estimates friction, inertias and drive gains from logs with `gelenk identify`, and writes a description with the results.

    - `output`: path of the description; by default <name>_identified.toml in the current folder
    - `payload`: logs of the robot with a load, in addition to `logs` without the load; the description has the load as a body
    - `columns`: patterns of column names by quantity, `{"position": "pos_{}", "torque": "tau_{}"}`
    - `hold`: joints at rest that have no columns in the logs, with their positions in rad or m, `{"finger_*": 0.02}`
    - `friction`: candidate terms of the friction laws, `["viscous", "coulomb", "tanh(50*v)"]`, or `"stribeck"`
    - `method`: method that selects the terms: `"subset"`, `"stls"`, `"lasso"` or `"all"`
    - `derivative`: method that differentiates the positions: `"filter"` or `"tvdiff"`
    - `merge`: whether `logs` are files of moments from `reduce`
    - all other keywords: options of `gelenk identify --help`
    """
    if output is not None and _is_moments(output):
        raise ValueError("`identify` writes a description, so `output` must not end in .moments: reduce and merge write *.moments")
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
    """Replays logs through the online friction estimator of the control loop with `gelenk identify --online`. Returns all results.

    The keywords are those of `identify`.
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
    """Plans a motion that excites the parameters with `gelenk identify --plan`. Returns the path of the CSV file."""
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
    """Reduces logs to moments with `gelenk identify --reduce`. Returns the path `output`, which must end in .moments.

    The keywords are those of `identify`. Use the same keywords for all moments that are merged.
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
    """Adds files of moments with `gelenk identify --merge`. Returns the path `output`, which must end in .moments.

    `identify` with `merge=True` estimates from files of moments.
    """
    if not _is_moments(output):
        raise ValueError(f"`merge` writes *.moments, not {os.fspath(output)}: identify(..., merge=True) writes a description")
    options = {
        "output": output, "friction_on": friction_on, "snap_angles": snap_angles, "no_friction": no_friction,
        "ignore_mimic": ignore_mimic, "base": base, "smooth_sign": smooth_sign, "accept_unphysical": accept_unphysical, "body": body,
    }
    found = _program.run(["identify", "--merge", description, *_paths(moments), *_program.switches(options)])
    return Path(found["moments"])


def _listed(terms: str | Iterable[str] | None) -> str | None:
    """Returns the terms separated by commas, as the value of an option."""
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
