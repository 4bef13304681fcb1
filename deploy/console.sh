#!/usr/bin/env bash
# Shows in a browser what robots feel; on a fresh Debian 12 this is all it takes.
#
#   deploy/console.sh                a server with a small dataset, four simulated
#                                    robots, the console
#   deploy/console.sh --port=8080    at this port of this machine; 0: a free one
#   deploy/console.sh --robots=20    so many robots
#   deploy/console.sh --for=60       ends by itself after so many seconds
#   deploy/console.sh --bin=FOLDER   with programs that are built already
#
# Installs and builds what is missing, prints the console's address, and runs
# until Ctrl-C. Then it stops all that it started.
set -euo pipefail
cd "$(dirname "${BASH_SOURCE[0]}")/.."

port=8080
robots=4
seconds=infinity
bin=build/release/bin
build=yes
for arg in "$@"; do
  case "$arg" in
    --port=*) port=${arg#--port=} ;;
    --robots=*) robots=${arg#--robots=} ;;
    --for=*) seconds=${arg#--for=} ;;
    --bin=*) bin=${arg#--bin=} build=no ;;
    -h | --help) sed -n '2,/^set /{/^set /d;s/^# \{0,1\}//;p}' "$0"; exit 0 ;;
    *) echo "console.sh: unknown option '$arg' (try --help)" >&2; exit 2 ;;
  esac
done
for number in "$port" "$robots"; do
  if [[ ! $number =~ ^[0-9]+$ ]]; then
    echo "console.sh: '$number' is no number (try --help)" >&2
    exit 2
  fi
done

work=$(mktemp -d)
programs=()   # that we started, the last ones first

# shellcheck source=deploy/demo-parts.sh
. deploy/demo-parts.sh
clean_up() {
  stop_programs "${programs[@]}"
  rm -rf "$work"
}
trap clean_up EXIT
trap 'exit 0' INT TERM

if [[ $build == yes ]]; then
  build_programs console tactusd tactus-trainer tactus-stream trainctl \
    tactus-console console_page
fi

server=unix:$work/tactusd.sock
"$bin/tactusd" --listen="$server" --data-dir="$work/data" --keep-contacts=256M \
  >"$work/tactusd.log" 2>&1 &
programs=("$!")
await_file console "$work/tactusd.sock" "$!" "$work/tactusd.log"

# Trials to look at and to train on, of the robots' skin, and others by which a
# gate compares models.
upload() {  # NAME SEED TRIALS
  "$bin/trainctl" simulate --protocol=grid --skin=good --seed="$2" \
    --sample="$3" --out="$work/$1.h5" &&
    "$bin/trainctl" datasets create "$1" --server="$server" &&
    "$bin/trainctl" datasets upload "$1" --data="$work/$1.h5" \
      --server="$server"
}
{ upload demo 1 200 && upload held-out 2 60; } >"$work/trainctl.log" 2>&1 || {
  cat "$work/trainctl.log" >&2
  exit 1
}

# Each robot touches other things, one or two at once, until it is stopped.
for ((robot = 1; robot <= robots; ++robot)); do
  "$bin/tactus-stream" --server="$server" --driver=sim --rate=real \
    --client-id="arm-$robot" --seed="$robot" --objects=$((1 + robot % 2)) \
    --events --trials=1000000 >/dev/null 2>"$work/arm-$robot.log" &
  programs=("$!" "${programs[@]}")
done

"$bin/tactus-console" --server="$server" --listen="127.0.0.1:$port" &
programs=("$!" "${programs[@]}")
# In the background, so that Ctrl-C need not wait for it.
sleep "$seconds" &
programs=("$!" "${programs[@]}")
wait "$!"
