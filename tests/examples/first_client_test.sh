#!/usr/bin/env bash
# docs/your-first-client.md, step by step: installs Tactus::client, builds the
# C++ example against it, generates Python stubs, and runs both clients against
# tactusd. Both must print the same answer.
#
#   tests/examples/first_client_test.sh BUILD_DIR [CMAKE OPTION...]
set -euo pipefail
cd "$(dirname "${BASH_SOURCE[0]}")/../.."

build=$1
shift
work=$build/first_client
rm -rf "$work"
mkdir -p "$work/stubs"

for component in base client; do
  cmake --install "$build" --component "$component" --prefix "$work/prefix" \
    >/dev/null
done
cmake -S examples/first_client -B "$work/build" -G Ninja \
  -DCMAKE_PREFIX_PATH="$work/prefix" "$@" >/dev/null
cmake --build "$work/build" >/dev/null

protoc --proto_path="$work/prefix/share/tactus/proto" \
  --python_out="$work/stubs" --grpc_python_out="$work/stubs" \
  --plugin=protoc-gen-grpc_python="$(command -v grpc_python_plugin)" \
  tactus/v1/common.proto tactus/v1/contact.proto

"$build/bin/tactusd" --listen=127.0.0.1:0 --port-file="$work/port" \
  --log-level=warn &
server=$!
trap 'kill "$server"' EXIT
for ((i = 0; i < 600; i++)); do
  [[ -s $work/port ]] && break
  sleep 0.1
done
address=127.0.0.1:$(cat "$work/port")

"$work/build/first_client" "$address" >"$work/cc.txt"
PYTHONPATH="$work/stubs" /usr/bin/python3 \
  examples/first_client/first_client.py "$address" >"$work/py.txt"
cat "$work/cc.txt"
diff "$work/cc.txt" "$work/py.txt"
grep -q ': contact 1 touched$' "$work/cc.txt"
[[ $(grep -cE '^(hardness|mobility): [a-z]+ [01]\.[0-9]*$' "$work/cc.txt") -eq 4 ]]

# Only the public headers, which need no other ones.
diff <(cd client/include && find tactus -name '*.h' | sort) \
  <(cd "$work/prefix/include" && find . -name '*.h' | sed 's|^\./||' | sort)
