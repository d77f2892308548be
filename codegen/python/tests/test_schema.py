"""The JSON Schema of descriptions accepts and rejects the same keys and types as the program."""

from __future__ import annotations

import json
import subprocess
import sys
from pathlib import Path

import pytest

from gelenk import _program

jsonschema = pytest.importorskip("jsonschema")
if sys.version_info < (3, 11):
    pytest.skip("tomllib is part of Python from 3.11", allow_module_level=True)
import tomllib  # noqa: E402

ROOT = Path(__file__).parents[3]
OF_VALUES = {"unknown-key", "wrong-type", "wrong-length", "not-positive", "unknown-value"}
SYNTAX = {"toml-syntax"}


def _run(*words: str) -> tuple[int, str]:
    done = subprocess.run([_program.find(), *words], capture_output=True, encoding="utf-8")
    return done.returncode, done.stdout


@pytest.fixture(scope="module")
def validator() -> jsonschema.protocols.Validator:
    schema = json.loads(_run("schema")[1])
    jsonschema.Draft202012Validator.check_schema(schema)
    return jsonschema.Draft202012Validator(schema)


def _read(path: Path) -> dict:
    return tomllib.loads(path.read_text("utf-8"))


@pytest.mark.parametrize("path", sorted((ROOT / "models").glob("*.toml")), ids=lambda path: path.stem)
def test_models_are_valid(validator: jsonschema.protocols.Validator, path: Path) -> None:
    assert [error.message for error in validator.iter_errors(_read(path))] == []


@pytest.mark.parametrize("path", sorted((ROOT / "codegen/tests/bad").glob("*.toml")), ids=lambda path: path.stem)
def test_schema_and_program_refuse_the_same_keys_and_values(validator: jsonschema.protocols.Validator, path: Path) -> None:
    code, printed = _run("--format", "json", "generate", str(path), "--output", "-")
    assert code == 1
    codes = {entry["code"] for entry in json.loads(printed)["diagnostics"]}
    if codes & SYNTAX:
        pytest.skip("it is no TOML")
    is_refused = any(True for _ in validator.iter_errors(_read(path)))
    assert is_refused == bool(codes & OF_VALUES), codes
