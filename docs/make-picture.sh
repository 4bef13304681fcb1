#!/usr/bin/env bash
# Draws docs/contact.png, the picture at the beginning of the README: one
# simulated contact at a robot condition that the default bundle was not
# trained at, with the answers of that bundle.
#
#   docs/make-picture.sh            some ten seconds
#   docs/make-picture.sh TRIAL      another trial, e.g. 000118
#
# Needs a release build of trainctl, and gnuplot (Debian package gnuplot-nox).
set -euo pipefail
cd "$(dirname "${BASH_SOURCE[0]}")/.."

trial=${1:-000140}
trainctl=build/release/bin/trainctl
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT

"$trainctl" simulate --protocol=paper --skin=good --stiffness=900 \
  --velocity=0.012 --seed=7 --out="$work/unseen.h5"
"$trainctl" show "$work/unseen.h5" --trial="$trial" \
  --model=server/registry/default.tactus --out=docs/contact.png
