#!/usr/bin/env bash
# Builds the Python package: client/python/dist/tactus-VERSION-*.whl.
#
#   client/python/build.sh [FOLDER]        FOLDER instead of client/python/dist
#   client/python/build.sh --pure          without what needs compiling:
#                                          tactus.Classifier, and training in
#                                          this process
#   client/python/build.sh --native=BUILD  with the module of that build folder,
#                                          as it is
#   PYTHON=python3.12 client/python/build.sh
#
# Compiles the module tactus._native by the preset python, which takes some
# minutes the first time; the wheel is for one version of Python on one kind of
# machine. With --pure it is for all of them. The messages of proto/tactus/v1 are
# generated into the wheel: users need no protoc. Uses no network; needs the
# packages of deploy/install-deps.sh --python and, unless --pure, --build.
set -euo pipefail
native=""
pure=no
folder=$(dirname "${BASH_SOURCE[0]}")/dist
for arg in "$@"; do
  case "$arg" in
    --pure) pure=yes ;;
    --native=?*) native=${arg#--native=} ;;
    -h | --help) sed -n '2,/^set /{/^set /d;s/^# \{0,1\}//;p}' "$0"; exit 0 ;;
    -*) echo "build.sh: unknown option '$arg' (try --help)" >&2; exit 2 ;;
    *) folder=$arg ;;
  esac
done
if [[ $pure == yes && -n $native ]]; then
  echo "build.sh: --pure and --native=$native exclude each other" >&2
  exit 2
fi
folder=$(realpath -m "$folder")
native=${native:+$(realpath -m "$native")}
cd "$(dirname "${BASH_SOURCE[0]}")"
python=$(command -v "${PYTHON:-/usr/bin/python3}") || {
  echo "build.sh: there is no ${PYTHON:-/usr/bin/python3}" >&2
  exit 1
}
root=$(cd ../.. && pwd)

# Names the packages of `install-deps.sh GROUP` that are not installed.
missing_of() {
  command -v dpkg-query >/dev/null || return 0
  "$root/deploy/install-deps.sh" "$1" --list | while read -r package; do
    dpkg-query --show --showformat='${db:Status-Status}\n' "$package" \
      2>/dev/null | grep -qx installed || echo "$package"
  done
}

need() {
  local group lacking status=0
  for group in "$@"; do
    lacking=$(missing_of "$group" | tr '\n' ' ')
    [[ -z $lacking ]] || {
      echo "build.sh: these packages are missing, which deploy/install-deps.sh" \
        "$group installs: $lacking" >&2
      status=1
    }
  done
  return $status
}

if [[ $pure == no && -z $native ]]; then
  need --python --build
  native=$root/build/python
  if [[ $python != /usr/bin/python3 ]]; then
    native+=-$("$python" -c 'import sys; print("%d.%d" % sys.version_info[:2])')
  fi
  echo "build.sh: compiling what classifies and trains in ${native#"$root"/}" >&2
  # The wheel alone goes to the standard output.
  (cd "$root" && cmake --preset python -B "$native" \
    -D PYTHON_EXECUTABLE="$python" --log-level=WARNING &&
    cmake --build "$native" --parallel "$(nproc)" \
      --target tactus_python_native) >&2
fi
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
  suffix=$("$python" -c 'import sysconfig; print(sysconfig.get_config_var("EXT_SUFFIX"))')
  cp "$native/python/_native$suffix" "$work/src/tactus"
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
