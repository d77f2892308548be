#!/bin/sh
# Throughput of the functions over eight states beside the scalar ones, UR5 and Panda.
#
#     sh tests/bench/lanes.sh [options of the generator, e.g. --fused-multiply-add]
#
# RUSTFLAGS_BENCH: how the scalar code is compiled, by default `-C target-cpu=native`.
set -eu
root=$(cd "$(dirname "$0")/../.." && pwd)
target=${CARGO_TARGET_DIR:-$root/target}
mkdir -p "$target/bench"
(cd "$root" && cargo build --quiet --release -p gelenk-codegen)
for robot in ur5 panda; do
  module=$target/bench/${robot}_lanes.rs
  "$target/release/gelenk" generate "$root/models/$robot.toml" --no-friction --lanes inverse_dynamics,linearize "$@" \
    --output "$module" >"$target/bench/${robot}_lanes.txt" 2>&1
  # shellcheck disable=SC2086
  GELENK_MODULE=$module rustc --edition 2024 -C opt-level=3 ${RUSTFLAGS_BENCH:--C target-cpu=native} \
    -o "$target/bench/${robot}_lanes" "$root/tests/bench/lanes.rs"
  echo "$robot"
  "$target/bench/${robot}_lanes"
done
