#!/bin/sh
# Time per state of batches from Python over that of functions over eight states in Rust.
#
#     sh tests/bench/python_lanes.sh [robots]
#
# PYTHON names a Python with NumPy, CC the C compiler of the modules, GELENK the program where it is built already.
set -eu
root=$(cd "$(dirname "$0")/../.." && pwd)
work=${CARGO_TARGET_DIR:-$root/target}/bench
mkdir -p "$work"
gelenk=${GELENK:-${CARGO_TARGET_DIR:-$root/target}/release/gelenk}
[ -n "${GELENK:-}" ] || (cd "$root" && cargo build --quiet --release -p gelenk-codegen)
grep -m1 '^model name' /proc/cpuinfo || true

libraries=
for robot in ${*:-powercube ur5}; do
  module=$work/${robot}_for_python.rs
  "$gelenk" generate "$root/models/$robot.toml" --functions inverse_dynamics,linearize \
    --lanes inverse_dynamics,linearize --output "$module" >"$work/${robot}_for_python.txt" 2>&1
  GELENK_MODULE=$module rustc --edition 2024 --crate-type cdylib -C opt-level=3 -C target-cpu=native -A warnings \
    -o "$work/$robot.so" "$root/tests/bench/python_lanes.rs"
  libraries="$libraries $work/$robot.so"
done
# shellcheck disable=SC2086
GELENK_PROGRAM=$gelenk PYTHONPATH=$root/codegen/python/src ${PYTHON:-python3} "$root/tests/bench/python_lanes.py" $libraries
