#!/usr/bin/env bash
# Writes docs/performance.md and the pictures in docs/performance/: what Tactus
# costs on this machine, beside its peers, and run time against error.
#
#   docs/make-performance.sh            some ten minutes on two quiet cores
#   docs/make-performance.sh --quick    only shows that it works
#
# The benchmarks served and fit-scale have pages in docs/results/. Needs a release
# build.
set -euo pipefail
cd "$(dirname "${BASH_SOURCE[0]}")/.."

bench=build/release/bin/tactus-bench
out=docs/performance
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT
quick=()
[[ ${1:-} != --quick ]] || quick=(--quick)

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
