"""Tests of errors: rejected arguments, and messages with the expected arguments."""

from __future__ import annotations

import os
from pathlib import Path

import gelenk
import numpy as np
import pytest

ZERO = np.zeros(2)


@pytest.mark.parametrize(
    ("arguments", "kind", "message"),
    [
        ((ZERO, ZERO, np.zeros(3)), ValueError, r"`a` has the shape \(3,\), expected \(\.\.\., 2\): accelerations ÿ: shoulder, elbow in rad/s²"),
        ((ZERO, 0.0, ZERO), ValueError, r"`v` has the shape \(\), expected \(\.\.\., 2\)"),
        ((np.zeros((3, 2)), np.zeros((4, 2)), ZERO), ValueError, r"leading axes do not broadcast: \(3,\) of `y`, \(4,\) of `v`, \(\) of `a`"),
        ((ZERO, ZERO, 1j * ZERO), TypeError, "`a` holds complex128, which float64 does not hold exactly"),
        ((ZERO, ZERO.astype(np.longdouble), ZERO), TypeError, "`v` holds float128, which float64"),
        ((["0", "1"], ZERO, ZERO), TypeError, "`y` holds <U1"),
        (([None, 1], ZERO, ZERO), TypeError, "`y` holds object"),
        (([[1], [1, 2]], ZERO, ZERO), TypeError, "`y` is not an array of numbers"),
        ((ZERO, ZERO), TypeError, "missing 1 required positional argument: 'a'"),
    ],
)
def test_a_call_says_what_it_expects(arm: gelenk.Robot, arguments: tuple, kind: type, message: str) -> None:
    if np.dtype(np.longdouble) == np.float64 and "float128" in message:
        pytest.skip("long double is double here")
    with pytest.raises(kind, match=message):
        arm.inverse_dynamics(*arguments)


def test_parameters_are_known_by_name(powercube: gelenk.Robot, arm: gelenk.Robot) -> None:
    with pytest.raises(TypeError, match="unexpected keyword argument 'mass'"):
        powercube.mass_matrix(ZERO, mass=1.0)
    with pytest.raises(TypeError, match="has no parameter `mass`; it has g, beta_constant"):
        powercube.pack_parameters(mass=1.0)
    with pytest.raises(TypeError, match="arm has no parameter `g`; it has none"):
        arm.pack_parameters(g=1.0)
    with pytest.raises(TypeError, match="parameter `g` holds complex128"):
        powercube.gravity_forces(ZERO, g=1j)
    with pytest.raises(ValueError, match=r"`parameters` has the shape \(2,\), expected \(\.\.\., 16\): g, beta_constant"):
        powercube.gravity_forces(ZERO, parameters=ZERO)
    with pytest.raises(ValueError, match=r"do not broadcast: `g` \(2,\), `gamma_sign` \(3,\)"):
        powercube.pack_parameters(g=ZERO, gamma_sign=np.zeros(3))


def test_a_wrong_description_tells_all_its_faults(tmp_path: Path) -> None:
    file = tmp_path / "bad.toml"
    file.write_text('name = 3\n[[joints]]\nname = "a"\n[[bodies]]\nlink = "a"\n')
    with pytest.raises(gelenk.DescriptionError) as caught:
        gelenk.load(file)
    codes = [each.code for each in caught.value.diagnostics]
    assert codes == ["wrong-type", "missing-key"]
    first = caught.value.diagnostics[0]
    assert (first.severity, first.line, first.column) == ("error", 1, 8)
    assert str(caught.value).count("error[") == 2 and "1 | name = 3" in str(caught.value)
    with pytest.raises(gelenk.DescriptionError, match="cannot read .*nothing.toml"):
        gelenk.load(tmp_path / "nothing.toml")


def test_options_are_checked_by_the_program(arm_file: Path) -> None:
    with pytest.raises(ValueError, match="this function does not exist; did you mean `mass_matrix`"):
        gelenk.load(arm_file, functions=["mass_matrx"])
    with pytest.raises(ValueError, match="invalid value 'f16' for '--scalar"):
        gelenk.load(arm_file, scalar="f16")
    with pytest.raises(TypeError, match="unexpected keyword argument 'no_gravity'"):
        gelenk.load(arm_file, no_gravity=True)
    with pytest.raises(gelenk.DescriptionError, match="are written in C, but the language is Rust"):
        gelenk.generate(arm_file, arm_file.parent / "arm.rs", tools=["python"])


def test_a_missing_compiler_and_a_missing_program_are_named(
    arm_file: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setenv("GELENK_CACHE", str(tmp_path))
    monkeypatch.setenv("CC", "no-such-compiler -O2")
    with pytest.raises(gelenk.CompilerError, match="CC names `no-such-compiler -O2`, which does not run"):
        gelenk.load(arm_file, functions=["gravity_forces"])
    monkeypatch.delenv("CC")
    program = os.environ.get("GELENK_PROGRAM")
    monkeypatch.setenv("GELENK_PROGRAM", str(tmp_path / "gelenk"))
    with pytest.raises(gelenk.ProgramError, match="GELENK_PROGRAM names .*, which is not a file"):
        gelenk.load(arm_file)
    if program is not None:
        monkeypatch.setenv("GELENK_PROGRAM", program)
        monkeypatch.setattr("gelenk._compiler.CANDIDATES", (("no-cc",), ("no-gcc",)))
        gelenk._robot._compiler.find.cache_clear()
        with pytest.raises(gelenk.CompilerError, match=r"there is no C compiler \(tried: no-cc, no-gcc\)"):
            gelenk.load(arm_file, functions=["gravity_forces"])
        gelenk._robot._compiler.find.cache_clear()


def test_what_a_compiler_says_is_told(arm_file: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv("GELENK_CACHE", str(tmp_path))
    monkeypatch.setenv("CC", "cc -include nothing.h")
    with pytest.raises(gelenk.CompilerError, match=r"rejected the module:\n[^$]*nothing.h"):
        gelenk.load(arm_file, functions=["gravity_forces"])
    assert not list((tmp_path / "libraries").iterdir()), "nothing half-made is kept"


def test_a_warning_of_a_description_is_a_warning(tmp_path: Path) -> None:
    file = tmp_path / "arm.urdf"
    file.write_text(
        '<robot name="arm"><link name="base"/><link name="rod"><inertial><mass value="1"/>'
        '<inertia ixx="1" iyy="1" izz="9" ixy="0" ixz="0" iyz="0"/></inertial></link>'
        '<joint name="a" type="continuous"><parent link="base"/><child link="rod"/><axis xyz="0 1 0"/></joint></robot>',
        "utf-8",
    )
    with pytest.warns(gelenk.DescriptionWarning, match="unphysical-bodies"):
        robot = gelenk.load(file, functions=["gravity_forces"])
    assert [note.severity for note in robot.notes] == ["warning"]
    # The warning is repeated if the robot comes from the cache.
    with pytest.warns(gelenk.DescriptionWarning, match="unphysical-bodies"):
        gelenk.load(file, functions=["gravity_forces"])
