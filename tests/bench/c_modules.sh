#!/bin/sh
# Time per call of modules in C over that of the same modules in Rust, round by round.
#
#     sh tests/bench/c_modules.sh [robots]
#
# GELENK_CC names the compilers, separated by semicolons; by default gcc at -O2 and at -O3. Further options of the
# generator, if any, stand in GELENK_OPTIONS.
set -eu
root=$(cd "$(dirname "$0")/../.." && pwd)
work=${CARGO_TARGET_DIR:-$root/target}/bench
mkdir -p "$work"
gelenk=${GELENK:-${CARGO_TARGET_DIR:-$root/target}/release/gelenk}
[ -n "${GELENK:-}" ] || (cd "$root" && cargo build --quiet --release -p gelenk-codegen)

for robot in ${*:-powercube ur5 panda}; do
  module=$work/$robot
  # shellcheck disable=SC2086
  "$gelenk" generate "$root/models/$robot.toml" --functions all ${GELENK_OPTIONS:-} --output "$module.rs" >"$module.txt" 2>&1
  # The functions are called `c_…`.
  # shellcheck disable=SC2086
  "$gelenk" generate "$root/models/$robot.toml" --functions all ${GELENK_OPTIONS:-} --language c --output "$work/c.c" >>"$module.txt" 2>&1
  has=
  if grep -q '^pub fn linearize_into(' "$module.rs"; then has="--cfg has_linearize_into"; fi
  echo "${GELENK_CC:-gcc -O2;gcc -O3}" | tr ';' '\n' | while read -r compiler; do
    $compiler -std=c99 -march=native -c "$work/c.c" -o "$work/c.o"
    # shellcheck disable=SC2086
    GELENK_MODULE="$module.rs" rustc --edition 2024 -C opt-level=3 -C target-cpu=native -A unexpected_cfgs $has \
      -C link-arg="$work/c.o" -o "$work/c_modules" "$root/tests/bench/c_modules.rs"
    echo "$robot, $compiler"
    "$work/c_modules"
  done
done
