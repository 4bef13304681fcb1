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

# shellcheck source=deploy/demo-parts.sh
. deploy/demo-parts.sh
clean_up() {
  stop_programs ${server:+"$server"}
  rm -rf "$work"
}
trap clean_up EXIT

if [[ $build == yes ]]; then
  build_programs train-demo tactusd tactus-trainer trainctl tactus-stream
fi

export TACTUS_SERVER=unix:$work/tactusd.sock
"$bin/tactusd" --listen="$TACTUS_SERVER" --data-dir="$work/data" \
  >"$work/tactusd.log" 2>&1 &
server=$!
await_file train-demo "$work/tactusd.sock" "$server" "$work/tactusd.log"

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
[[ $served == *'"model_version":"models/default/versions/1"'* ]] || {
  echo "train-demo: the version before did not come back: $served" >&2
  exit 1
}
echo
echo "trained, promoted, streamed and rolled back"
