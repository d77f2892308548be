#!/bin/sh
# Inverse dynamics, feed-forward and joint PD in single precision on a Cortex-M4F and a Cortex-M7 that QEMU plays: instructions
# per call, bytes of stack, bytes of code. Results must have the bits of the host's, and the image must hold neither a panic nor
# a soft-float function.
#
#     sh tests/microcontroller/measure.sh [robots]
#
# It needs gcc-arm-none-eabi, qemu-system-arm and a C compiler `cc`, for Rust also rustc's target thumbv7em-none-eabihf. What is
# missing is skipped with a note. `sh tests/microcontroller/measure.sh --install`, as root on Debian, adds it and ends.
set -eu
here=$(cd "$(dirname "$0")" && pwd)
root=$(cd "$here/../.." && pwd)
target=thumbv7em-none-eabihf
work=${CARGO_TARGET_DIR:-$root/target}/microcontroller

if [ "${1:-}" = --install ]; then
  if ! command -v arm-none-eabi-gcc >/dev/null || ! command -v qemu-system-arm >/dev/null; then
    apt-get update -qq
    apt-get install -y -qq --no-install-recommends gcc-arm-none-eabi qemu-system-arm
  fi
  rustup target add "$target"
  exit
fi
for tool in arm-none-eabi-gcc qemu-system-arm cc; do
  if ! command -v "$tool" >/dev/null; then
    echo "skipped: no $tool; \`sh tests/microcontroller/measure.sh --install\` adds a cross compiler and QEMU on Debian"
    exit
  fi
done
languages="c rust"
if [ ! -d "$(rustc --print sysroot)/lib/rustlib/$target" ]; then
  echo "skipped: Rust: no target $target; \`rustup target add $target\` adds it"
  languages=c
fi
gelenk=${GELENK:-${CARGO_TARGET_DIR:-$root/target}/release/gelenk}
[ -n "${GELENK:-}" ] || (cd "$root" && cargo build --quiet --release -p gelenk-codegen)

warnings="-std=c99 -Wall -Wextra -Wdouble-promotion -Werror -ffp-contract=off"

# Options of a processor; -fno-math-errno makes square roots instructions.
processor() {
  case $1 in
    cortex-m4) echo "-mcpu=cortex-m4 -mfpu=fpv4-sp-d16" ;;
    cortex-m7) echo "-mcpu=cortex-m7 -mfpu=fpv5-sp-d16" ;;
    cortex-m7-double) echo "-mcpu=cortex-m7 -mfpu=fpv5-d16" ;;
  esac
}

# arm FOLDER PROCESSOR ARGUMENTS: compiles or links.
arm() {
  folder=$1
  # shellcheck disable=SC2046,SC2086
  arm_options="$(processor "$2") -mthumb -mfloat-abi=hard -O2 -ffunction-sections -fdata-sections -fno-math-errno"
  shift 2
  # shellcheck disable=SC2086
  (cd "$folder" && arm-none-eabi-gcc $arm_options -I . -I "$here" "$@")
}

# board_support FOLDER PROCESSOR: cortex_m.o. Loops that copy stay loops: they are memcpy.
board_support() {
  # shellcheck disable=SC2086
  arm "$1" "$2" $warnings -isystem "$here/include" -fno-strict-aliasing -fno-tree-loop-distribute-patterns \
    -c "$here/cortex_m.c"
}

# compile FOLDER PROCESSOR LANGUAGE: FOLDER/image.elf, and the names of all that is not the robot's.
compile() {
  # shellcheck disable=SC2086
  arm "$1" "$2" $warnings -isystem "$here/include" -c "$here/measure.c"
  board_support "$1" "$2"
  case $3 in
    c)
      # shellcheck disable=SC2086
      arm "$1" "$2" $warnings -isystem "$here/include" -c robot.c "$here/law.c"
      objects="robot.o law.o"
      ;;
    rust)
      cp "$here/law.rs" "$1/law.rs"
      rustc --edition 2024 --crate-type staticlib --target "$target" -C target-cpu="$2" -C opt-level=3 -C panic=abort \
        -C codegen-units=1 -o "$1/law.a" "$1/law.rs"
      objects=law.a
      ;;
  esac
  # shellcheck disable=SC2086
  arm "$1" "$2" -nostdlib -Wl,--gc-sections -Wl,-z,noexecstack -Wl,-T,"$here/boards.ld" -o image.elf measure.o cortex_m.o $objects -lgcc
  arm-none-eabi-nm "$1/measure.o" "$1/cortex_m.o" | awk 'NF == 3 { print $3 }' >"$1/own.txt"
}

# check IMAGE: neither panics nor arithmetic in software.
check() {
  if arm-none-eabi-nm "$1" | grep -E 'panic|__aeabi_(d|f|[a-z]+2[df])|__[a-z]+[sd]f[0-9]?$|unwind'; then
    echo "error: $1 holds these" >&2
    exit 1
  fi
}

# bytes FOLDER: code and constants of the robot's functions.
bytes() {
  arm-none-eabi-nm -S "$1/image.elf" | awk 'NR == FNR { own[$1]; next } NF == 4 && $3 ~ /[tTrR]/ && !($4 in own) { print $2 }' \
    "$1/own.txt" - | while read -r size; do echo $((0x$size)); done | awk '{ sum += $1 } END { print sum }'
}

