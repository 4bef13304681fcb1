#!/usr/bin/env bash
# Records simulated contacts with tactus-stream and compares what npm's
# @mcap/core finds in the file, by its index and as a stream, with what our
# reader finds; replays it; and cuts the file at bytes of its last chunk. Then
# the same with a skin on a serial line, of which loads and raw frames are
# recorded; this is left out without python3.
#
#   tests/tools/stream/recording_check.sh BUILD_FOLDER
#
# Needs nodejs and npm; fetches @mcap/core and protobufjs to a temporary
# folder unless NODE_PATH holds them. Prints "skipped" without them.
set -euo pipefail
here=$(cd "$(dirname "${BASH_SOURCE[0]}")" && pwd)
bin=$1/bin
content=$1/tests/mcap_content
work=$(mktemp -d)
server=
skin=
stop() {
  for process in $server $skin; do
    kill "$process" || true
    wait "$process" || true
  done
  rm -rf "$work"
}
trap stop EXIT

for program in node npm; do
  if ! command -v "$program" >/dev/null; then
    echo "recording_check: skipped, needs $program"
    exit 0
  fi
done
if [[ ! -d ${NODE_PATH-}/@mcap/core || ! -d ${NODE_PATH-}/protobufjs ]]; then
  if ! (cd "$work" && npm install --ignore-scripts --no-audit --no-fund \
    --fetch-retries=0 --fetch-timeout=30000 \
    --prefix "$work/npm" @mcap/core@2 protobufjs@7 >"$work/npm.log" 2>&1); then
    echo "recording_check: skipped, npm cannot fetch its packages"
    exit 0
  fi
  export NODE_PATH=$work/npm/node_modules
fi

"$bin/tactusd" --listen="unix:$work/socket" >"$work/log" 2>&1 &
server=$!
for _ in $(seq 200); do
  [[ -S $work/socket ]] && break
  sleep 0.1
done
stream() { "$bin/tactus-stream" --server="unix:$work/socket" "$@"; }

# compare FILE: what both readers find in it, its replay, and cut files.
compare() {
  "$content" "$1" >"$work/ours.json"
  node "$here/mcap_peer.mjs" "$1" >"$work/theirs.json"
  if ! cmp "$work/ours.json" "$work/theirs.json"; then
    cat "$work/ours.json" "$work/theirs.json"
    exit 1
  fi

  stream --driver=replay --data="$1" >"$work/out"
  grep -E "^([0-9]+) of \1 answers equal the recording's$" "$work/out"

  read -r begin end < <("$content" "$1" --last-chunk)
  for size in "$begin" $((begin + 1)) $((begin + 9)) $(((begin + end) / 2)) \
    $((end - 1)) "$end"; do
    head -c "$size" "$1" >"$work/cut.mcap"
    ours=$("$content" "$work/cut.mcap" --cut)
    theirs=$(node "$here/mcap_peer.mjs" "$work/cut.mcap" --cut)
    if [[ $ours != "$theirs" ]]; then
      echo "cut at byte $size: $ours messages; @mcap/core reads $theirs"
      exit 1
    fi
  done
  echo "cut from byte $begin to byte $end: the same messages as @mcap/core"
}

stream --driver=sim --trials=4 --record="$work/a.mcap" >"$work/out"
grep recorded "$work/out"
compare "$work/a.mcap"

if ! command -v python3 >/dev/null; then
  echo "a skin on a serial line: left out, needs python3"
  exit 0
fi
# Untouched for 3 s, then touched for half of each second.
python3 - "$work/skin" <<'PYTHON' &
import os, sys, time, tty
master, slave = os.openpty()
tty.setraw(slave)
os.set_blocking(master, False)
os.symlink(os.ttyname(slave), sys.argv[1])
begin = time.monotonic()
for frame in range(100_000):
    time.sleep(max(0, begin + frame / 100 - time.monotonic()))
    touched = frame > 300 and frame % 100 < 50
    values = bytearray(20 + i % 5 for i in range(384))
    for i in (100, 101, 124, 125):
        values[i] += 150 * touched
    try:
        os.write(master, b"\xaa\x55" + values)
    except BlockingIOError:
        pass
PYTHON
skin=$!
for _ in $(seq 200); do
  [[ -e $work/skin ]] && break
  sleep 0.1
done
echo '{"layout": "cody-forearm"}' >"$work/cody.json"
stream --driver=serial --port="$work/skin" --format=aa55 --rate-hz=100 \
  --layout="$work/cody.json" --scale=0.01 --device-id=palm --tare=20 \
  --model=models/no-poses --seconds=6 --label=HU --record="$work/b.mcap" \
  >"$work/out"
"$content" "$work/b.mcap" >"$work/ours.json"
grep -q '"/skin/raw"' "$work/ours.json"
compare "$work/b.mcap"
