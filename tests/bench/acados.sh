#!/bin/sh
# Time of whole control steps: acados' SQP_RTI on gelenk's functions, and LTV-MPC and NMPC of the runtime, on the same problems in
# one run, in turns.
#
#     sh tests/bench/acados.sh [powercube ur5 panda]
#
# It needs Python with its module venv, make and a C compiler; acados comes from a third party's wheel (tests/python/acados.txt),
# which is compiled for processors with AVX2. PYTHON names another Python, ACADOS_PYTHON one that has acados, casadi and numpy.
set -eu
root=$(cd "$(dirname "$0")/../.." && pwd)
work=${CARGO_TARGET_DIR:-$root/target}/bench/acados
mkdir -p "$work"
python=${ACADOS_PYTHON:-$work/python/bin/python}
if [ ! -x "$python" ]; then
  "${PYTHON:-python3}" -m venv --clear "$work/python"
  for list in acados requirements; do
    "$python" -m pip install --quiet --disable-pip-version-check --only-binary :all: -r "$root/tests/python/$list.txt" ||
      { echo "skipped: acados cannot be had here"; exit 0; }
  done
fi
gelenk=${GELENK:-${CARGO_TARGET_DIR:-$root/target}/release/gelenk}
[ -n "${GELENK:-}" ] || (cd "$root" && cargo build --quiet --release -p gelenk-codegen)
(cd "$root" && RUSTFLAGS="-C target-cpu=native" cargo build --quiet --release -p gelenk-runtime --example step_plugin \
  --target-dir "$work/native")
library=$(find "$work/native/release/examples" -name 'libstep_plugin.*' ! -name '*.d' | head -n 1)
GELENK_PROGRAM=$gelenk GELENK_CACHE=$work/cache PYTHONDONTWRITEBYTECODE=1 \
  PYTHONPATH=$root/codegen/python/src:$root/codegen/python/tests \
  "$python" "$root/tests/bench/acados_steps.py" "$library" "$@"
