#!/usr/bin/env bash
# Six robots of one program stream through HAProxy to three servers, of which
# one hangs for eight seconds. HAProxy read no more of their connection once a
# stream to that server had filled its buffer, so the robots of the other
# servers stood still too, and some failed (deploy/haproxy.cfg,
# tune.h2.initial-window-size).
#
#   tests/regress/halted_server_test.sh BIN    programs in BIN; about 25 s
#
# Exits with 77 if HAProxy is not installed.
set -euo pipefail
cd "$(dirname "${BASH_SOURCE[0]}")/../.."

bin=${1:-build/release/bin}
command -v haproxy >/dev/null || { echo "halt: haproxy is not installed"; exit 77; }
work=$(mktemp -d /tmp/tactus-halt.XXXXXX)
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
# Ports that other tests do not use, and that no outgoing connection gets.
base_port=$((15000 + $$ % 1000 * 4)) proxy_port=$((base_port))

server=()
for number in 1 2 3; do
  "$bin/tactusd" --listen="127.0.0.1:$((base_port + number))" \
    --listen="unix:$work/$number.sock" >"$work/server-$number.log" 2>&1 &
  server[number]=$!
  programs=("$!" "${programs[@]}")
  await_file halt "$work/$number.sock" "$!" "$work/server-$number.log"
done
start_proxy 3
# robots NAME SERVER [FLAGS...]: six robots, of two contacts each.
robots() {
  "$bin/tactus-stream" --server="$2" --driver=sim --trials=12 --seed=5 \
    --parallel=6 --posteriors="$work/$1" "${@:3}" >"$work/robots-$1.log" 2>&1
}
streams() { cat "$work"/server-*.log | grep -c 'began:' || true; }
for ((i = 0; i < 100; ++i)); do
  ! robots wait "127.0.0.1:$proxy_port" --rate=max || break
  sleep 0.1
done
begun=$(streams)
robots halted "127.0.0.1:$proxy_port" --rate=real &
halted=$!
until [[ $(streams) -ge $((begun + 6)) ]]; do sleep 0.05; done
sleep 1
kill -STOP "${server[3]}"
sleep 8
kill -CONT "${server[3]}"
wait "$halted"
cmp "$work/wait" "$work/halted"
echo "halt: six robots have the same answers though a server hung for 8 s"
