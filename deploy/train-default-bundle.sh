#!/usr/bin/env bash
# Trains the bundle that tactusd carries: the paper's 1,835 trials, rendered as
# taxel frames of the cody-forearm skin and taken through the feature path.
#
#   deploy/train-default-bundle.sh           writes server/registry/default.tactus
#   deploy/train-default-bundle.sh --check   trains elsewhere and fails unless
#                                            the committed bundle comes out
#
# Needs a release build of trainctl. Takes some minutes on two cores.
set -euo pipefail
cd "$(dirname "${BASH_SOURCE[0]}")/.."

readonly BUNDLE=server/registry/default.tactus
trainctl=$PWD/build/release/bin/trainctl
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT

# Relative names: the command line becomes part of the bundle.
(
  cd "$work"
  "$trainctl" simulate --protocol=paper --goal=0.019 --sensor=taxels --seed=1 \
    --out=paper-taxels.h5
  "$trainctl" fit --data=paper-taxels.h5 --preset=tuned --features=f,m,a \
    --seed=1 --out=default.tactus \
    --note="paper's simulated trials as taxel frames, goal 0.019 m"
)
if [[ ${1-} == --check ]]; then
  cmp "$work/default.tactus" "$BUNDLE"
  echo "the committed bundle comes out, byte for byte"
else
  mv "$work/default.tactus" "$BUNDLE"
fi
