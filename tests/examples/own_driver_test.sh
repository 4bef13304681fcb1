#!/usr/bin/env bash
# docs/drivers.md, "A driver of your own": builds the example outside of the tree
# against the installed headers and streams it with tactus-stream. What is
# no driver, or lacks an option, is refused with what would be right.
#
#   tests/examples/own_driver_test.sh BUILD_DIR [CMAKE OPTION...]
set -euo pipefail
cd "$(dirname "${BASH_SOURCE[0]}")/../.."

build=$1
shift
work=$build/own_driver
rm -rf "$work"
mkdir -p "$work"
cmake --install "$build" --component base --prefix "$work/prefix" >/dev/null
cmake -S examples/own_driver -B "$work/build" -G Ninja \
  -DCMAKE_PREFIX_PATH="$work/prefix" "$@" >/dev/null
cmake --build "$work/build" >/dev/null

"$build/bin/tactusd" --listen=127.0.0.1:0 --port-file="$work/port" \
  --log-level=warn &
server=$!
trap 'kill "$server"' EXIT
for ((i = 0; i < 600; i++)); do
  [[ -s $work/port ]] && break
  sleep 0.1
done
stream() {
  "$build/bin/tactus-stream" --server="127.0.0.1:$(cat "$work/port")" "$@"
}
fail() { echo "own_driver_test: $1" >&2; exit 1; }
refused() {
  ! stream "${@:2}" >"$work/out.txt" 2>&1 || fail "took $2"
  grep -q "$1" "$work/out.txt" || fail "did not say $1: $(cat "$work/out.txt")"
}

stream --driver="$work/build/my_skin.so" --driver-option=steps=100 --json \
  >"$work/out.json"
grep -Eq '"frames": *100' "$work/out.json" ||
  fail "the frames are missing: $(cat "$work/out.json")"
refused 'steps=N is missing' --driver="$work/build/my_skin.so"
refused 'TACTUS_DRIVER' --driver="$work/build/none.so"
# A library that is none of ours.
refused 'makes no driver' --driver="$(find /usr/lib -name 'libz.so' | head -n 1)"
refused 'absent without a driver' --driver=sim --driver-option=a=b
