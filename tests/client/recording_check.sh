#!/usr/bin/env bash
# Records simulated contacts with tactus-stream and compares what npm's
# @mcap/core finds in the file, by its index and as a stream, with what our
# reader finds; replays it; and cuts the file at bytes of its last chunk.
#
#   tests/client/recording_check.sh BUILD_FOLDER
#
# Needs nodejs and npm; fetches @mcap/core and protobufjs to a temporary
# folder unless NODE_PATH holds them. Prints "skipped" without them.
set -euo pipefail
here=$(cd "$(dirname "${BASH_SOURCE[0]}")" && pwd)
bin=$1/bin
content=$1/tests/mcap_content
work=$(mktemp -d)
server=
stop() {
  if [[ -n $server ]]; then
    kill "$server" || true
    wait "$server" || true
  fi
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

stream --driver=sim --trials=4 --record="$work/a.mcap" >"$work/out"
grep recorded "$work/out"
"$content" "$work/a.mcap" >"$work/ours.json"
node "$here/mcap_peer.mjs" "$work/a.mcap" >"$work/theirs.json"
if ! cmp "$work/ours.json" "$work/theirs.json"; then
  cat "$work/ours.json" "$work/theirs.json"
  exit 1
fi

stream --driver=replay --data="$work/a.mcap" >"$work/out"
grep -E "^([0-9]+) of \1 posteriors equal the recording's$" "$work/out"

read -r begin end < <("$content" "$work/a.mcap" --last-chunk)
for size in "$begin" $((begin + 1)) $((begin + 9)) $(((begin + end) / 2)) \
  $((end - 1)) "$end"; do
  head -c "$size" "$work/a.mcap" >"$work/cut.mcap"
  ours=$("$content" "$work/cut.mcap" --cut)
  theirs=$(node "$here/mcap_peer.mjs" "$work/cut.mcap" --cut)
  if [[ $ours != "$theirs" ]]; then
    echo "cut at byte $size: $ours messages; @mcap/core reads $theirs"
    exit 1
  fi
done
echo "cut from byte $begin to byte $end: the same messages as @mcap/core"
