#!/bin/sh
# Robots of this repository, exported, beside MuJoCo and Pinocchio; and published robots in MJCF beside MuJoCo.
#
#     sh tests/mujoco/compare.sh
#
# PYTHON is a Python with the packages `mujoco`, `pin` and `numpy`; without `pin` the comparison with Pinocchio is skipped.
# GELENK_EXPORTS is the number of random exports of each kind, 50 where it is absent; 3600 are the long run. Published robots are those of the packages `dm-control`, `gymnasium` and `robosuite`; robots.txt lists them with their outcomes.
set -eu
root=$(cd "$(dirname "$0")/../.." && pwd)
python=${PYTHON:-python3}
command -v "$python" >/dev/null 2>&1 || { echo "skipped: no $python"; exit 0; }
"$python" -c 'import numpy, mujoco' 2>/dev/null || { echo "skipped: $python lacks mujoco or numpy"; exit 0; }
cd "$root"
GELENK_MUJOCO_PYTHON=$python exec cargo test -p gelenk-tests --test all mujoco:: -- --include-ignored --nocapture