# run FOLDER BOARD: what the program prints.
run() {
  timeout 60 qemu-system-arm -machine "$2" -nographic -monitor none -serial none -icount shift=0 \
    -semihosting-config enable=on,target=native -kernel "$1/image.elf" 2>&1
}

value() {
  awk -v what="$2" -v name="$3" '$1 == what && $2 == name { print $3 }' "$1"
}

# row ROBOT LANGUAGE BOARD PROCESSOR: compiles, runs, compares, prints.
row() {
  folder=$work/$1
  compile "$folder" "$4" "$2"
  check "$folder/image.elf"
  if ! run "$folder" "$3" >"$folder/$2_$3.txt"; then
    echo "error: $folder/image.elf fails on $3:" >&2
    tail -n 3 "$folder/$2_$3.txt" >&2
    exit 1
  fi
  grep '^result' "$folder/$2_$3.txt" >"$folder/results.txt" || true
  cmp "$folder/results.txt" "$folder/host.txt"
  [ "$(value "$folder/$2_$3.txt" tick instructions)" = 40 ] || { echo "error: a tick is not 40 instructions" >&2; exit 1; }
  cells=
  for law in inverse_dynamics feed_forward joint_pd; do
    cells="$cells $(value "$folder/$2_$3.txt" instructions $law), $(value "$folder/$2_$3.txt" stack $law) |"
  done
  echo "| $1, $2, $4 |$cells $(bytes "$folder") |"
}

echo "| instructions per call, bytes of stack | inverse dynamics | feed-forward | joint PD | bytes of code |"
echo "|---|---|---|---|---|"
for robot in ${*:-ur5 powercube}; do
  folder=$work/$robot
  mkdir -p "$folder"
  functions="mass_matrix,input_matrix,inverse_dynamics"
  "$gelenk" generate "$root/models/$robot.toml" --scalar f32 --functions "$functions" --language c --output "$folder/robot.c" \
    >"$folder/generate.txt" 2>&1
  "$gelenk" generate "$root/models/$robot.toml" --scalar f32 --functions "$functions" --output "$folder/robot.rs" \
    >>"$folder/generate.txt" 2>&1
  # shellcheck disable=SC2086
  (cd "$folder" && cc $warnings -O2 -DHOST -I . -I "$here" -o host robot.c "$here/law.c" "$here/measure.c" -lm && ./host >host.txt)
  for language in $languages; do
    row "$robot" "$language" mps2-an386 cortex-m4
    row "$robot" "$language" mps2-an500 cortex-m7
  done
done

[ "$languages" = c ] && exit

# The online estimator in double precision, which the Cortex-M4F computes in software.
folder=$work/online
mkdir -p "$folder"
cp "$root/Cargo.lock" "$here/online.rs" "$folder"
"$gelenk" generate "$root/models/powercube.toml" --output "$folder/robot.rs" >"$folder/generate.txt" 2>&1
cat >"$folder/Cargo.toml" <<END
[package]
name = "online"
version = "0.1.0"
edition = "2024"
[lib]
path = "online.rs"
crate-type = ["staticlib"]
[dependencies]
gelenk-adaptation = { path = "$root/runtime/adaptation" }
gelenk-dynamics = { path = "$root/runtime/dynamics" }
gelenk-kernels = { path = "$root/codegen/kernels" }
[profile.release]
panic = "abort"
lto = true
codegen-units = 1
[workspace]
END

# library FOR OPTIONS: the estimator for a target, in the folder of that target.
library() {
  (cd "$folder" && CARGO_TARGET_DIR="$folder/target" RUSTC_WRAPPER='' RUSTFLAGS="$2" cargo build --quiet --release --target "$1")
}

host=$(rustc -vV | sed -n 's/^host: //p')
library "$host" ""
# shellcheck disable=SC2086
(cd "$folder" && cc $warnings -O2 -DHOST -I "$here" -o host "$here/online.c" "target/$host/release/libonline.a" && ./host >host.txt)

echo
echo "| instructions per period | estimator | robot's forces | bytes of stack |"
echo "|---|---|---|---|"
for board in "mps2-an386 cortex-m4 cortex-m4" "mps2-an500 cortex-m7 cortex-m7-double"; do
  # shellcheck disable=SC2086
  set -- $board
  library "$target" "-C target-cpu=$2"
  # shellcheck disable=SC2086
  arm "$folder" "$3" $warnings -isystem "$here/include" -c "$here/online.c"
  board_support "$folder" "$3"
  arm "$folder" "$3" -nostdlib -Wl,--gc-sections -Wl,-z,noexecstack -Wl,-T,"$here/boards.ld" -o image.elf online.o cortex_m.o \
    "target/$target/release/libonline.a" -lgcc
  run "$folder" "$1" >"$folder/$1.txt"
  grep '^result' "$folder/$1.txt" | cmp - "$folder/host.txt"
  forces=$(value "$folder/$1.txt" instructions described)
  estimator=$(($(value "$folder/$1.txt" instructions update) - forces))
  echo "| powercube, $2 | $estimator | $forces | $(value "$folder/$1.txt" stack update) |"
done
