#!/usr/bin/env bash
# Loads one, two and three servers of one catalogue, and three behind HAProxy:
# measured cases of research/capacity.py, as CSV.
#
#   research/replica_load.sh [--runs=N] [--robots=N] BIN >replica_load.csv
#
#   --runs=N     runs of each case, of which the least counts (3)
#   --robots=N   robots of each case (200)
#
# Servers, proxy and robots share this machine. Processor time is that of all
# servers or of the proxy, for each message; bytes are those of the loopback
# device, both ways and all hops. Needs PostgreSQL and HAProxy.
set -euo pipefail
cd "$(dirname "${BASH_SOURCE[0]}")/.."

bin=build/release/bin runs=3 robots=200
for arg in "$@"; do
  case "$arg" in
    --runs=*) runs=${arg#*=} ;;
    --robots=*) robots=${arg#*=} ;;
    -h | --help) sed -n '2,/^set /{/^set /d;s/^# \{0,1\}//;p}' "$0"; exit 0 ;;
    -*) echo "replica_load: unknown option '$arg' (try --help)" >&2; exit 2 ;;
    *) bin=$arg ;;
  esac
done

work=$(mktemp -d /tmp/tactus-load.XXXXXX)
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
# Ports that other tests do not use. The proxy's is $proxy_port.
# shellcheck disable=SC2034
base_port=$((27000 + $$ % 500 * 8)) proxy_port=$((27000 + $$ % 500 * 8))

# ticks PID...: their processor time, in hundredths of a second.
ticks() {
  local pid sum=0
  for pid in "$@"; do
    sum=$((sum + $(awk '{ print $14 + $15 }' "/proc/$pid/stat")))
  done
  echo "$sum"
}
loopback() { awk '$1 == "lo:" { print $2 }' /proc/net/dev; }
# measure NAME SERVERS ADDRESSES FRAMES CADENCE: prints one line of CSV.
measure() {
  local run ran=() pid
  for ((number = 1; number <= $2; ++number)); do ran+=("${replica[$number]}"); done
  for ((run = 0; run < runs; ++run)); do
    local servers proxies=0 bytes
    servers=$(ticks "${ran[@]}")
    pid=${proxy:-0}
    [[ $pid -eq 0 ]] || proxies=$(ticks "$pid")
    bytes=$(loopback)
    "$bin/tactus-load" --server="$3" --robots="$robots" --rate=100 --seconds=8 \
      --frames-per-message="$4" --cadence="$5" --connections=$((8 * $2)) \
      --json >"$work/load.json" 2>/dev/null || true
    servers=$(($(ticks "${ran[@]}") - servers))
    [[ $pid -eq 0 ]] || proxies=$(($(ticks "$pid") - proxies))
    bytes=$(($(loopback) - bytes))
    echo "$servers $proxies $bytes" >>"$work/$1-$2-$4-$5"
    cp "$work/load.json" "$work/$1-$2-$4-$5.$run"
  done
  /usr/bin/python3 - "$1" "$2" "$4" "$5" "$robots" "$work/$1-$2-$4-$5" <<'PYTHON'
import json, sys
name, servers, frames, cadence, robots, path = sys.argv[1:]
rows = []
for run, line in enumerate(open(path)):
    load = json.load(open(f"{path}.{run}"))
    server, proxy, size = (int(value) for value in line.split())
    sent = load["sent"]
    rows.append((1e4 * server / sent, 1e4 * proxy / sent, size / sent,
                 load["p50_ms"], load["p99_ms"]))
print(",".join([name, servers, robots, frames, cadence] +
               [f"{min(row[column] for row in rows):.4g}" for column in range(5)]))
PYTHON
}

make_postgres
start_postgres
echo case,servers,robots,frames,cadence,server_us,proxy_us,bytes,p50_ms,p99_ms
addresses=""
for servers in 1 2 3; do
  start_replica "$servers" --jobs=none
  addresses+="${addresses:+,}127.0.0.1:$((base_port + servers))"
  for frames in 1 4; do
    measure direct "$servers" "$addresses" "$frames" every-frame
  done
  measure direct "$servers" "$addresses" 1 events
done
start_proxy 3
sleep 1.5
for frames in 1 4; do
  measure proxied 3 "127.0.0.1:$proxy_port" "$frames" every-frame
done
measure proxied 3 "127.0.0.1:$proxy_port" 1 events
