#!/usr/bin/env bash
# Tests the Python package as its users get it: builds the wheel, installs it in
# an empty environment, and runs the tests against the programs of a build.
#
#   client/python/tests/run.sh build/release/bin              all tests
#   client/python/tests/run.sh build/release/bin stream_test  those of a file
#   TACTUS_PYTHON_NATIVE=yes client/python/tests/run.sh ...
#
# Of build.sh --pure, which compiles nothing; TACTUS_PYTHON_NATIVE=yes: of
# build.sh as users call it.
set -euo pipefail
TACTUS_BIN=$(realpath "$1")
export TACTUS_BIN
shift
python=/usr/bin/python3
tests=$(dirname "$(realpath "${BASH_SOURCE[0]}")")
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT

kind=(--pure)
[[ ${TACTUS_PYTHON_NATIVE:-no} != yes ]] || kind=()
"$tests/../build.sh" "${kind[@]}" "$work/dist" >/dev/null
# The environment has Debian's numpy and grpcio, and nothing else of ours.
"$python" -m venv --system-site-packages "$work/venv"
"$work/venv/bin/python" -m pip --quiet install --no-index --no-deps \
  --disable-pip-version-check "$work"/dist/tactus-*.whl
cd "$work"
if [[ $# -eq 0 ]]; then
  set -- discover --start-directory "$tests" --pattern '*_test.py'
fi
PYTHONPATH=$tests "$work/venv/bin/python" -B -m unittest "$@"
