#!/bin/sh
# Time of evaluating gelenk's external functions in CasADi, beside functions of the same inputs and outputs that CasADi generates itself
# from the same robot: one run, round by round, the same C compiler and flags.
#
#     sh tests/bench/casadi.sh [ur5 panda]
#
# peers/dynamics describes the robots for CasADi.
# PYTHON names a Python with casadi, pin, example-robot-data and numpy; otherwise an environment is made. CC is the C compiler.
set -eu
root=$(cd "$(dirname "$0")/../.." && pwd)
peers=$root/tests/bench/peers/dynamics
work=${CARGO_TARGET_DIR:-$root/target}/bench/casadi
mkdir -p "$work/models"
python=${PYTHON:-$work/python/bin/python}
if [ ! -x "$python" ]; then
  python3 -m venv --clear "$work/python"
  "$python" -m pip install --quiet --disable-pip-version-check casadi pin example-robot-data numpy ||
    { echo "skipped: CasADi cannot be had here"; exit 0; }
fi
gelenk=${GELENK:-${CARGO_TARGET_DIR:-$root/target}/release/gelenk}
[ -n "${GELENK:-}" ] || (cd "$root" && cargo build --quiet --release -p gelenk-codegen)
[ -e "$work/models/panda.txt" ] || "$python" "$peers/make_models.py" "$work/models" >/dev/null
grep -m1 '^model name' /proc/cpuinfo || true
for robot in ${*:-ur5 panda}; do
  # The other side knows no friction.
  "$gelenk" generate "$root/models/$robot.toml" --no-friction --language c --for casadi --output "$work" \
    --functions inverse_dynamics,inverse_dynamics_derivatives_and_mass_matrix,forward_dynamics,linearize >"$work/$robot.txt" 2>&1
  PYTHONDONTWRITEBYTECODE=1 PYTHONPATH=$peers \
    "$python" "$root/tests/bench/casadi_externals.py" "$robot" "$work"
done
