#!/usr/bin/env bash
# Times trainings of several ranks on this machine, as CSV for rank_cost.py:
# contacts, shards, epochs, ranks, and the least of the runs, in seconds: time
# from the start of the job to its end, and processor time of all its processes.
#
#   research/rank_times.sh [--runs=N] [--small=N] [--large=N] BIN >rank_times.csv
#
#   --runs=N    runs of each training (3)
#   --small=N   contacts of the small training (1000)
#   --large=N   contacts of the large training (16000)
#
# Needs MPI. Each rank has one thread.
set -euo pipefail
cd "$(dirname "${BASH_SOURCE[0]}")/.."

bin=build/release/bin runs=3 small=1000 large=16000
for arg in "$@"; do
  case "$arg" in
    --runs=*) runs=${arg#*=} ;;
    --small=*) small=${arg#*=} ;;
    --large=*) large=${arg#*=} ;;
    -h | --help) sed -n '2,/^set /{/^set /d;s/^# \{0,1\}//;p}' "$0"; exit 0 ;;
    -*) echo "rank_times: unknown option '$arg' (try --help)" >&2; exit 2 ;;
    *) bin=$arg ;;
  esac
done

# A unix socket's path is short.
work=$(mktemp -d /tmp/tactus-times.XXXXXX)
programs=()
# shellcheck source=deploy/demo-parts.sh
. deploy/demo-parts.sh
clean_up() {
  local status=$?
  stop_programs "${programs[@]}"
  [[ $status -eq 0 ]] || tail -n 20 "$work"/*.log >&2
  rm -rf "$work"
}
trap clean_up EXIT
# mpirun does not run for root unless both are set.
export OMPI_ALLOW_RUN_AS_ROOT=1 OMPI_ALLOW_RUN_AS_ROOT_CONFIRM=1
at=--server=unix:$work/server.sock
start_server() {
  rm -f "$work/server.sock"
  "$bin/tactusd" --listen="unix:$work/server.sock" --data-dir="$work/data" \
    --job-threads=1 --job-ranks="$1" >>"$work/server.log" 2>&1 &
  server=$!
  programs=("$server")
  await_file rank_times "$work/server.sock" "$server" "$work/server.log"
}
# Processor time of the server's children that have ended, and of theirs, in
# hundredths of a second.
children_took() { awk '{ print $16 + $17 }' "/proc/$server/stat"; }
# time_job CONTACTS SHARDS EPOCHS: one training; sets $took and $processor.
time_job() {
  local before
  before=$(children_took)
  "$bin/trainctl" train --dataset="d$1" --model=m --preset=world --seed=3 \
    --epochs="$3" --gradient-shards="$2" --skip-unusable "$at" \
    >"$work/train.log" 2>&1
  took=$("$bin/trainctl" jobs list --json "$at" | /usr/bin/python3 -c 'import json, sys
jobs = json.load(sys.stdin)
newest = jobs[0]
print((int(newest["end_time_ms"]) - int(newest["start_time_ms"])) / 1000)')
  # The server waits for the process a moment after the job has ended.
  sleep 0.2
  processor=$(awk -v ticks="$(($(children_took) - before))" \
    'BEGIN { print ticks / 100 }')
}
least_of() { printf '%s\n' "$@" | sort -g | head -n 1; }

start_server 1
for contacts in "$small" "$large"; do
  "$bin/trainctl" simulate --protocol=grid --sample="$contacts" --seed=1 \
    --out="$work/trials.h5" >/dev/null 2>&1
  "$bin/trainctl" datasets create "d$contacts" "$at" >/dev/null
  "$bin/trainctl" datasets upload "d$contacts" --data="$work/trials.h5" "$at" \
    >/dev/null 2>&1
done
rm "$work/trials.h5"
stop_programs "${programs[@]}"

declare -A least least_processor
for ((run = 0; run < runs; ++run)); do
  for ranks in 1 2 3 4; do
    start_server "$ranks"
    for job in "$small 1 4" "$small 2 1" "$small 8 1" "$small 8 4" "$small 32 4" \
      "$large 8 1" "$large 8 4"; do
      read -r contacts shards epochs <<<"$job"
      time_job "$contacts" "$shards" "$epochs"
      key="$contacts,$shards,$epochs,$ranks"
      least[$key]=$(least_of "$took" "${least[$key]:-$took}")
      least_processor[$key]=$(least_of "$processor" \
        "${least_processor[$key]:-$processor}")
      echo "$key,$took,$processor" >&2
    done
    stop_programs "${programs[@]}"
  done
done
echo contacts,shards,epochs,ranks,seconds,processor_seconds
for key in "${!least[@]}"; do
  echo "$key,${least[$key]},${least_processor[$key]}"
done |
  sort -t, -n -k1,1 -k2,2 -k3,3 -k4,4
