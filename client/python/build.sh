#!/usr/bin/env bash
# Builds the Python package: client/python/dist/tactus-VERSION-py3-none-any.whl.
#
#   client/python/build.sh [FOLDER]      FOLDER instead of client/python/dist
#   PYTHON=python3.12 client/python/build.sh
#
# The messages of proto/tactus/v1 are generated into the wheel: users need no
# protoc. Uses no network; needs the packages of deploy/install-deps.sh --python.
set -euo pipefail
folder=$(realpath -m "${1:-$(dirname "${BASH_SOURCE[0]}")/dist}")
cd "$(dirname "${BASH_SOURCE[0]}")"
python=${PYTHON:-/usr/bin/python3}
root=$(cd ../.. && pwd)
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT

cp -r pyproject.toml README.md src "$work"
find "$work" -name __pycache__ -prune -exec rm -rf {} +
protos=()
for name in admin common contact contact_log models monitor operations training \
  trial; do
  protos+=("tactus/v1/$name.proto")
done
protoc --proto_path="$root/proto" --python_out="$work/src" \
  --pyi_out="$work/src" --grpc_python_out="$work/src" \
  --plugin=protoc-gen-grpc_python="$(command -v grpc_python_plugin)" \
  "${protos[@]}"

rm -f "$folder"/tactus-*.whl
"$python" -m build --wheel --no-isolation --outdir "$folder" "$work" \
  >"$work/log" 2>&1 || {
  cat "$work/log" >&2
  exit 1
}
ls "$folder"/tactus-*.whl
