"""Tests of the cache: reuse of entries, changes that need new entries, and two processes at once."""

from __future__ import annotations

import shutil
import subprocess
import sys
from pathlib import Path

import gelenk
import numpy as np
import pytest

from conftest import ARM, write

FEW = ["gravity_forces"]


@pytest.fixture
def empty(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    monkeypatch.setenv("GELENK_CACHE", str(tmp_path / "cache"))
    return tmp_path / "cache"


@pytest.fixture
def runs(monkeypatch: pytest.MonkeyPatch) -> list[str]:
    """Returns the programs that have run since the last call."""
    seen: list[str] = []
    program, compiler = gelenk._program.run, gelenk._robot._compiler.compile
    monkeypatch.setattr(
        "gelenk._program.run", lambda words, **options: (seen.append("program"), program(words, **options))[1]
    )
    monkeypatch.setattr(
        "gelenk._compiler.compile", lambda folder, sources: (seen.append("compiler"), compiler(folder, sources))[1]
    )
    return seen


def for_acados(file: Path) -> Path:
    """Returns the folder with the file that `gelenk.acados` executes. acados need not be installed."""
    return gelenk._robot.generated(file, [], "acados")


def entries(folder: Path) -> int:
    return len(list(folder.iterdir()))


def test_a_robot_is_made_once(empty: Path, runs: list[str], tmp_path: Path) -> None:
    base, file = tmp_path / "base.toml", tmp_path / "arm.toml"
    write(base, ARM)
    write(file, 'extends = "base.toml"\nname = "arm"\n')
    y = np.ones(2)
    first = gelenk.load(file, functions=FEW).gravity_forces(y)
    assert runs == ["program", "compiler"]
    gelenk.load(str(file), functions=FEW)
    assert runs == ["program", "compiler"]
    # Another option needs another module.
    gelenk.load(file, functions=FEW, fused_multiply_add=True)
    assert runs == ["program", "compiler"] * 2
    # A file that the description reads.
    write(base, ARM.replace("mass = 2.0", "mass = 4.0"))
    second = gelenk.load(file, functions=FEW).gravity_forces(y)
    assert runs == ["program", "compiler"] * 3 and not np.array_equal(first, second)
    # A comment does not change the module. The old content finds the old module.
    write(base, ARM + "# a comment\n")
    assert np.array_equal(gelenk.load(file, functions=FEW).gravity_forces(y), first)
    assert runs == [*["program", "compiler"] * 3, "program"]
    # Another build of the program.
    monkey = pytest.MonkeyPatch()
    monkey.setattr("gelenk._program.identity", lambda program: ["another"])
    gelenk.load(file, functions=FEW)
    monkey.undo()
    assert runs == [*["program", "compiler"] * 3, *["program"] * 2]
    # Another compiler.
    monkey.setattr("gelenk._compiler.identity", lambda: ["another"])
    gelenk.load(file, functions=FEW)
    monkey.undo()
    assert runs[-1] == "compiler"


def test_what_is_written_meanwhile_is_read_again(empty: Path, runs: list[str], tmp_path: Path) -> None:
    """A file that changes while the program reads it is not cached."""
    file = write(tmp_path / "arm.toml", ARM)
    file.touch()
    gelenk.load(file, functions=FEW)
    gelenk.load(file, functions=FEW)
    assert runs == ["program", "compiler", "program"]


def test_a_robot_elsewhere_is_the_same_robot(
    empty: Path, runs: list[str], tmp_path: Path, capfd: pytest.CaptureFixture[str]
) -> None:
    """Warnings of a cached module name the files of the current call."""
    told = []
    for name in ("here", "there"):
        (tmp_path / name).mkdir()
        write(tmp_path / name / "base.toml", ARM.replace('drive = "ideal"', "limits = { effort = 5 }"))
        file = write(tmp_path / name / "arm.toml", 'extends = "base.toml"\nname = "arm"\n')
        with pytest.warns(gelenk.DescriptionWarning, match=f"{name}/base.toml:4"):
            robot = gelenk.load(file, functions=FEW)
        told.append((robot.folder, capfd.readouterr().err))
        assert [note.file for note in robot.notes] == [str(tmp_path / name / "base.toml")]
    assert runs == ["program", "compiler"]
    [(folder, compiling), (other, nothing)] = told
    assert folder == other and nothing == ""
    assert compiling.startswith("gelenk: compiling arm.c") and compiling.count("\n") == 1
    # The same text extends another robot.
    write(tmp_path / "there/base.toml", ARM)
    gelenk.load(tmp_path / "there/arm.toml", functions=FEW)
    gelenk.load(tmp_path / "there/arm.toml", functions=FEW)
    assert runs == ["program", "compiler"] * 2


def test_what_was_removed_is_made_again(empty: Path, arm_file: Path) -> None:
    gelenk.load(arm_file, functions=FEW)
    for kind in ("libraries", "modules", "asked", "read"):
        shutil.rmtree(empty / kind)
        assert gelenk.load(arm_file, functions=FEW).N == 2
    for index in [*(empty / "asked").iterdir(), *(empty / "read").iterdir()]:
        index.write_text("{")
    assert gelenk.load(arm_file, functions=FEW).N == 2


def test_what_a_crash_left_half_written_is_made_again(empty: Path, arm_file: Path) -> None:
    """Damages the files: every second file is emptied, and all other files get another content."""
    gelenk.load(arm_file, functions=FEW)
    for_acados(arm_file)
    files = [file for kind in ("libraries", "modules") for entry in (empty / kind).iterdir() for file in entry.iterdir()]
    assert len(files) > 12
    for index, file in enumerate(files):
        text = ["", "raise SystemExit('executed')"][index % 2]
        # A new file replaces the old file, because a library may be in use.
        file.unlink()
        file.write_text(text)
        assert gelenk.load(arm_file, functions=FEW).N == 2
        for_acados(arm_file)
        assert file.read_text("utf-8", errors="replace") != text, file


def test_folders_of_other_users_are_refused(empty: Path, arm_file: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    gelenk.load(arm_file, functions=FEW)
    for_acados(arm_file)
    entries = [next((empty / kind).iterdir()) for kind in ("libraries", "modules")]
    for folder in [empty, empty / "modules", empty / "asked", *entries]:
        folder.chmod(0o777)
        with pytest.raises(gelenk.CacheError, match="set GELENK_CACHE to a folder of your own"):
            gelenk.load(arm_file, functions=FEW)
            for_acados(arm_file)
        folder.chmod(0o700)
    assert gelenk.load(arm_file, functions=FEW).N == 2
    monkeypatch.setattr("os.geteuid", lambda: empty.stat().st_uid + 1)
    for load in (gelenk.load, for_acados):
        with pytest.raises(gelenk.CacheError, match="belongs to another user"):
            load(arm_file)


def test_two_processes_make_the_same_robot_at_once(empty: Path, arm_file: Path) -> None:
    code = f"import gelenk; print(gelenk.load({str(arm_file)!r}).gravity_forces([0.5, 0.5]))"
    processes = [subprocess.Popen([sys.executable, "-c", code], stdout=subprocess.PIPE) for _ in range(3)]
    said = {process.communicate()[0] for process in processes}
    assert [process.returncode for process in processes] == [0, 0, 0] and len(said) == 1
    assert entries(empty / "modules") == 1 and entries(empty / "libraries") == 1, "nothing is left over"
