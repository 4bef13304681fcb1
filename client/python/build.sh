#!/usr/bin/env bash
# Builds the Python package: client/python/dist/tactus-VERSION-*.whl.
#
#   client/python/build.sh [FOLDER]        FOLDER instead of client/python/dist
#   client/python/build.sh --native        with tactus.Classifier, which needs
#                                          cmake --preset python &&
#                                          cmake --build --preset python before
#   client/python/build.sh --native=BUILD  of that build folder
#   PYTHON=python3.12 client/python/build.sh
#
# The messages of proto/tactus/v1 are generated into the wheel: users need no
# protoc. Uses no network; needs the packages of deploy/install-deps.sh --python.
# Without --native, the wheel is for all versions of Python and all machines.
set -euo pipefail
native=""
folder=$(dirname "${BASH_SOURCE[0]}")/dist
for arg in "$@"; do
  case "$arg" in
    --native) native=$(dirname "${BASH_SOURCE[0]}")/../../build/python ;;
    --native=?*) native=${arg#--native=} ;;
    -h | --help) sed -n '2,/^set /{/^set /d;s/^# \{0,1\}//;p}' "$0"; exit 0 ;;
    -*) echo "build.sh: unknown option '$arg' (try --help)" >&2; exit 2 ;;
    *) folder=$arg ;;
  esac
done
folder=$(realpath -m "$folder")
native=${native:+$(realpath -m "$native")}
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
if [[ -n $native ]]; then
  cp "$native"/python/_native.*.so "$work/src/tactus"
  # What says that the wheel is for one version of Python and one machine.
  cat >"$work/setup.py" <<'PYTHON'
from setuptools import Distribution, setup


class NativeDistribution(Distribution):
    def has_ext_modules(self):
        return True


setup(distclass=NativeDistribution)
PYTHON
fi

rm -f "$folder"/tactus-*.whl
"$python" -m build --wheel --no-isolation --outdir "$folder" "$work" \
  >"$work/log" 2>&1 || {
  cat "$work/log" >&2
  exit 1
}
ls "$folder"/tactus-*.whl
