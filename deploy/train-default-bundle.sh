#!/usr/bin/env bash
# Trains the bundles that tactusd carries, on contacts of the random world
# (docs/simulator.md) and the skins good and measured: 300,000 with poses of the
# arm, 150,000 without. In 0.3 of them the arm lifts off.
#
#   deploy/train-default-bundle.sh           writes server/registry/*.tactus
#   deploy/train-default-bundle.sh --check   trains elsewhere and fails unless
#                                            the committed bundles come out
#
# Needs a release build of trainctl, 8 GB of memory, and about 20 minutes on two
# cores.
set -euo pipefail
cd "$(dirname "${BASH_SOURCE[0]}")/.."

readonly BUNDLES=server/registry
trainctl=$PWD/build/release/bin/trainctl
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT

# fit NAME RECIPE NOTE: relative names, because the command line becomes part of
# the bundle.
fit() {
  (
    cd "$work"
    PATH=$(dirname "$trainctl"):$PATH
    trainctl fit --data="world:skin=good+measured,liftoffs=0.3,$2" \
      --preset=world --features=f,m,a --seed=1 --skip-unusable \
      --out="$1.tactus" --note="$3"
  )
}
fit default contacts=300000,seed=1 \
  "300,000 contacts of the random world on the skins good and measured"
fit no-poses contacts=150000,seed=1,poses=no \
  "150,000 contacts of the random world on the skins good and measured, without poses"
for name in default no-poses; do
  if [[ ${1-} == --check ]]; then
    cmp "$work/$name.tactus" "$BUNDLES/$name.tactus"
    echo "the committed bundle $name comes out, byte for byte"
  else
    mv "$work/$name.tactus" "$BUNDLES/$name.tactus"
  fi
done
