#!/usr/bin/env bash
# A verb of one file and one line of a table works, is listed and is completed.
#
#   tests/contributing/own_verb_test.sh TRAINCTL
set -euo pipefail
trainctl=$1
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT

"$trainctl" simulate --protocol=random --contacts=4 --skin=good \
  --seed=1 --out="$work/contacts.h5" >/dev/null
[[ $("$trainctl" duration "$work/contacts.h5") =~ ^[0-9.]+\ s\ in\ 4\ trials$ ]]
"$trainctl" --help | grep -q '^  duration  *Print how long all trials are$'
"$trainctl" duration --help | grep -q '^  trainctl duration mine.h5$'
"$trainctl" completion bash | grep -q "'duration') choices="
