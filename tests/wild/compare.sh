#!/bin/sh
# Generated functions of the 59 published robots of robots.txt beside Pinocchio.
#
#     sh tests/wild/compare.sh [parts of the robots' paths, by default all]
#
# PYTHON is a Python with the packages `pin`, `example-robot-data` and `numpy`; without them the comparison is skipped. All
# robots take half an hour on two cores.
set -eu
root=$(cd "$(dirname "$0")/../.." && pwd)
python=${PYTHON:-python3}
command -v "$python" >/dev/null 2>&1 || { echo "skipped: no $python"; exit 0; }
"$python" -c 'import numpy, pinocchio' 2>/dev/null || { echo "skipped: $python lacks pin or numpy"; exit 0; }
target=${CARGO_TARGET_DIR:-$root/target}
(cd "$root" && cargo build --quiet --release -p gelenk-codegen)
exec "$python" "$root/tests/wild/compare.py" "$target/release/gelenk" "$target/wild" "$@"
