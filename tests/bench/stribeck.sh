#!/bin/sh
# Time of the Stribeck fit beside SciPy's curve_fit, on the same samples and one core, round by round in one run.
#
#     sh tests/bench/stribeck.sh [ROUNDS]
#
# Both get samples of one law with noise. gelenk searches its starts itself, fits an offset beside the law, and tells the errors of all
# parameters; SciPy begins at a start near the law. The fits with an offset must agree: the script fails where they do not.
# PYTHON names a Python with numpy and scipy; otherwise an environment is made.
set -eu
root=$(cd "$(dirname "$0")/../.." && pwd)
work=${CARGO_TARGET_DIR:-$root/target}/bench/stribeck
mkdir -p "$work"
python=${PYTHON:-$work/python/bin/python}
if [ ! -x "$python" ]; then
  python3 -m venv --clear "$work/python"
  "$python" -m pip install --quiet --disable-pip-version-check numpy scipy ||
    { echo "skipped: SciPy cannot be had here"; exit 0; }
fi
grep -m1 '^model name' /proc/cpuinfo || true
cd "$root"
cargo bench --quiet -p gelenk-runtime --bench identification --no-run
PYTHONDONTWRITEBYTECODE=1 OMP_NUM_THREADS=1 OPENBLAS_NUM_THREADS=1 "$python" tests/bench/stribeck.py "${1:-5}"
