#!/usr/bin/env bash
# Trains a model with a server, from nothing, and serves it.
#
#   deploy/train-demo.sh           1,835 simulated contacts, preset tuned: HMMs
#                                  and LSTMs; about two minutes on two cores
#   deploy/train-demo.sh --quick   192 contacts and a small preset; half a minute
#
# Installs what is missing, builds the programs, and starts tactusd with an empty
# data directory. Then: simulate, upload, train, evaluate, promote through a
# gate, stream against the new version, roll back. Shows each command. Stops the
# server at the end and removes all that it made.
set -euo pipefail
cd "$(dirname "${BASH_SOURCE[0]}")/.."

quick=no
bin=build/release/bin
build=yes
for arg in "$@"; do
  case "$arg" in
    --quick) quick=yes ;;
    --bin=*) bin=${arg#--bin=} build=no ;;   # programs that are built already
    -h | --help) sed -n '2,/^set /{/^set /d;s/^# \{0,1\}//;p}' "$0"; exit 0 ;;
    *) echo "train-demo.sh: unknown option '$arg' (try --help)" >&2; exit 2 ;;
  esac
done

work=$(mktemp -d)
server=""   # the tactusd that we started

clean_up() {
  if [[ -n $server ]]; then
    kill -TERM "$server" 2>/dev/null || true
    wait "$server" 2>/dev/null || true
  fi
  rm -rf "$work"
}
trap clean_up EXIT

die() {
  printf 'train-demo: %s\n' "$*" >&2
  cat "$work/tactusd.log" >&2
  exit 1
}

# build: installs and builds what is missing.
build() {
  # A build folder that has the tests keeps them.
  local fresh=()
  [[ -e build/release/CMakeCache.txt ]] || fresh=(-D TACTUS_BUILD_TESTS=OFF)
  deploy/install-deps.sh &&
    cmake --preset release "${fresh[@]}" &&
    cmake --build --preset release --parallel "$(nproc)" \
      --target tactusd tactus-trainer trainctl tactus-stream
}
if [[ $build == yes ]]; then
  echo "train-demo: building (the first time takes minutes;" \
    "tail -f $work/build.log)" >&2
  build >"$work/build.log" 2>&1 || {
    cat "$work/build.log" >&2
    echo "train-demo: building failed" >&2
    exit 1
  }
fi

export TACTUS_SERVER=unix:$work/tactusd.sock
"$bin/tactusd" --listen="$TACTUS_SERVER" --data-dir="$work/data" \
  >"$work/tactusd.log" 2>&1 &
server=$!
for ((i = 0; i < 300; ++i)); do
  [[ ! -S $work/tactusd.sock ]] || break
  kill -0 "$server" 2>/dev/null || die "tactusd ended"
  sleep 0.1
done

# show COMMAND...: prints a command as a user would type it, and runs it.
show() {
  printf '\n$ %s\n' "${*//$work\//}"
  "$bin/$1" "${@:2}"
}

if [[ $quick == yes ]]; then
  simulate=(--protocol=grid --sample=192)
  train=(--preset=paper --networks=0)
else
  simulate=(--protocol=paper)
  train=(--preset=tuned)
fi
show trainctl simulate "${simulate[@]}" --skin=good --seed=1 \
  --out="$work/train.h5"
show trainctl simulate --protocol=grid --sample=96 --skin=good --seed=2 \
  --out="$work/check.h5"
show trainctl datasets create arm
show trainctl datasets upload arm --data="$work/train.h5"
show trainctl datasets create check
show trainctl datasets upload check --data="$work/check.h5"
show trainctl train --dataset=arm --model=arm "${train[@]}" --skip-unusable
show trainctl evaluate --dataset=check --model=arm@1

# The gate compares with the model that tactusd carries. Margins of 1 let any
# model pass, so that the demonstration goes on; choose small ones.
show trainctl models promote models/default/versions/1
show trainctl models alias default --gate=check@1 --accuracy-margin=1 \
  --log-loss-margin=100 --calibration-margin=1
show trainctl models promote arm@1
show tactus-stream --server="$TACTUS_SERVER" --driver=replay \
  --data="$work/check.h5" --parallel=8
show trainctl models rollback
show trainctl models history
served=$("$bin/trainctl" models alias --json | tr -d ' \n')
[[ $served == *'"model_version":"models/default/versions/1"'* ]] ||
  die "the rollback did not restore the version before: $served"
echo
echo "trained, promoted, streamed and rolled back"
