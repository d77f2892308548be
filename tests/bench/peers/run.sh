#!/bin/sh
# Peers of the project measured side by side. usage: run.sh dynamics|mpc|identification [extra arguments for the bench, e.g. ours=path/to/lib.so]
# Everything it needs comes from package registries: a Python environment (requirements.txt), g++, clang (optional, makes Pinocchio faster), cargo.
# A contender is any shared object that exports the C ABI of dynamics/rbd_abi.h or mpc/mpc_abi.h (a Rust cdylib, say). LAB is the scratch folder.
set -eu
HERE=$(cd "$(dirname "$0")" && pwd); LAB=${LAB:-${TMPDIR:-/tmp}/gelenk-bench}; mkdir -p "$LAB/build" "$LAB/models" "$LAB/gen"
WHAT=${1:?dynamics, mpc or identification}; shift
[ -x "$LAB/venv/bin/python" ] || { python3 -m venv "$LAB/venv"; "$LAB/venv/bin/pip" install -q -r "$HERE/requirements.txt"; }
PY=$LAB/venv/bin/python; B=$LAB/build; cd "$LAB"
CXX_PIN=${CXX_PIN:-$(command -v clang++ || echo g++)}
case $WHAT in
dynamics)
  P=$($PY -c 'import pinocchio, os; p = os.path.dirname(pinocchio.__file__); print(p[:p.index("cmeel.prefix")] + "cmeel.prefix")')
  [ -e models/go2.txt ] || $PY "$HERE/dynamics/make_models.py" models
  [ "$B/dyn_bench" -nt "$HERE/dynamics/dyn_bench.cpp" ] || g++ -O2 -march=x86-64-v3 -o "$B/dyn_bench" "$HERE/dynamics/dyn_bench.cpp" -ldl
  [ "$B/pinocchio.so" -nt "$HERE/dynamics/plugin_pinocchio.cpp" ] || "$CXX_PIN" -std=c++17 -O3 -march=native -DNDEBUG -DBOOST_MPL_LIMIT_LIST_SIZE=30 -DBOOST_MPL_LIMIT_VECTOR_SIZE=30 -DBOOST_MPL_CFG_NO_PREPROCESSED_HEADERS \
    -DBOOST_FUSION_INVOKE_MAX_ARITY=12 -shared -fPIC -I "$P/include" -I "$P/include/eigen3" -I /usr/include/eigen3 -o "$B/pinocchio.so" "$HERE/dynamics/plugin_pinocchio.cpp"
  for r in ${ROBOTS:-ur5 panda}; do
    O=; for a in "$@"; do O="$O $(echo "$a" | sed "s/{robot}/$r/")"; done
    case $(head -c 8 "models/$r.txt") in floating) "$B/dyn_bench" "models/$r.txt" pinocchio="$B/pinocchio.so" $O; continue;; esac  # no CasADi for floating robots
    [ -e "gen/${r}_casadi_base.so" ] || { $PY "$HERE/dynamics/gen_casadi.py" "models/$r.txt" gen --tag casadi; $PY "$HERE/dynamics/gen_casadi.py" "models/$r.txt" gen --tag casadi_base --cse --base; } >/dev/null
    "$B/dyn_bench" "models/$r.txt" pinocchio="$B/pinocchio.so" casadi="gen/${r}_casadi.so" casadi_base="gen/${r}_casadi_base.so" $O
  done;;
mpc)
  [ -e "$B/mpc_bench" ] || g++ -O2 -I "$HERE/mpc" -o "$B/mpc_bench" "$HERE/mpc/mpc_bench.cpp" -ldl
  [ -e "$B/clarabel.so" ] || { cp -r "$HERE/mpc/plugin_rs" "$LAB/"; (cd "$LAB/plugin_rs" && RUSTFLAGS="-C target-cpu=native" cargo build --release -q && cp target/release/libplugin_mpc.so "$B/clarabel.so"); }
  mkdir -p qps; for q in "$HERE"/mpc/qps/*.xz; do xz -dc "$q" > "qps/$(basename "$q" .xz)"; done
  for q in qps/*.bin; do "$B/mpc_bench" "$q" clarabel="$B/clarabel.so" "$@"; done;;
identification) (cd "$HERE/identification" && PYTHONDONTWRITEBYTECODE=1 "$PY" ident_bench.py "$@");;
*) echo "unknown: $WHAT"; exit 2;;
esac
