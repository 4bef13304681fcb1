#!/usr/bin/env bash
# The example with three patches: builds it against an installed Tactus::client
# and Tactus::drivers, and runs it against tactusd. Each patch must report its
# two touches.
#
#   tests/examples/three_patches_test.sh BUILD_DIR [CMAKE OPTION...]
set -euo pipefail
cd "$(dirname "${BASH_SOURCE[0]}")/../.."

build=$1
shift
work=$build/three_patches
rm -rf "$work"
mkdir -p "$work"
for component in base client drivers; do
  cmake --install "$build" --component "$component" --prefix "$work/prefix" \
    >/dev/null
done
cmake -S examples/three_patches -B "$work/build" -G Ninja \
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
"$work/build/three_patches" "127.0.0.1:$(cat "$work/port")" >"$work/out.txt"
cat "$work/out.txt"
for patch in palm forearm shoulder; do
  for event in touched released; do
    [[ $(grep -c "^$patch: .* $event\$" "$work/out.txt") -ge 2 ]]
  done
  grep -q "^$patch: .* decided hardness: " "$work/out.txt"
done
