#!/bin/sh
# How long the generator and rustc take: wall time, user time and peak memory for all functions of UR5, Panda and a chain
# of 30 joints with full inertias and ±90° between the axes.
#
#     sh tests/bench/generation.sh [options of the generator, e.g. --fused-multiply-add]
#
# BENCH_ROBOTS: which of `ur5 panda chain30`, by default all.
set -eu
root=$(cd "$(dirname "$0")/../.." && pwd)
target=${CARGO_TARGET_DIR:-$root/target}
folder=$target/bench/generation
mkdir -p "$folder"
(cd "$root" && cargo build --quiet --release -p gelenk-codegen)

gnu_time=''
for candidate in time gtime; do
  path=$(command -v "$candidate" 2>/dev/null || true)
  if [ -x "${path:-}" ] && "$path" -f '%e %U %M' true 2>/dev/null; then gnu_time=$path; break; fi
done
if [ -z "$gnu_time" ] && [ -x /usr/bin/time ] && /usr/bin/time -f %e true 2>/dev/null; then gnu_time=/usr/bin/time; fi
if [ -z "$gnu_time" ]; then
  echo "no GNU time (package time): the shell's own, without user time of children and peak memory" >&2
fi

# Wall, user [s] and peak memory [MB] of a command.
measured() {
  if [ -n "$gnu_time" ]; then
    if ! "$gnu_time" -f '%e %U %M' -o "$folder/time" "$@" >"$folder/log" 2>&1; then
      cat "$folder/log" >&2
      exit 1
    fi
    awk '{ printf "%8.2f %8.2f %8.0f", $1, $2, $3 / 1024 }' "$folder/time"
  else
    start=$(date +%s)
    "$@" >"$folder/log" 2>&1
    printf '%8d        ?        ?' "$(($(date +%s) - start))"
  fi
}

# Every joint turns about z; the axes stand alternately at +90° and −90° to each other. Inertias are full, centres of
# mass general, and no two bodies are alike.
chain() {
  echo "name = \"chain$1\""
  awk -v joints="$1" 'BEGIN {
    for (i = 1; i <= joints; i++) {
      printf "\n[[joints]]\nname = \"joint_%d\"\naxis = [0, 0, 1]\ndrive = \"ideal\"\n", i
      printf "origin = { xyz = [%.3f, %.3f, %.3f], rpy = [\"%spi/2\", 0, 0] }\n", 0.1 + 0.001 * i, 0.02, 0.2 - 0.001 * i, i % 2 ? "" : "-"
      printf "\n[[bodies]]\nlink = \"joint_%d\"\nmass = %.2f\ncenter_of_mass = [%.3f, %.3f, %.3f]\n", i, 2 + 0.03 * i, 0.05 + 0.001 * i, 0.01 - 0.0003 * i, 0.08
      printf "inertia = { xx = %.4f, yy = %.4f, zz = %.4f, xy = %.4f, xz = %.4f, yz = %.4f }\n", 0.02 + 0.0001 * i, 0.03, 0.025, 0.001, 0.002, 0.0015
    }
  }'
}

grep -m1 '^model name' /proc/cpuinfo 2>/dev/null || true
echo "load $(cut -d' ' -f1-3 /proc/loadavg 2>/dev/null || uptime)"
echo "robot    command         wall s   user s  peak MB"
for robot in ${BENCH_ROBOTS:-ur5 panda chain30}; do
  description=$root/models/$robot.toml
  case $robot in
    chain*)
      description=$folder/$robot.toml
      chain "${robot#chain}" >"$description"
      ;;
  esac
  module=$folder/$robot.rs
  numbers=$(measured "$target/release/gelenk" generate "$description" --functions all "$@" --output "$module")
  printf '%-8s gelenk       %s\n' "$robot" "$numbers"
  numbers=$(measured rustc --edition 2024 --crate-type lib -O -o "$folder/lib$robot.rlib" "$module")
  printf '%-8s rustc -O     %s\n' "$robot" "$numbers"
  printf '%-8s module       %s KB of text, %s KB of code\n' "$robot" "$(($(wc -c <"$module") / 1024))" \
    "$(size -A "$folder/lib$robot.rlib" 2>/dev/null | awk '/^\.text/ { sum += $2 } END { printf "%d", sum / 1024 }')"
done
