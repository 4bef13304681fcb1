#!/usr/bin/env bash
# Writes docs/results.md: every figure in it comes from the command above it.
#
#   docs/make-results.sh    needs a release build; some minutes on two cores
#
# Real recordings are evaluated when TACTUS_DATA_DIR, or ../shared/data beside
# the project, has them.
set -euo pipefail
cd "$(dirname "${BASH_SOURCE[0]}")/.."

trainctl=$PWD/build/release/bin/trainctl
data=$(realpath -m "${TACTUS_DATA_DIR:-../shared/data}")
out=$PWD/docs/results.md
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT
cp server/registry/default.tactus "$work"
cd "$work"

# show COMMAND...: the command and what it printed, as one block. Wall-clock
# times are left out: they are the machine's, not the method's.
show() {
  printf '\n```\n$ trainctl %s\n' "$*"
  "$trainctl" "$@" | sed -E 's/, [0-9.]+ s$//'
  printf '```\n'
}

{
  cat <<'TEXT'
# Results

Written by `docs/make-results.sh`; every figure comes from the command above it. Accuracy is correct answers over detectable trials; undetectable ones (no taxel ever reached the onset threshold) are counted apart. Folds never share what they are split by: scaling, clusters and calibration come from the training folds alone.

## The paper's trials

The paper's 1,835 simulated contacts (its counts: 544, 365, 496, 430). Two trials fall into another class than in the paper.
TEXT
  show simulate --protocol=paper --goal=0.019 --sensor=signals --seed=1 --out=signals.h5
  cat <<'TEXT'

### Ideal signals, leave one robot condition out

The paper's protocol: train on three of the four arm conditions, test on the fourth. The paper's best is 82.13 % (HMM, force and motion).
TEXT
  for features in f m a f,m f,a m,a f,m,a; do
    show evaluate --data=signals.h5 --protocol=loco --algorithm=hmm \
      --features=$features --seed=1
  done
  cat <<'TEXT'

The paper's own settings (one 10-state HMM a category on scaled features, Viterbi score), and its baseline:
TEXT
  show evaluate --data=signals.h5 --protocol=loco --preset=paper --features=f,m --seed=1
  show evaluate --data=signals.h5 --protocol=loco --algorithm=1nn --features=f,m,a --seed=1
  cat <<'TEXT'

### Through taxel frames

The same contacts as a real skin would send them: rendered on the `cody-forearm` layout with absolute noise ([simulator.md](simulator.md)) and taken through segmentation, onset and features. Many light, soft objects that move never press any taxel above the onset threshold.
TEXT
  show simulate --protocol=paper --goal=0.019 --sensor=taxels --seed=1 --out=taxels.h5
  show evaluate --data=taxels.h5 --protocol=loco --algorithm=hmm --features=f,m,a --seed=1
  cat <<'TEXT'

### The default bundle at robot conditions it never saw

The bundle in `tactusd` was trained on 543 and 2,050 N/m at 5 and 20 mm/s. Here the arm has 900 N/m and moves at 12 mm/s.
TEXT
  show simulate --protocol=paper --sensor=taxels --stiffness=900 --velocity=0.012 --seed=7 --out=unseen.h5
  show evaluate --data=unseen.h5 --model=default.tactus
  if [[ -d $data/vitac384 ]]; then
    cp -r "$data/vitac384" .
    cat <<'TEXT'

## Real recordings: vitac384

43 trials pressed by hand on a 12 x 32 array, through the taxel path, leave one trial out.
TEXT
    show import vitac384 --out=vitac384.h5
    show evaluate --data=vitac384.h5 --protocol=leave-one-out --algorithm=hmm --features=f,m,a --seed=1
  fi
  cat <<'TEXT'

## What limits these figures

Soft and hard objects that move are told apart least well: once an object slides, force is set by friction alone and motion by the arm, so little but the first moments tells how soft it was. Probabilities do not yet mean quite what they say at unseen conditions (expected calibration error above): the calibration is fitted on inner folds that leave out one condition more than the models in use.
TEXT
} >"$work/results.md"
mv "$work/results.md" "$out"
