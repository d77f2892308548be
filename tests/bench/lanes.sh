#!/bin/sh
# Throughput of the functions over eight states beside the scalar ones: inverse dynamics and linearize, by default of UR5, Panda,
# the quadrotor and a floating Go2. Prints the median of the
# ratios round by round, scalar code and lanes compiled for the same instruction set.
#
#     ROBOTS="ur5 panda" sh tests/bench/lanes.sh [options of the generator, e.g. --fused-multiply-add]
set -eu
root=$(cd "$(dirname "$0")/../.." && pwd)
target=${CARGO_TARGET_DIR:-$root/target}
functions=inverse_dynamics,linearize
mkdir -p "$target/bench"
(cd "$root" && cargo build --quiet --release -p gelenk-codegen)
# Names of the form, of its function's ending, and what the whole program is compiled for. Not x86-64-v4: for it LLVM
# keeps to registers of 256 bits.
forms='avx2|-C target-cpu=x86-64-v3
avx512|-C target-cpu=x86-64-v3 -C target-feature=+avx512f,+avx512bw,+avx512cd,+avx512dq,+avx512vl'
grep -m1 '^model name' /proc/cpuinfo || true
echo "load $(cut -d' ' -f1-3 /proc/loadavg)"
echo "function             robot  form    scalar ns   lanes ns   ratio (first and last quartile)"
for robot in ${ROBOTS:=ur5 panda quadrotor go2}; do
  module=$target/bench/${robot}_lanes.rs
  "$target/release/gelenk" generate "$root/models/$robot.toml" --no-friction --functions "$functions" \
    --lanes "$functions" "$@" --output "$module" >"$target/bench/${robot}_lanes.txt" 2>&1
  has=
  if grep -q "^pub const NY:" "$module"; then has="--cfg has_quaternions"; fi
  echo "$forms" | while IFS='|' read -r form flags; do
    program=$target/bench/${robot}_lanes_$form
    # shellcheck disable=SC2086
    GELENK_MODULE=$module rustc --edition 2024 -C opt-level=3 $flags $has --cfg "form=\"$form\"" \
      --check-cfg 'cfg(form, values("avx2", "avx512"))' --check-cfg 'cfg(has_quaternions)' -o "$program" "$root/tests/bench/lanes.rs"
    "$program" "$robot"
  done
done
