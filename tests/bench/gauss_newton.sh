#!/bin/sh
# Time of an optimal control problem in CasADi by `gelenk.gauss_newton`, beside the same problem set up by hand with several solvers.
#
#     sh tests/bench/gauss_newton.sh
#
# PYTHON names a Python with casadi, numpy and pytest; by default that of the tests. GELENK is the program.
set -eu
root=$(cd "$(dirname "$0")/../.." && pwd)
target=${CARGO_TARGET_DIR:-$root/target}
python=${PYTHON:-$target/python/bin/python}
[ -x "$python" ] || { echo "skipped: no $python: run \`cargo test -p gelenk-tests --test all casadi\` once"; exit 0; }
gelenk=${GELENK:-$target/release/gelenk}
[ -n "${GELENK:-}" ] || (cd "$root" && cargo build --quiet --release -p gelenk-codegen)
grep -m1 '^model name' /proc/cpuinfo || true
GELENK_PROGRAM=$gelenk GELENK_CACHE=$target/bench/gauss_newton PYTHONDONTWRITEBYTECODE=1 \
  PYTHONPATH=$root/codegen/python/src:$root/codegen/python/tests "$python" "$root/tests/bench/gauss_newton.py"
