#!/bin/sh
# Time per call of the generated functions beside Pinocchio and CasADi, in one run, round by round: as `gelenk generate`
# writes them by default (gelenk), and with fused multiply-adds (gelenk_fma).
#
#     sh tests/bench/dynamics.sh [arguments of the comparison, e.g. --fn rnea,crba]
#
# ROBOTS chooses among ur5, panda and the floating go2, solo12, iris, g1 and talos_floating, by default ur5 and panda. The URDFs of the
# floating robots are those that tests/reference/robots.py fetches.
#
# peers/run.sh installs and builds the others. LAB is where it keeps what it builds. GELENK_OPTIONS has further options of the generator.
set -eu
root=$(cd "$(dirname "$0")/../.." && pwd)
work=${CARGO_TARGET_DIR:-$root/target}/bench
mkdir -p "$work"
(cd "$root" && cargo build --quiet --release -p gelenk-codegen)
gelenk=${CARGO_TARGET_DIR:-$root/target}/release/gelenk

# The description of a robot. A floating base has forces here, as in the comparison.
description() {
  case $1 in ur5 | panda)
    echo "$root/models/$1.toml"
    return
    ;;
  esac
  python3 "$root/tests/reference/robots.py" >&2
  urdf=$root/tests/reference/robots/$1.urdf
  {
    printf 'name = "%s"\nurdf = "%s"\nbase = { type = "floating" }\n' "$1" "$urdf"
    for part in x y z rx ry rz; do printf '[[joints]]\nname = "base_%s"\ndrive = "ideal"\n' "$part"; done
  } >"$work/$1.toml"
  echo "$work/$1.toml"
}

# One robot as a shared object: name of the variant, robot, options of the generator.
build() {
  module=$work/$2_$1
  # The others know no friction.
  # shellcheck disable=SC2086
  "$gelenk" generate "$(description "$2")" --no-friction --functions all ${GELENK_OPTIONS:-} $3 --output "$module.rs" >"$module.txt" 2>&1
  has=
  for function in mass_matrix_and_bias_forces inverse_dynamics_derivatives_and_mass_matrix forward_dynamics_derivatives; do
    if grep -q "^pub fn $function(" "$module.rs"; then has="$has --cfg has_$function"; fi
  done
  if grep -q "^pub const NY:" "$module.rs"; then has="$has --cfg has_quaternions"; fi
  # shellcheck disable=SC2086
  GELENK_MODULE="$module.rs" rustc --edition 2024 --crate-type cdylib -C opt-level=3 -C target-cpu=native -C panic=abort \
    -A unexpected_cfgs $has -o "$module.so" "$root/tests/bench/plugin.rs"
}

for robot in ${ROBOTS:=ur5 panda}; do
  build gelenk "$robot" ""
  build gelenk_fma "$robot" --fused-multiply-add
done
export ROBOTS
sh "$root/tests/bench/peers/run.sh" dynamics gelenk="$work/{robot}_gelenk.so" gelenk_fma="$work/{robot}_gelenk_fma.so" "$@"
