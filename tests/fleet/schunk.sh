#!/bin/sh
# The 28 measured runs of a Schunk LWA 4P as a fleet's logs: reduced as tasks of Dask, added up as a tree, and compared with a
# single process to 1e-10.
#
#     sh tests/fleet/schunk.sh
#
# The runs lie in the folder `shared` beside the checkout, or where GELENK_SHARED says; without them it is skipped. The first
# time it makes a Python environment with Dask in the target folder. PYTHON is the Python to make it with. It takes a minute.
set -eu
root=$(cd "$(dirname "$0")/../.." && pwd)
runs=${GELENK_SHARED:-$root/../shared}/data/schunk_lwa4p/runs.csv
[ -e "$runs" ] || { echo "skipped: there is no $runs"; exit 0; }
python=${PYTHON:-python3}
command -v "$python" >/dev/null 2>&1 || { echo "skipped: no $python"; exit 0; }
target=${CARGO_TARGET_DIR:-$root/target}
folder=$target/fleet
mkdir -p "$folder"
if ! cmp -s "$root/tests/fleet/requirements.txt" "$folder/installed.txt"; then
  "$python" -m venv --clear "$folder/python"
  "$folder/python/bin/pip" install --quiet --disable-pip-version-check -r "$root/tests/fleet/requirements.txt"
  cp "$root/tests/fleet/requirements.txt" "$folder/installed.txt"
fi
(cd "$root" && cargo build --quiet --release -p gelenk-codegen)
exec "$folder/python/bin/python" "$root/tests/fleet/schunk.py" \
  "$target/release/gelenk" "$root/models/schunk_lwa4p.toml" "$runs" "$folder/logs"
