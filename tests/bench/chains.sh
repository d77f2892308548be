#!/bin/sh
# Time per call of the Jacobians of chains beside Pinocchio, in one run, round by round, with the bytes of their code.
#
#     sh tests/bench/chains.sh [arguments of the comparison, e.g. --rounds 81]
#
# CHAINS are numbers of joints for which the comparison has a chain: 2 3 4 6 7 12 20 30; LAB as in
# dynamics.sh, which has to have run once: it builds the comparison.
set -eu
root=$(cd "$(dirname "$0")/../.." && pwd)
lab=${LAB:-${TMPDIR:-/tmp}/gelenk-bench}
[ -x "$lab/build/dyn_bench" ] || { echo "skipped: no comparison at $lab, run dynamics.sh first"; exit 0; }
work=${CARGO_TARGET_DIR:-$root/target}/bench
mkdir -p "$work"
(cd "$root" && cargo build --quiet --release -p gelenk-codegen)
gelenk=${CARGO_TARGET_DIR:-$root/target}/release/gelenk
functions=inverse_dynamics,bias_forces,mass_matrix,mass_matrix_and_bias_forces,forward_dynamics
functions=$functions,inverse_dynamics_derivatives_and_mass_matrix,forward_dynamics_derivatives
for joints in ${CHAINS:-6 7 12 30}; do
  chain=chain$joints
  python3 "$root/tests/bench/chain_urdf.py" "$lab/models/$chain.txt" "$work/$chain.urdf"
  "$gelenk" generate "$work/$chain.urdf" --snap-angles 1e-9 --functions "$functions" ${GELENK_OPTIONS:-} --output "$work/$chain.rs" \
    >"$work/$chain.log" 2>&1
  GELENK_MODULE="$work/$chain.rs" rustc --edition 2024 --crate-type cdylib -C opt-level=3 -C target-cpu=native -C panic=abort \
    -A unexpected_cfgs --cfg has_mass_matrix_and_bias_forces --cfg has_inverse_dynamics_derivatives_and_mass_matrix \
    --cfg has_forward_dynamics_derivatives -o "$work/$chain.so" "$root/tests/bench/plugin.rs"
  "$lab/build/dyn_bench" "$lab/models/$chain.txt" pinocchio="$lab/build/pinocchio.so" gelenk="$work/$chain.so" \
    --fn rnea_der,fd_der "$@"
  "$gelenk" inspect counts "$work/$chain.urdf" --snap-angles 1e-9 --bytes 2>/dev/null | grep -E "function |derivatives|linearize" || true
done
