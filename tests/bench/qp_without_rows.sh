#!/bin/sh
# Time and instructions of a QP without rows, by the solver of this checkout and by the one of an earlier commit: the last one
# before rows `lo ≤ C x + D u ≤ hi`, or the one that BEFORE names. Both stand in one program, which solves in turns.
#
#     sh tests/bench/qp_without_rows.sh
#
# It compiles some minutes. A warm start is one from the solution of the problem before; where instructions are counted, that is another problem.
# Instructions are counted by Valgrind, where it is installed. The earlier commit is unpacked in a temporary folder.
set -eu
root=$(cd "$(dirname "$0")/../.." && pwd)
target=${CARGO_TARGET_DIR:-$root/target}
before=${BEFORE:-648c4df^}
# Outside of the checkout, whose workspace would be taken for that of the earlier commit.
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT
git -C "$root" archive "$before" Cargo.toml Cargo.lock codegen runtime generated tests README.md | (mkdir "$work/before" && tar -x -C "$work/before")
# Two packages of one name need two versions.
sed 's/"0\.1\.0"/"0.0.1"/' "$work/before/Cargo.toml" >"$work/Cargo.toml.before"
mv "$work/Cargo.toml.before" "$work/before/Cargo.toml"
cat >"$work/Cargo.toml" <<END
[package]
name = "qp_without_rows"
version = "0.0.0"
edition = "2024"

[[bin]]
name = "qp_without_rows"
path = "$root/tests/bench/qp_without_rows.rs"

[dependencies]
runtime_before = { package = "gelenk-runtime", path = "before/runtime" }
runtime_now = { package = "gelenk-runtime", path = "$root/runtime" }
rustix = { version = "1", features = ["time"] }

[workspace]
exclude = ["before"]
END
cp "$root/Cargo.lock" "$work/Cargo.lock"
CARGO_TARGET_DIR=$target cargo build --quiet --release --manifest-path "$work/Cargo.toml"
program=$target/release/qp_without_rows

grep -m1 '^model name' /proc/cpuinfo || true
echo "load $(cut -d' ' -f1-3 /proc/loadavg)"
"$program" time
command -v valgrind >/dev/null || { echo "skipped: no Valgrind to count instructions"; exit 0; }

# Instructions of so many solves of one size by one solver.
collected() {
  valgrind --tool=callgrind --callgrind-out-file=/dev/null "$program" "$@" 2>&1 | sed -n 's/.*Collected : //p'
}
echo "states/inputs   start   instructions before        now   ratio"
for size in 2/1 4/2 12/6 14/7; do
  for start in cold warm; do
    for solver in before now; do
      many=$(collected "$size" "$start" "$solver" 20)
      none=$(collected "$size" "$start" "$solver" 0)
      echo "$many $none"
    done | awk -v size="$size" -v start="$start" \
      '{ count[NR] = ($1 - $2) / 20 } END { printf "%13s %7s %21d %10d   %.4f\n", size, start, count[1], count[2], count[2] / count[1] }'
  done
done
