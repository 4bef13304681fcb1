#!/usr/bin/env bash
# Shows Tactus at work; on a fresh Debian 12 this is all it takes.
#
#   deploy/demo.sh                 two objects at once, as events; then simulated
#                                  contacts, a line for each, and what was felt,
#                                  answered and decided of each class
#   deploy/demo.sh --json          the contacts as one JSON object on stdout
#   deploy/demo.sh OPTION...       further options for tactus-stream
#
# Installs what is missing, builds tactusd and tactus-stream, starts tactusd on
# a free loopback port with the models it carries, streams contacts of robot
# conditions those models have not seen through it, as taxel frames in real
# time, and stops it. Exits with the status of tactus-stream. Once built it
# takes less than 30 s.
set -euo pipefail
cd "$(dirname "${BASH_SOURCE[0]}")/.."

readonly BIN=build/release/bin
readonly TRIALS=64
readonly ROBOTS=32   # side by side, so that real time does not take minutes
readonly SCENE=1007  # seed of two objects, of which the first slips late

if [[ ${1-} == -h || ${1-} == --help ]]; then
  sed -n '2,/^set /{/^set /d;s/^# \{0,1\}//;p}' "$0"
  exit 0
fi

work=$(mktemp -d)
server=""   # the tactusd that we started

# shellcheck source=deploy/demo-parts.sh
. deploy/demo-parts.sh
clean_up() {
  stop_programs ${server:+"$server"}
  rm -rf "$work"
}
trap clean_up EXIT

# Stdout may be one JSON object, so all but tactus-stream speaks on stderr.
build_programs demo tactusd tactus-stream
"$BIN/tactusd" --listen=127.0.0.1:0 --port-file="$work/port" \
  >"$work/tactusd.log" 2>&1 &
server=$!
await_file demo "$work/port" "$server" "$work/tactusd.log"

# stream OPTION...: simulated contacts in real time.
stream() {
  "$BIN/tactus-stream" --server="127.0.0.1:$(<"$work/port")" --driver=sim \
    --rate=real "$@" || {
    status=$?
    cat "$work/tactusd.log" >&2
    exit "$status"
  }
}
if [[ $# -eq 0 ]]; then
  echo "Two objects at once, as events:"
  stream --objects=2 --trials=1 --seed="$SCENE" --events
  printf '\n%s contacts, a line for each:\n' "$TRIALS"
fi
stream --trials="$TRIALS" --parallel="$ROBOTS" "$@"
