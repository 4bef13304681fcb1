#!/usr/bin/env bash
# The example without a server, as docs/your-first-client.md shows it: builds it
# against an installed Tactus::classifier and classifies simulated contacts. A server
# must give the same posteriors, bit for bit.
#
#   tests/examples/in_process_test.sh BUILD_DIR [CMAKE OPTION...]
set -euo pipefail
cd "$(dirname "${BASH_SOURCE[0]}")/../.."

build=$1
shift
work=$build/in_process
rm -rf "$work"
mkdir -p "$work"

for component in base classifier drivers; do
  cmake --install "$build" --component "$component" --prefix "$work/prefix" \
    >/dev/null
done
cmake -S examples/in_process -B "$work/build" -G Ninja \
  -DCMAKE_PREFIX_PATH="$work/prefix" "$@" >/dev/null
cmake --build "$work/build" >/dev/null

"$build/bin/trainctl" simulate --protocol=random --contacts=8 --skin=good \
  --seed=3 --out="$work/contacts.h5" >/dev/null
"$work/build/in_process" server/registry/default.tactus \
  "$work/contacts.h5" >"$work/here.txt"

"$build/bin/tactusd" --listen=127.0.0.1:0 --port-file="$work/port" \
  --log-level=warn &
server=$!
trap 'kill "$server"' EXIT
for ((i = 0; i < 600; i++)); do
  [[ -s $work/port ]] && break
  sleep 0.1
done
"$build/bin/tactus-stream" --server="127.0.0.1:$(cat "$work/port")" \
  --driver=replay --data="$work/contacts.h5" \
  --posteriors="$work/posteriors.jsonl" >/dev/null

# {"trial":"000000","probability":[P,...],...} as: 000000 P ...
sed -E 's/.*"trial":"([^"]*)","probability":\[([^]]*)\].*/\1 \2/; s/,/ /g' \
  "$work/posteriors.jsonl" >"$work/there.txt"
cat "$work/here.txt"
diff "$work/here.txt" "$work/there.txt"
[[ $(grep -Ec '^[0-9]{6}( [0-9.e-]+){4}$' "$work/here.txt") -eq 8 ]]
