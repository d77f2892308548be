#!/bin/sh
# The table and the figure of the guide "Friction during motion": 28 measured runs of a Schunk LWA 4P, in recorded order.
#
#     sh tests/online/schunk.sh [FOLDER]
#
# FOLDER (default: the folder `online` in the target folder) gets the logs, the description and the page. The runs lie in the folder
# `shared` beside the checkout, or where GELENK_SHARED says; without them the script does nothing. The efforts of the logs contain neither
# gravity nor Coulomb friction, which the robot compensates. Therefore the description has viscous friction only. The speed limit of the
# joints is 72 degrees per second.
set -eu
root=$(cd "$(dirname "$0")/../.." && pwd)
runs=${GELENK_SHARED:-$root/../shared}/data/schunk_lwa4p/runs.csv
[ -e "$runs" ] || { echo "skipped: there is no $runs"; exit 0; }
target=${CARGO_TARGET_DIR:-$root/target}
folder=${1:-$target/online}
rm -rf "$folder/logs"
mkdir -p "$folder/logs"
awk -F, -v folder="$folder/logs" '
  /nan/ { next } # the last row of a run has no efforts
  { row = substr($0, length($1) + 2) }
  NR == 1 { header = row; next }
  $1 != run { close(file); run = $1; file = sprintf("%s/run_%03d.csv", folder, run); print header > file }
  { print row > file }' "$runs"
sed 's/^friction = { viscous = \([0-9.]*\), coulomb = .*/friction = { viscous = \1 }\nlimits = { velocity = 1.2566 }/' \
  "$root/models/schunk_lwa4p.toml" > "$folder/schunk.toml"
(cd "$root" && cargo build --quiet --release -p gelenk-codegen)
exec "$target/release/gelenk" identify "$folder/schunk.toml" --online "$folder"/logs/*.csv \
  --gravity-compensated --effort joint --report "$folder/page"
