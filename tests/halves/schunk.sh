#!/bin/sh
# `gelenk identify` beside least squares in numpy, on halves of the 28 measured runs of a Schunk LWA 4P.
#
#     sh tests/halves/schunk.sh
#
# The runs lie in the folder `shared` beside the checkout, or where GELENK_SHARED says; without them it is skipped. The first
# time it makes a Python environment with numpy and Pinocchio in the target folder. PYTHON is the Python to make it with, 3.11
# or later. It takes a minute.
set -eu
root=$(cd "$(dirname "$0")/../.." && pwd)
data=${GELENK_SHARED:-$root/../shared}/data/schunk_lwa4p
[ -e "$data/runs.csv" ] || { echo "skipped: there is no $data/runs.csv"; exit 0; }
python=${PYTHON:-python3}
command -v "$python" >/dev/null 2>&1 || { echo "skipped: no $python"; exit 0; }
target=${CARGO_TARGET_DIR:-$root/target}
folder=$target/halves
mkdir -p "$folder"
if ! cmp -s "$root/tests/halves/requirements.txt" "$folder/installed.txt"; then
  "$python" -m venv --clear "$folder/python"
  "$folder/python/bin/pip" install --quiet --disable-pip-version-check -r "$root/tests/halves/requirements.txt"
  cp "$root/tests/halves/requirements.txt" "$folder/installed.txt"
fi
(cd "$root" && cargo build --quiet --release -p gelenk-codegen)
exec "$folder/python/bin/python" "$root/tests/halves/schunk.py" \
  "$target/release/gelenk" "$root/models/schunk_lwa4p.toml" "$data" "$folder/logs"
