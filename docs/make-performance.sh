#!/usr/bin/env bash
# Writes docs/performance.md and the pictures in docs/performance/: what Tactus
# costs on this machine, beside its peers, and run time against error.
#
#   docs/make-performance.sh            a quarter of an hour on two quiet cores
#   docs/make-performance.sh --quick    only shows that it works
#
# The benchmarks served and fit-scale have pages in research/results/. Needs a release
# build, and PyTorch for the peer of the LSTM (apt-get install python3-torch).
set -euo pipefail
cd "$(dirname "${BASH_SOURCE[0]}")/.."

bench=build/release/bin/tactus-bench
out=docs/performance
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT
quick=()
if [[ ${1:-} == --quick ]]; then
  quick=(--quick)
elif ! /usr/bin/python3 -c 'import torch' && ! python3 -c 'import torch'; then
  echo "make-performance.sh: no PyTorch; install python3-torch" >&2
  exit 1
fi

# What fails, fails before the measurements.
tests/docs/performance_page_test.sh
"$bench" all "${quick[@]}" --except=frontier,served,fit-scale --json >"$work/all.json"
"$bench" frontier "${quick[@]}" --table="$work/frontier.csv" --figures="$out" \
  >"$work/frontier.txt"

{
  sed -n 's/^model name[^:]*: //p' /proc/cpuinfo | head -n 1
  nproc
  sed -n 's/^PRETTY_NAME="\(.*\)"/\1/p' /etc/os-release
  c++ --version | head -n 1
  "$bench" --version
} >"$work/machine.txt"
python3 -B docs/performance_page.py "$work/machine.txt" "$work/all.json" \
  "$work/frontier.csv" "${quick[@]}" >"$work/performance.md"
mv "$work/performance.md" docs/performance.md
