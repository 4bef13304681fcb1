#!/usr/bin/env bash
# Writes the pages of docs/results/: every figure in them comes from the
# command above it.
#
#   docs/make-results.sh              all pages
#   docs/make-results.sh PAGE...      these alone
#
# Pages, with minutes on two quiet cores: signals (12), materials (20), taxels
# (6), grid (4), unknown (5), default-bundle (1), cody (2), recordings (1),
# paper-tables (15), simulator (12), world (5), served (8; less with
# TACTUS_SERVED_CONTACTS), upper-reference (20), fine-skin (10), breadth (4). Needs
# a release build. Real recordings are evaluated when TACTUS_DATA_DIR, or
# ../shared/data beside the project, has them.
set -euo pipefail
cd "$(dirname "${BASH_SOURCE[0]}")/.."

trainctl=$PWD/build/release/bin/trainctl
bench=$PWD/build/release/bin/tactus-bench
data=$(realpath -m "${TACTUS_DATA_DIR:-../shared/data}")
docs=$PWD/docs
out=$docs/results
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT
mkdir -p "$out"
cp server/registry/*.tactus "$work"
cd "$work"

# show COMMAND...: the command and what it printed, as one block. Wall-clock
# times are left out: they are the machine's, not the method's.
show() {
  printf '\n```\n$ trainctl %s\n' "$*"
  "$trainctl" "$@" | sed -E 's/, [0-9.]+ s$//'
  printf '```\n'
}

# title TEXT: the head of a page.
title() {
  printf '# %s\n\nWritten by `docs/make-results.sh %s`; back to [all results](../results.md).\n' \
    "$1" "$page"
}

# Both readings of the noise: the absolute one gives nothing away.
signals() {
  title "Ideal signals, one robot condition left out"
  printf '\nThe paper does not state whose variance the noise is a share of. With the *relative* reading it is that of the trial'"'"'s own signal, so the noise of the first frames shows how large the signals will be in the end ([cues.md](../cues.md#what-ideal-signals-give-away)). With the *absolute* one all trials have the same noise, as strong on the mean ([simulator.md](../simulator.md#signals)); what it costs is not the leak alone, because light contacts disappear in it. The most frequent category is HU: 544 of 1,835 (29.65 %%, 95 %% interval 27.60 to 31.78 %%).\n'
  for noise in relative absolute; do
    printf '\n## Noise: %s\n' "$noise"
    show simulate --protocol=paper --goal=0.019 --sensor=signals --noise="$noise" \
      --seed=1 --out="signals-$noise.h5"
    local figures=$out/signals
    [[ $noise == relative ]] || figures=$out/signals-$noise
    show evaluate --data="signals-$noise.h5" --protocol=loco --preset=tuned --seed=1 \
      --no-estimates --figures="$figures"
    printf '\n![Accuracy over time](%s/anytime.png)\n\n![Reliability](%s/reliability.png)\n' \
      "$(basename "$figures")" "$(basename "$figures")"
  done
}

# One network and three epochs: thirteen folds of seven fits take long.
materials() {
  title "Ideal signals, one material left out"
  show simulate --protocol=paper --goal=0.019 --sensor=signals --seed=1 --out=signals.h5
  show evaluate --data=signals.h5 --protocol=leave-one-material-out \
    --preset=tuned --seed=1 --no-estimates --networks=1 --epochs=3
}

unknown() {
  title "What no category explains: is it unknown?"
  printf '\n## A category left out\n\nHMMs of the other three categories and of all groups of arms but one score contacts of that category and of the others, with the arms of that group. 0.5 is chance.\n'
  for truth in so-far final; do
    show evaluate --data=world:skin=good,contacts=8000,seed=3 \
      --protocol=leave-one-category-out --preset=world --truth="$truth" --seed=1
  done
  printf '\n## Materials outside of the range of training\n\nThe default bundle classifies contacts with materials of [outside_materials.csv](../outside_materials.csv), from arms and of sizes that are inside of the range. `inside` are known; every other group is compared with it, and 0.5 is chance. In brackets are 95 %% intervals.\n\n```\n'
  local groups=(inside softer-3x softer-10x softer-30x lighter-10x heavier-10x grippy harder-16x)
  for group in "${groups[@]}"; do
    grep -e '^name,' -e "^$group/" "$docs/outside_materials.csv" >"$group.csv"
    local arguments=(simulate --protocol=grid --sample=600 --skin=good --seed=7
      --materials="$group.csv" --out="$group.h5")
    printf '$ trainctl %s\n' "${arguments[*]}"
    "$trainctl" "${arguments[@]}" | tail -n 1 | sed -E 's/, [0-9.]+ s$//'
    printf '$ trainctl classify --data=%s.h5 --model=default.tactus --json >%s.json\n' \
      "$group" "$group"
    "$trainctl" classify --data="$group.h5" --model=default.tactus --json >"$group.json"
    rm "$group.h5"
  done
  printf '$ docs/unknown_table.py %s\n```\n\n' "${groups[*]/%/.json}"
  /usr/bin/python3 "$docs/unknown_table.py" "${groups[@]/%/.json}"
  cat <<'EOT'

The softer a material is, the more it is unknown, and the more often the answer is
wrong. Materials that are lighter, heavier, harder or that grip more than any in
training feel like others that the bundle knows, and its answers stay right: there is
nothing to detect.

## Would another score do better?

`unknown` compares the likelihood of the best category's HMMs with that of held-out
contacts. Two scores on the HMMs' cues at 5 s, outside of Tactus and on the same
contacts, find SU clearly better (0.89 instead of 0.79) and differ by up to 0.06 for the
others. They have it a little easier: a quarter of all contacts is left out, with all
arms in training. No bundle has them, and they were not tried on other materials. The
contacts are those of the first command above, 95 % intervals are in brackets, and 0.5 is chance:

```
EOT
  local world=(--data="world:skin=good,contacts=8000,seed=3" --out=world-3)
  printf '$ world-signals %s\n$ tests/reference/upper/unknown_scores.py world-3\n```\n\n' \
    "${world[*]}"
  "$(dirname "$trainctl")/world-signals" "${world[@]}"
  /usr/bin/python3 "$docs/../tests/reference/upper/unknown_scores.py" world-3
}

taxels() {
  title "Through taxel frames, one robot condition left out"
  show simulate --protocol=paper --goal=0.019 --sensor=taxels --seed=1 --out=taxels.h5
  show evaluate --data=taxels.h5 --protocol=loco --preset=tuned --seed=1
}

grid() {
  title "A grid of robot conditions that were not trained at"
  show simulate --protocol=paper --goal=0.019 --sensor=signals --seed=1 --out=signals.h5
  show fit --data=signals.h5 --preset=tuned --seed=1 --out=signals.tactus
  show simulate --protocol=grid --sensor=signals --seed=7 --out=grid.h5
  show evaluate --data=grid.h5 --model=signals.tactus
}

default-bundle() {
  title "The default bundle at a robot condition it never saw"
  show simulate --protocol=paper --skin=good --stiffness=900 --velocity=0.012 --seed=7 --out=unseen.h5
  show evaluate --data=unseen.h5 --model=default.tactus
}

cody() {
  title "Virtual Cody, one robot condition left out"
  local reports=()
  printf '\n```\n'
  for seed in 1 2 3 4 5; do
    local data=cody-$seed
    local simulated="simulate --protocol=cody --skin=good --seed=$seed --out=$data.h5"
    local evaluated="evaluate --data=$data.h5 --protocol=loco --preset=tuned --seed=$seed --no-estimates --json"
    printf '$ trainctl %s\n$ trainctl %s >%s.json\n' "$simulated" "$evaluated" "$data"
    # shellcheck disable=SC2086
    "$trainctl" $simulated >/dev/null
    # shellcheck disable=SC2086
    "$trainctl" $evaluated >"$data.json"
    reports+=("$data.json")
  done
  printf '$ docs/pooled_table.py %s\n```\n\n' "${reports[*]}"
  /usr/bin/python3 "$docs/pooled_table.py" "${reports[@]}"
  printf '\nIn brackets are 95 %% intervals. A face is as large as that of any other object, whatever its category: a threshold on the size of the face tells hard from soft in less than 60 %% of the contacts ([virtual-cody.md](../virtual-cody.md)). The first seed in full:\n'
  show evaluate --data=cody-1.h5 --protocol=loco --preset=tuned --seed=1 --no-estimates
}

# 20,000 contacts of another seed: no object, arm or place of them was trained on.
world() {
  title "The random world: objects and arms that were never trained on"
  for skin in good measured; do
    show evaluate --data=world:skin="$skin",contacts=20000,seed=1001 --model=default.tactus
  done
  show evaluate --data=world:skin=good,contacts=20000,seed=1001,poses=no --model=no-poses.tactus
}

# What each point of the front costs and gets wrong. Processor times are this
# machine's; their ratios are what counts. TACTUS_SERVED_FLAGS adds flags, such
# as --bundle=older=FILE.
served() {
  title "The default bundle: what an answer costs"
  local command="served --data=world:skin=good,contacts=${TACTUS_SERVED_CONTACTS:-20000},seed=1001"
  printf '\n```\n$ tactus-bench %s\n```\n\n' "$command"
  # shellcheck disable=SC2086
  "$bench" $command ${TACTUS_SERVED_FLAGS:-} --table=served-table.md \
    --figure="$out/served.png" >/dev/null
  cat <<'TEXT'
Time is processor time of the classifier on a contact frame, without the features of the frame: the median of 15 rounds in which the variants take turns on 64 whole contacts. "Wrong" is the fraction of wrong answers about the category so far, mean over 0.1, 0.25, 0.5, 1.2, 2.5 and 5 s after onset; the log loss is the mean over the same times. [skipping.md](../skipping.md#leaving-out-steps-of-the-lstms) explains the variants. A point is on the front if no other is faster and at most as often wrong, or as fast and less often wrong.

![Time and errors](served.png)

TEXT
  cat served-table.md
}

# Boosted trees that see whole contacts, without and with what the simulator
# alone knows.
upper-reference() {
  title "How much is left: other learners on the same contacts"
  cat <<'EOT'

Boosted trees (scikit-learn's `HistGradientBoostingClassifier`) classify some 350
summaries of each contact: means over stretches of frames, quantiles, largest and
last values and when they came, regressions, and all derived cues
([cues.md](../cues.md)) of what the skin felt until the time asked for
(`tests/reference/upper/summaries.py`). They are another learner, not a bound: where
the bundle is better than they are, the trees have missed something.

- *Trees that also see the bundle's answer* show what the bundle misses in what the
  skin felt: at least the difference between the two.
- *Signals without skin and noise* are force, area and motion as the simulator
  solves them, since the same onset. What these trees miss, noise is not the reason for.

`default.tactus` was trained on 100,000 contacts of seed 1, of the skins `good` and
`measured`. The trees were trained on 19,000 of seed 2, and both were tested on those
of seed 1001, as in [the random world](world.md). The bundle answers about the category
so far, so the last column is not what it was trained for. Accuracies are of the
contacts that the skin felt.
EOT
  for skin in good measured paper; do
    printf '\n## Skin: %s\n\n```\n' "$skin"
    for set in 20000,seed=2 20000,seed=1001; do
      local arguments=(--data="world:skin=$skin,contacts=$set" --out="$skin-${set#*=}")
      # The bundle was not trained on the skin of the paper.
      [[ $skin == paper ]] || arguments+=(--model=default.tactus)
      printf '$ world-signals %s\n' "${arguments[*]}"
      "$(dirname "$trainctl")/world-signals" "${arguments[@]}"
    done
    arguments=("$skin-2" "$skin-1001" --contacts=19000)
    [[ $skin != good ]] || arguments+=(--oracle)
    printf '$ tests/reference/upper/upper_reference.py %s\n```\n\n' "${arguments[*]}"
    OMP_NUM_THREADS=1 /usr/bin/python3 \
      "$docs/../tests/reference/upper/upper_reference.py" "${arguments[@]}" 2>/dev/null
    rm -r "$skin-2" "$skin-1001"
  done
}

fine-skin() {
  title "The random world on a skin as fine as the paper's"
  show fit --data=world:skin=paper,contacts=100000,seed=1 --preset=world --seed=1 --skip-unusable --out=paper-skin.tactus
  show evaluate --data=world:skin=paper,contacts=20000,seed=1001 --model=paper-skin.tactus
}

breadth() {
  title "The paper's contacts by a model of the random world"
  show fit --data=world:skin=ideal,contacts=100000,seed=1 --preset=world --truth=final --seed=1 --out=world.tactus
  show simulate --protocol=paper --goal=0.019 --sensor=signals --seed=1 --out=signals.h5
  show evaluate --data=signals.h5 --model=world.tactus
}

recordings() {
  title "Real recordings"
  cp -r "$data/vitac384" .
  /usr/bin/python3 "$docs/../examples/recordings/vitac384.py" vitac384 vitac
  show import vitac384 --skin=vitac/skin.json --out=vitac384.h5
  show evaluate --data=vitac384.h5 --protocol=leave-one-out --preset=profile
  /usr/bin/python3 "$docs/../examples/recordings/icub_slide20.py" \
    "$data/icub_slide20" icub
  show import icub --out=icub_slide20.h5
  show evaluate --data=icub_slide20.h5 --protocol=k-fold --folds=5 --preset=profile
}

paper-tables() {
  title "The paper's tables"
  printf '\n```\n$ trainctl reproduce --seed=1 --json --figures=paper-tables\n```\n'
  "$trainctl" reproduce --seed=1 --json --figures=paper-tables |
    python3 "$docs/paper_tables.py"
  mkdir -p "$out/paper-tables"
  cp paper-tables/*-accuracy.png paper-tables/*-f-m-a.png "$out/paper-tables"
}

# Processor times are this machine's; their ratios are what counts.
simulator() {
  title "The contact simulator: error and work"
  local command="sim --all --budget=${TACTUS_SIM_BUDGET:-300} --table=work.csv --figure=work.png"
  printf '\n```\n$ tactus-bench %s\n' "$command"
  # shellcheck disable=SC2086
  "$bench" $command 2>&1
  printf '```\n\nOne contact on one core; errors are the largest of any noiseless sampled feature, as a share of its peak.\n'
  printf '\n| sample | method | tolerance | time (ms) | median error | worst error |\n|---|---|---|---|---|---|\n'
  awk -F, 'NR > 1 { printf "| %s | %s | %s | %.3g | %s | %s |\n", $1, $2, $3, 1000 * $4, $5, $6 }' work.csv
  cp work.png "$out/sim-work-precision.png"
  printf '\n![Work and precision](sim-work-precision.png)\n'
}

pages=("$@")
[[ $# -gt 0 ]] || pages=(signals materials taxels grid unknown default-bundle cody
  recordings paper-tables simulator world served upper-reference fine-skin breadth)
for page in "${pages[@]}"; do
  case "$page" in
    signals | materials | taxels | grid | unknown | default-bundle | cody | \
      recordings | paper-tables | simulator | world | served | upper-reference | \
      fine-skin | breadth) ;;
    *) echo "make-results: unknown page '$page'" >&2; exit 2 ;;
  esac
  "$page" >"$work/$page.md"
  # The folder of this run is no one else's business.
  sed "s#$out#docs/results#g" "$work/$page.md" >"$out/$page.md"
done
