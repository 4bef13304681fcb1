#!/usr/bin/env bash
# One training by one process and by several ranks, with one catalogue and
# another: prints the SHA-256 of each bundle, and exits 1 if they differ.
#
#   tests/cluster/ranks.sh [--sample=N] [--epochs=N] [--shards=N] BIN
#
#   --sample=N   trials of the training (240)
#   --epochs=N   epochs of each network (6)
#   --shards=N   shards of each batch (4); with 1, ranks share out whole networks
#
# The times are for comparison with each other: everything runs on this machine.
# Exits with 77 without MPI. tests/cluster/run.sh --ranks runs this.
set -euo pipefail
cd "$(dirname "${BASH_SOURCE[0]}")/../.."

bin=build/release/bin sample=240 epochs=6 shards=4
for arg in "$@"; do
  case "$arg" in
    --sample=*) sample=${arg#*=} ;;
    --epochs=*) epochs=${arg#*=} ;;
    --shards=*) shards=${arg#*=} ;;
    -h | --help) sed -n '2,/^set /{/^set /d;s/^# \{0,1\}//;p}' "$0"; exit 0 ;;
    -*) echo "ranks: unknown option '$arg' (try --help)" >&2; exit 2 ;;
    *) bin=$arg ;;
  esac
done
if ! command -v mpirun >/dev/null || [[ ! -x $bin/tactus-trainer-mpi ]]; then
  echo "ranks: mpirun or $bin/tactus-trainer-mpi is missing"
  exit 77
fi

work=$(mktemp -d /tmp/tactus-ranks.XXXXXX)
programs=()
# shellcheck source=deploy/demo-parts.sh
. deploy/demo-parts.sh
# shellcheck source=deploy/cluster-parts.sh
. deploy/cluster-parts.sh
clean_up() {
  local status=$?
  stop_programs "${programs[@]}"
  [[ $status -eq 0 ]] || tail -n 20 "$work"/*.log >&2
  rm -rf "$work"
}
trap clean_up EXIT
field() { /usr/bin/python3 -c 'import json, sys
print(json.load(sys.stdin)[sys.argv[1]])' "$1"; }
# mpirun does not run for root unless both are set.
export OMPI_ALLOW_RUN_AS_ROOT=1 OMPI_ALLOW_RUN_AS_ROOT_CONFIRM=1
# Ports that other tests do not use, and that no outgoing connection gets.
# shellcheck disable=SC2034
base_port=$((19000 + $$ % 500 * 8))

# start_server FLAGS...: a server at unix:$work/server.sock. Its process is
# $server.
start_server() {
  rm -f "$work/server.sock"
  "$bin/tactusd" --listen="unix:$work/server.sock" "$@" >>"$work/server.log" 2>&1 &
  server=$!
  programs=("$server")
  await_file ranks "$work/server.sock" "$server" "$work/server.log"
}
stop_server() {
  stop_programs "$server"
  programs=()
}
at=--server=unix:$work/server.sock
upload() {
  "$bin/trainctl" datasets create skin "$at" >/dev/null
  "$bin/trainctl" datasets upload skin --data="$work/trials.h5" "$at" >/dev/null 2>&1
}
wanted=""
different=0
# train NAME: prints the line of a training at the running server.
train() {
  local begin end sha256
  begin=$(date +%s%N)
  "$bin/trainctl" train --dataset=skin --model=skin --preset=tuned \
    --epochs="$epochs" --hmms-per-class=4 --skip-unusable --seed=3 \
    --gradient-shards="$shards" "$at" >"$work/train.log" 2>&1 || {
    cat "$work/train.log" >&2
    exit 1
  }
  end=$(date +%s%N)
  sha256=$("$bin/trainctl" models show skin@1 --json "$at" | field sha256)
  printf '%-34s %s  %6.1f s\n' "$1" "$sha256" \
    "$(((end - begin) / 100000000))e-1"
  : "${wanted:=$sha256}"
  [[ $sha256 == "$wanted" ]] || different=1
}

"$bin/trainctl" simulate --protocol=grid --skin=good --sample="$sample" --seed=1 \
  --out="$work/trials.h5" >/dev/null 2>&1
start_server --data-dir="$work/data"
upload
stop_server

for threads in 1 2; do
  for ranks in 1 2 3 4; do
    cp -r "$work/data" "$work/copy"
    start_server --data-dir="$work/copy" --job-ranks="$ranks" \
      --job-threads="$threads"
    train "$ranks ranks, $threads threads, SQLite"
    stop_server
    rm -rf "$work/copy"
  done
done

if [[ -x $POSTGRES/initdb ]]; then
  make_postgres
  start_postgres
  start_server --catalog="$catalog" --blobs="$work/shared" --job-ranks=2 \
    --job-threads=1
  programs+=("$postgres")
  upload
  train "2 ranks, 1 threads, PostgreSQL"
fi
if [[ $different -ne 0 ]]; then
  echo "ranks: the bundles differ" >&2
  exit 1
fi
echo "all bundles are the same"
