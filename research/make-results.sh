#!/usr/bin/env bash
# Writes the pages of research/results/: every figure in them comes from the
# command above it.
#
#   research/make-results.sh              the pages that this build has not written
#   research/make-results.sh PAGE...      these alone, written or not
#   TACTUS_EFLESH_DIR=DIR research/make-results.sh eflesh
#                                         the page of public recordings in DIR
#
# After an interruption the first command goes on with the page at which it was
# interrupted: a page and its figures are replaced when they are complete.
#
# Pages, with minutes on two cores, some three hours together: signals (2),
# materials (2), taxels (4), grid (1), unknown (11), default-bundle (1), cody (1),
# recordings (1), presets (14), paper-tables (40), explanations (20), simulator (8), world (1), touches (4),
# served (1; less with TACTUS_SERVED_CONTACTS), upper-reference (10), fine-skin (36
# beside a build), breadth (22), inputs (4; less with TACTUS_INPUTS_CONTACTS),
# fit-scale (8), labels (20); by its name alone eflesh (3), of the folder slip_detection/data of
# the public repository notvenky/eFlesh.
# Needs a release build with -D TACTUS_RESEARCH=ON. Real recordings are evaluated when TACTUS_DATA_DIR, or
# ../shared/data beside the project, has them.
# The backquotes are Markdown, and a comma separates fields of one argument.
# shellcheck disable=SC2016,SC2054
set -euo pipefail
cd "$(dirname "${BASH_SOURCE[0]}")/.."

all_pages=(signals materials taxels grid unknown default-bundle cody recordings
  presets paper-tables explanations simulator world touches served upper-reference fine-skin breadth
  inputs fit-scale labels)

# Pages of data that only some have: written when they are named.
named_pages=(eflesh)

root=$PWD
bin=$root/build/release/bin
trainctl=$bin/trainctl
bench=$bin/tactus-bench
data=$(realpath -m "${TACTUS_DATA_DIR:-../shared/data}")
research=$root/research
# What each page was written by.
stamps=$root/build/release/results
work=$(mktemp -d)
# The page and its figures, until they are complete.
out=$work/out
writing=
finish() {
  rm -rf "$work"
  [[ -z $writing ]] || echo "make-results: $writing: not completed, left as it was" >&2
}
trap finish EXIT

# show COMMAND...: the command and what it printed, as one block. Wall-clock
# times are left out: they are the machine's, not the method's.
show() {
  printf '\n```\n$ trainctl %s\n' "$*"
  "$trainctl" "$@" | sed -E 's/, [0-9.]+ s$//'
  printf '```\n'
}

# quietly COMMAND...: the command, inside a block, without what it printed.
quietly() {
  printf '$ trainctl %s\n' "$*"
  "$trainctl" "$@" >/dev/null
}

# world_signals ARGUMENTS...: the program, inside a block.
world_signals() {
  printf '$ world-signals %s\n' "$*"
  "$bin/world-signals" "$@"
}

# reference SCRIPT ARGUMENTS...: ends a block with a script of this folder. What
# it prints is Markdown.
reference() {
  printf '$ research/%s\n```\n\n' "$*"
  OMP_NUM_THREADS=1 /usr/bin/python3 -B "$research/$1" "${@:2}"
}

# title TEXT SKIN SEEDS DENOMINATOR: the head of a page.
title() {
  printf '# %s\n\nSkin: %s. Seeds: %s. Of: %s.\n\n' "$1" "$2" "$3" "$4"
  printf 'Written by `research/make-results.sh %s`; back to [all results](../../docs/results.md).\n' \
    "$page"
}

# commas NUMBER: with commas between thousands.
commas() {
  sed -E ':a; s/^([0-9]+)([0-9]{3})/\1,\2/; ta' <<<"$1"
}

# eflesh_cells NAME ARGUMENTS...: a row of a table, the accuracy with its interval for
# recordings of 1, 2 and 3 s.
eflesh_cells() {
  local seconds cells=
  for seconds in 1 2 3; do
    cells+=$("$trainctl" evaluate --data="eflesh-$seconds.h5" --seed=1 "${@:2}" |
      sed -nE '1s/.*: ([0-9.]+) % \(95 % interval ([0-9.]+) to ([0-9.]+) %\).*/ | \1 (\2 to \3)/p')
  done
  printf '| %s%s |\n' "$1" "$cells"
}

# Slip by signed shear: recordings that no one here made.
eflesh() {
  local shear=log_shear,log_shear_ratio,shear_cosine,shear_sine,shear_turn
  shear+=,log_shear_rate,log_shear_ratio_rate,shear_tremor_short
  title "Slip on eFlesh" "two pads of five magnetometers of three axes" \
    "folds and training 1" "the 137 sequences of the public recordings, all of them felt"
  cat <<'EOT'

The recordings are those of `slip_detection/data` of the public repository
notvenky/eFlesh (MIT; arXiv 2506.09994): 137 sequences of 3 s at 100 Hz, each of class
`one` (103) or `zero` (34). What the classes stand for is not documented there; its paper
reports 95 %. The load of a magnetometer is the distance of its three values from
their means over the first half second, so a sequence is one contact that begins with it.
The data say no onset of a slip, so they have an accuracy and no delay.

Labels come in blocks: 86 of `one`, 34 of `zero`, 17 of `one`. What changed from session to
session is confounded with the class, so the first table is too good for a robot of
tomorrow. In the second one, two folds each hold one of the blocks of `one`, and one half of
the zeros.

```
EOT
  local seconds
  for seconds in 1 2 3; do
    printf '$ examples/recordings/eflesh.py $TACTUS_EFLESH_DIR eflesh-%s %s\n' "$seconds" "$seconds"
    /usr/bin/python3 -B "$root/examples/recordings/eflesh.py" \
      "$TACTUS_EFLESH_DIR" "eflesh-$seconds" "$seconds"
    quietly import "eflesh-$seconds" --out="eflesh-$seconds.h5" 2>/dev/null
  done
  printf '```\n\nAccuracy in percent with its 95 %% interval, of models that are trained on and answer for recordings of this length:\n'
  local protocol preset
  for protocol in "k-fold --folds=10" "loco"; do
    local -a folds
    read -ra folds <<<"--protocol=$protocol"
    printf '\n`trainctl evaluate --data=eflesh-3.h5 --protocol=%s --seed=1 --no-estimates --preset=...`\n\n' "$protocol"
    printf '| | 1 s | 2 s | 3 s |\n|---|---|---|---|\n'
    for preset in whole-skin pattern tuned; do
      eflesh_cells "\`$preset\`" "${folds[@]}" --no-estimates --preset="$preset"
      eflesh_cells "\`$preset\` without shear" "${folds[@]}" --no-estimates \
        --preset="$preset" --without-cues="$shear"
    done
    eflesh_cells "one nearest neighbour (\`--algorithm=1nn\`)" "${folds[@]}" --algorithm=1nn
    printf '| always `one` | 75.18 | 75.18 | 75.18 |\n'
  done
  cat <<'EOT'

"Without shear" leaves out the cues of the group `shear` ([cues.md](../../docs/cues.md));
the load, a distance, still has all three axes in it. With 137 sequences, one of them is
0.73 points: on these recordings shear and its absence cannot be told apart after 2 s, and
within the first second nobody knows.
EOT
}

# What the paper's set is as ideal signals.
paper_signals=("none, ideal signals" "contacts 1, training 1"
  "the 1,835 contacts of the paper's set, all of them felt")

# Both readings of the noise: the absolute one gives nothing away.
signals() {
  title "Ideal signals, one robot condition left out" "${paper_signals[@]}"
  printf '\nThe paper does not state whose variance the noise is a share of. With the *relative* reading it is that of the trial'"'"'s own signal, so the noise of the first frames shows how large the signals will be in the end ([cues.md](../../docs/cues.md#what-ideal-signals-give-away)). With the *absolute* one all trials have the same noise, as strong on the mean ([simulator.md](../../docs/simulator.md#signals)); what it costs is not the leak alone, because light contacts disappear in it. The most frequent class is HU: 544 of 1,835 (29.65 %%, 95 %% interval 27.60 to 31.78 %%).\n'
  for noise in relative absolute; do
    printf '\n## Noise: %s\n' "$noise"
    show simulate --protocol=paper --goal=0.019 --noise="$noise" \
      --seed=1 --out="signals-$noise.h5"
    local figures=$out/signals
    [[ $noise == relative ]] || figures=$out/signals-$noise
    show evaluate --data="signals-$noise.h5" --protocol=loco --preset=tuned --seed=1 \
      --no-estimates --figures="$figures"
    printf '\n![Accuracy over time](%s/anytime.png)\n\n![Reliability](%s/reliability.png)\n' \
      "$(basename "$figures")" "$(basename "$figures")"
    printf '\nBoosted trees on some 350 summaries of the same contacts ([other learners](upper-reference.md)), by the class in the end:\n\n```\n'
    world_signals --data="signals-$noise.h5" --out="$noise"
    reference upper/left_out_reference.py "$noise"
  done
}

# One network and three epochs: thirteen folds of seven fits take long.
materials() {
  title "Ideal signals, one material left out" "${paper_signals[@]}"
  show simulate --protocol=paper --goal=0.019 --seed=1 --out=signals.h5
  show evaluate --data=signals.h5 --protocol=leave-one-material-out \
    --preset=tuned --seed=1 --no-estimates --networks=1 --epochs=3
}

unknown() {
  title "What no class explains: is it unknown?" "good" \
    "contacts 3 (classes) and 7 (materials), training 1" \
    "the felt contacts among 8,000 (classes), 2,400 (materials inside of the range) and 1,200 (each other group of materials)"
  printf '\n## A class left out\n\nModels of the other three classes and of all groups of arms but one score contacts of that class and of the others, with the arms of that group. 0.5 is chance.\n'
  local left_out=(evaluate --data=world:skin=good,contacts=8000,seed=3
    --protocol=leave-one-category-out --preset=world --seed=1)
  for truth in so-far final; do
    show "${left_out[@]}" --truth="$truth"
  done
  printf '\nWithout the estimated stiffness, by the likelihood of the HMMs alone:\n'
  show "${left_out[@]}" --truth=so-far --no-estimates
  cat <<'EOT'

## Materials outside of the range of training

The default bundle classifies contacts with materials that
[outside_materials.py](../outside_materials.py) draws: 60 inside of the range of
training, and 30 in each group that has one property outside of it. Arms and sizes are
inside of the range. `inside` are known; every other group is compared with it, and 0.5
is chance. In brackets are 95 % intervals. How many of the false alarms are left to the
estimated stiffness was chosen with other materials of these groups and with the contacts
above, so the figures may be a little too good.

```
$ research/outside_materials.py .
EOT
  /usr/bin/python3 -B "$research/outside_materials.py" .
  local groups=(inside softer-3x softer-10x softer-30x lighter-10x heavier-10x grippy harder-16x)
  local group sample=2400
  for group in "${groups[@]}"; do
    local arguments=(simulate --protocol=grid --sample="$sample" --skin=good --seed=7
      --materials="$group.csv" --out="$group.h5")
    printf '$ trainctl %s\n' "${arguments[*]}"
    "$trainctl" "${arguments[@]}" | tail -n 1 | sed -E 's/, [0-9.]+ s$//'
    printf '$ trainctl classify --data=%s.h5 --model=default.tactus --json >%s.json\n' \
      "$group" "$group"
    "$trainctl" classify --data="$group.h5" --model=default.tactus --json >"$group.json"
    world_signals --data="$group.h5" --out="$group"
    rm "$group.h5"
    sample=1200
  done
  printf '$ research/unknown_table.py %s\n```\n\n' "${groups[*]/%/.json}"
  /usr/bin/python3 -B "$research/unknown_table.py" "${groups[@]/%/.json}"
  cat <<'EOT'

Softer materials are unknown, and the softer they are, the more often the answer is
wrong. Lighter, heavier, harder materials and those that grip more than any in training
are not unknown, and the answers stay right.

Can such materials be found at all? For each group, boosted trees learn from contacts of
this group and of `inside`. They see summaries of 5 s, and are tested on other materials
of both. `unknown` has a harder task, because it has never seen the group. These are the
areas under the ROC curve; 95 % intervals are in brackets:

```
EOT
  reference upper/unknown_bound.py "${groups[@]}"
  cat <<'EOT'

Objects that do not move show neither their density nor their friction. Softer
materials are easy for the trees, because those of a group have one modulus.

## Would another score do better?

`unknown` compares the likelihood of the best class's HMMs, and the stiffness that a
network estimates, with those of held-out contacts. The tables have three other scores.
They are computed outside of Tactus from the HMMs' cues at 5 s, and no bundle has them:

- the Mahalanobis distance from the nearest class;
- the mean distance from the 20 nearest contacts;
- how rare so low a density is (a mixture of 20 Gaussians) times how rare so extreme a
  `log_slope` is. It was chosen among some thirty scores for its area on other materials
  of the group `softer-3x`, so its figure for this group is a little too good.

With a class left out, their task is a little easier than that of `unknown`: a quarter
of all contacts is left out, and all arms are in training. For foreign materials they are
fitted to the 8,000 contacts alone. In brackets are 95 % intervals, and 0.5 is chance.

```
EOT
  world_signals --data="world:skin=good,contacts=8000,seed=3" --out=world-3
  reference upper/unknown_scores.py world-3
  printf '\n```\n'
  reference upper/unknown_scores.py world-3 "${groups[@]}"
}

taxels() {
  title "Through taxel frames, one robot condition left out" "paper, then good" \
    "contacts 1, training 1" \
    "the felt contacts among the 1,835 of the paper's set; those never felt are counted beside them"
  for skin in paper good; do
    printf '\n## Skin: %s\n' "$skin"
    show simulate --protocol=paper --goal=0.019 --skin="$skin" --seed=1 --out="$skin.h5"
    show evaluate --data="$skin.h5" --protocol=loco --preset=tuned --seed=1
  done
}

grid() {
  title "A grid of robot conditions that were not trained at" "none, ideal signals" \
    "contacts 1 (training) and 7 (test), training 1" \
    "the 2,000 contacts of the grid, all of them felt"
  show simulate --protocol=paper --goal=0.019 --seed=1 --out=signals.h5
  show fit --data=signals.h5 --preset=tuned --seed=1 --out=signals.tactus
  show simulate --protocol=grid --seed=7 --out=grid.h5
  show evaluate --data=grid.h5 --model=signals.tactus
}

default-bundle() {
  title "The default bundle at a robot condition it never saw" "good" \
    "contacts 7, training 1" \
    "the felt contacts among 453; those never felt are counted beside them"
  show simulate --protocol=paper --skin=good --stiffness=900 --velocity=0.012 --seed=7 --out=unseen.h5
  show evaluate --data=unseen.h5 --model=default.tactus
}

cody() {
  title "Virtual Cody, one robot condition left out" "good" \
    "contacts and training 1 to 5" \
    "the felt contacts among the 240 of each seed; those never felt are counted beside them"
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
  printf '$ research/pooled_table.py %s\n```\n\n' "${reports[*]}"
  /usr/bin/python3 -B "$research/pooled_table.py" "${reports[@]}"
  printf '\nIn brackets are 95 %% intervals. A face is as large as that of any other object, whatever its class: a threshold on the size of the face tells hard from soft in less than 60 %% of the contacts ([virtual-cody.md](../virtual-cody.md)). The first seed in full:\n'
  show evaluate --data=cody-1.h5 --protocol=loco --preset=tuned --seed=1 --no-estimates
}

# 20,000 contacts of another seed: no object, arm or place of them was trained on.
# touches_row NAME FILE: a line of the table of touches.
touches_row() {
  /usr/bin/python3 -B "$research/touches_row.py" "$1" "$2"
}

# Pairs by the gap between them, then scenes; the same contacts alone beside them.
touches() {
  title "Touches that follow each other, and touches at once" "good" \
    "scenes 4101 (pairs) and 4102 (objects), training 1" \
    "1,000 trials of two touches a row, 500 trials of two to four objects"
  printf '\nA touch is right if the last answers of all its contacts are; those of *alone* are the same contacts, each in a trial of its own ([simulator.md](../../docs/simulator.md#several-contacts-in-a-trial)). Each file is evaluated by `trainctl evaluate --data=touches.h5 --model=default.tactus --json`. One arm presses all objects of a scene: a stiff or fixed one takes the load from the others, so more touches are too light to be felt than alone, and fewer objects move.\n\n'
  local rows=$work/rows
  printf '| trials | touches | found | broken | merged | switched | at none | right of those felt | calibration error | always the most frequent class |\n|---|---|---|---|---|---|---|---|---|---|\n' >"$rows"
  printf '```\n'
  local name gap objects
  for gap in 0.25 0.65 0.85; do
    quietly simulate --protocol=random --skin=good --contacts=1000 --touches=2 \
      --gap="$gap" --seed=4101 --out=touches.h5
    "$trainctl" evaluate --data=touches.h5 --model=default.tactus --json >touches.json
    touches_row "two touches, $gap s between them" touches.json >>"$rows"
  done
  quietly simulate --protocol=random --skin=good --contacts=1000 --touches=2 --alone \
    --seed=4101 --out=touches.h5
  "$trainctl" evaluate --data=touches.h5 --model=default.tactus --json >touches.json
  touches_row "the same, each alone" touches.json >>"$rows"
  for objects in 2 3 4; do
    for name in "$objects objects" "the same, each alone"; do
      local alone=()
      [[ $name != *alone ]] || alone=(--alone)
      quietly simulate --protocol=random --skin=good --contacts=500 \
        --objects="$objects" "${alone[@]}" --seed=4102 --out=touches.h5
      "$trainctl" evaluate --data=touches.h5 --model=default.tactus --json >touches.json
      touches_row "$name" touches.json >>"$rows"
    done
  done
  printf '```\n\n'
  cat "$rows"
}

world() {
  title "The random world: objects and arms that were never trained on" \
    "good, then measured, then good without poses" "contacts 1001, training 1" \
    "the felt contacts among 20,000; those never felt are counted beside them"
  for skin in good measured; do
    show evaluate --data=world:skin="$skin",contacts=20000,seed=1001 --model=default.tactus
  done
  show evaluate --data=world:skin=good,contacts=20000,seed=1001,poses=no --model=no-poses.tactus
}

# What each point of the front costs and gets wrong. Processor times are this
# machine's; their ratios are what counts. TACTUS_SERVED_FLAGS adds flags, such
# as --bundle=older=FILE.
labels() {
  title "Labels that a new material needs" "good" \
    "10 to 203 (contacts), training 1" \
    "the felt ones among 100 held-out contacts with the material, in each of 20 repetitions"
  cat <<'TEXT'

A model of 160 simulated contacts (protocol `grid`, preset `paper` without networks) that
lacks natural rubber answers 300 others on arms of 250 and 1,600 N/m, of which 60 are with
it. Some of the 300 get their labels, and a model is trained again with them: either those
that were answered with the least certainty, as [the contact log](../../docs/contact-log.md)
lists them, or some by chance. Errors are those on contacts with natural rubber on arms of
630 and 4,000 N/m. A difference is that of the same repetition: below 0, the least certain
contacts teach more.

```
TEXT
  printf '$ research/labels_needed.py trainctl core/sim/model/materials.csv\n```\n\n'
  OMP_NUM_THREADS=1 /usr/bin/python3 -B "$research/labels_needed.py" "$trainctl" \
    "$root/core/sim/model/materials.csv" --folder="$stamps/labels-repetitions"
}

served() {
  local contacts=${TACTUS_SERVED_CONTACTS:-20000}
  title "The default bundle: what an answer costs" "good" "contacts 1001, training 1" \
    "the felt contacts among $(commas "$contacts")"
  local command="served --data=world:skin=good,contacts=$contacts,seed=1001"
  printf '\n```\n$ tactus-bench %s\n```\n\n' "$command"
  # shellcheck disable=SC2086
  "$bench" $command ${TACTUS_SERVED_FLAGS:-} --table=served-table.md \
    --figure="$out/served.png" >/dev/null
  cat <<'TEXT'
Time is processor time of the classifier on a contact frame, without the features of the frame: the median of 15 rounds in which the variants take turns on 64 whole contacts. "Wrong" is the fraction of wrong answers about the class so far, mean over 0.1, 0.25, 0.5, 1.2, 2.5 and 5 s after onset; the log loss is the mean over the same times. [skipping.md](../../docs/skipping.md#leaving-out-steps-of-the-lstms) explains the variants. A point is on the front if no other is faster and at most as often wrong, or as fast and less often wrong.

![Time and errors](served.png)

TEXT
  cat served-table.md
}

fit-scale() {
  title "What a fit costs" "none, ideal signals" "contacts 7, training 1" \
    "one fit of each size"
  printf '\n```\n$ tactus-bench fit-scale\n```\n\n'
  "$bench" fit-scale --table=fit-scale-table.md --figure="$out/fit-scale.png" >/dev/null
  cat <<'TEXT'
Contacts of the random world, preset `tuned` with one network, two epochs and five HMMs
a class, and its calibration. The program is `trainctl fit`, which simulates the
contacts too. Processor time is that of all threads; peak memory is the largest resident
set. [training-speed.md](../training-speed.md#memory) says what lies where.

![Time and memory](fit-scale.png)

TEXT
  cat fit-scale-table.md
}

# Boosted trees that see whole contacts, without and with what the simulator
# alone knows.
upper-reference() {
  title "How much is left: other learners on the same contacts" \
    "good, measured and paper" \
    "contacts 2 (training of the trees) and 1001 (test), training of the bundle 1" \
    "the felt contacts among 20,000; those never felt are counted beside them"
  cat <<'EOT'

Boosted trees (scikit-learn's `HistGradientBoostingClassifier`) classify some 350
summaries of each contact: means over stretches of frames, quantiles, largest and
last values and when they came, regressions, and all derived cues
([cues.md](../../docs/cues.md)) of what the skin felt until the time asked for
(`research/upper/summaries.py`). They are another learner, not a bound: where
the bundle is better than they are, the trees have missed something.

- *Trees that also see the bundle's answer* show what the bundle misses in what the
  skin felt: at least the difference between the two.
- *Signals without skin and noise* are force, area and motion as the simulator
  solves them, since the same onset. What these trees miss, noise is not the reason for.

`default.tactus` was trained on 300,000 contacts of seed 1, of the skins `good` and
`measured`. The trees were trained on 19,000 of seed 2, and both were tested on those
of seed 1001, as in [the random world](world.md). The bundle answers about the class
so far, so the last column is not what it was trained for. Accuracies are of the
contacts that the skin felt.
EOT
  for skin in good measured paper; do
    printf '\n## Skin: %s\n\n```\n' "$skin"
    for set in 20000,seed=2 20000,seed=1001; do
      local arguments=(--data="world:skin=$skin,contacts=$set" --out="$skin-${set#*=}")
      # The bundle was not trained on the skin of the paper.
      [[ $skin == paper ]] || arguments+=(--model=default.tactus)
      world_signals "${arguments[@]}"
    done
    arguments=("$skin-2" "$skin-1001" --contacts=19000)
    [[ $skin == measured ]] || arguments+=(--oracle)
    reference upper/upper_reference.py "${arguments[@]}" 2>/dev/null
    rm -r "$skin-2" "$skin-1001"
  done
}

fine-skin() {
  title "The random world on a skin as fine as the paper's" "paper" \
    "contacts 1 (training) and 1001 (test), training 1" \
    "the felt contacts among 20,000; those never felt are counted beside them"
  show fit --data=world:skin=paper,contacts=400000,seed=1 --preset=world --seed=1 --skip-unusable --out=paper-skin.tactus \
    --with-cues=force_tremor_short,force_pitch_short,force_tremor_long,force_pitch_long,log_row_spread,log_column_spread
  show evaluate --data=world:skin=paper,contacts=20000,seed=1001 --model=paper-skin.tactus
}

# With the classes as frequent as in the random world, and as if they were
# equally frequent: in the paper's set they are neither.
breadth() {
  title "The paper's contacts by a model of the random world" "none, ideal signals" \
    "contacts 1, training 1 to 3" "${paper_signals[2]}"
  show simulate --protocol=paper --goal=0.019 --seed=1 --out=signals.h5
  for shares in recorded even; do
    printf '\n## Shares of the classes: %s\n' "$shares"
    show fit --data=world:skin=ideal,contacts=100000,seed=1 --preset=world --truth=final \
      --shares="$shares" --seed=1 --out="$shares.tactus"
    show evaluate --data=signals.h5 --model="$shares.tactus"
  done
  local cues=force_tremor_short,force_pitch_short,force_tremor_long,force_pitch_long
  local seed
  for seed in 1 2 3; do
    printf '\n## Even shares and the cues of the tremor, training seed %s\n' "$seed"
    show fit --data=world:skin=ideal,contacts=100000,seed=1 --preset=world --truth=final \
      --shares=even --with-cues="$cues" --seed="$seed" --out="tremor-$seed.tactus"
    show evaluate --data=signals.h5 --model="tremor-$seed.tactus"
  done
}

# What the answers of one model lose when it was fitted without an input, beside
# what they lose by another seed of the training. TACTUS_INPUTS_CONTACTS trains
# on other numbers of contacts and tests on two fifths of them.
inputs() {
  local trained=${TACTUS_INPUTS_CONTACTS:-10000}
  local tested=$((trained * 2 / 5))
  title "What each input is worth" "good" \
    "contacts 1 (training) and 1001 (test), training 1 to 5" \
    "the felt contacts among $(commas "$tested"); models are fitted to $(commas "$trained")"
  cat <<'EOT'

All models are tested on the same contacts. So each table compares its rows, contact by
contact, with the first one: how many only one of the two answers rightly, and how
probable so uneven a split would be if both were equally good (McNemar's exact test).
Answers are those after the last frame. In brackets are 95 % intervals.

```
EOT
  local recipe=world:skin=good
  # fit_and_test NAME SEED PARTS FLAGS...: with parts of the recipe and flags of
  # the fit.
  fit_and_test() {
    quietly fit --data="$recipe,contacts=$trained,seed=1$3" --preset=world --seed="$2" \
      --skip-unusable "${@:4}" --out="$1.tactus"
    quietly evaluate --data="$recipe,contacts=$tested,seed=1001$3" --model="$1.tactus" \
      --answers="$1.csv"
  }
  fit_and_test all 1 ""
  for seed in 2 3 4 5; do
    fit_and_test "seed-$seed" "$seed" ""
  done
  fit_and_test without-log_drag 1 "" --without-cues=log_drag
  fit_and_test without-area 1 "" --features=f,m
  fit_and_test without-motion 1 "" --features=f,a
  fit_and_test without-poses 1 ",poses=no"
  local millimetres noisy=()
  for millimetres in 0.01 0.1 1 10; do
    noisy+=("noise-$millimetres-mm.csv")
    quietly evaluate --data="$recipe,contacts=$tested,seed=1001,pose-noise=$millimetres" \
      --model=all.tactus --answers="${noisy[-1]}"
  done
  printf '```\n\n## An input left out\n\n'
  printf 'Without poses the motion is that of the centroid along the skin; without motion there is none.\n'
  compare all.csv without-{log_drag,area,motion,poses}.csv
  printf '\n## Another seed of the training\n\nThe same inputs; `all` is seed 1.\n'
  compare --spread all.csv seed-{2,3,4,5}.csv
  printf '\n## Noise of the poses\n\nContacts of the world, and those that `all` was fitted to, draw the standard deviation of the coordinates of their poses from 0.05 to 2 mm. In the other rows it is the same in all tested contacts.\n'
  compare all.csv "${noisy[@]}"
}

# compare FLAGS AND FILES...: a table of answers to the same contacts.
compare() {
  printf '\n```\n$ research/paired_table.py %s\n```\n\n' "$*"
  /usr/bin/python3 -B "$research/paired_table.py" "$@"
}

recordings() {
  title "Real recordings" "vitac-12x32, then icub-6x10" "training 1" \
    "all 43 recordings of vitac384, all 680 of icub_slide20; all of them were felt"
  cp -r "$data/vitac384" .
  /usr/bin/python3 -B "$root/examples/recordings/vitac384.py" vitac384 vitac
  show import vitac384 --skin=vitac/skin.json --out=vitac384.h5
  for preset in profile whole-skin; do
    show evaluate --data=vitac384.h5 --protocol=leave-one-out --preset="$preset"
  done
  taxel_nearest vitac384.h5
  printf '\n## A rubber pad that no contact of training has touched\n\nThe tables of `without-PAD` and `PAD` have the lines of vitac/trials.csv without those of one of the two rubber pads, and those alone.\n'
  for pad in ramp ellipsoid; do
    mkdir "without-$pad" "$pad"
    cp vitac/skin.json "without-$pad"
    cp vitac/skin.json "$pad"
    grep -v "${pad}_rubber" vitac/trials.csv >"without-$pad/trials.csv"
    grep -e '^trial,' -e "${pad}_rubber" vitac/trials.csv >"$pad/trials.csv"
    show import vitac384 --skin="without-$pad/skin.json" --out="without-$pad.h5"
    show import vitac384 --skin="$pad/skin.json" --out="$pad.h5"
    show fit --data="without-$pad.h5" --preset=whole-skin --out="without-$pad.tactus"
    show evaluate --data="$pad.h5" --model="without-$pad.tactus"
    taxel_nearest "--train=without-$pad.h5" "$pad.h5"
  done
  printf '\n## Materials under a sliding finger\n\nNo preset is named, so one is chosen.\n'
  /usr/bin/python3 -B "$root/examples/recordings/icub_slide20.py" \
    "$data/icub_slide20" icub
  show import icub --out=icub_slide20.h5
  show evaluate --data=icub_slide20.h5 --protocol=k-fold --folds=5
  taxel_nearest --folds=5 icub_slide20.h5
}

# taxel_nearest FLAGS AND FILE...: what the simplest learner makes of it.
taxel_nearest() {
  printf '\n1-NN on the mean of every taxel over stretches of the trial, and on the roots of these means:\n\n```\n'
  reference upper/taxel_nearest.py "$@"
}

# chosen DATA PROTOCOL: what auto chooses among HMMs alone and with LSTMs, and how
# good each choice is.
chosen() {
  local work
  for work in 0 1000; do
    show evaluate --data="$1" --protocol="$2" --preset=auto \
      --choice-work="$work" |
      sed -E '/^[a-z-]+, .* felt contacts;/,/^```$/{/^[a-z-]+, .* felt contacts;/!{/^```$/!d}}'
  done
}

presets() {
  title "Which preset auto chooses" "pad, vitac-12x32, icub-6x10 and good" \
    "touches and contacts 5, training 1" \
    "210 made touches, 28 recordings of vitac384, 227 of icub_slide20 and the felt ones of 240 simulated contacts"
  cat <<'EOT'

`--preset=auto` compares presets by folds of all contacts that leave out groups or, without
groups, conditions, by right answers before the calibration. The last line of each block is
the accuracy of the chosen preset by the same folds, calibrated within them. It is somewhat
too good, because the choice saw these contacts. Each set comes twice: with HMMs alone
(`--choice-work=0`) and with LSTMs.

## Six people, each left out

Touches of five kinds on a pad of 8 x 8 taxels, made by [made_touches.py](../made_touches.py).
EOT
  /usr/bin/python3 -B "$research/made_touches.py" touches
  show import touches --out=touches.h5
  chosen touches.h5 leave-one-material-out
  printf '\n## Two rubber pads, each left out\n\nThe lines of vitac/trials.csv with a rubber pad; the pad is the group.\n'
  cp -r "$data/vitac384" .
  /usr/bin/python3 -B "$root/examples/recordings/vitac384.py" vitac384 vitac
  mkdir pads
  cp vitac/skin.json pads
  sed -n -e '1s/,object,.*/,group/p' -e 's/,\([a-z]*_rubber\),.*/,\1/p' \
    vitac/trials.csv >pads/trials.csv
  show import vitac384 --skin=pads/skin.json --out=pads.h5
  chosen pads.h5 leave-one-material-out
  printf '\n## Materials under a sliding finger, each part of the recordings left out\n\nEvery third line of icub/trials.csv.\n'
  /usr/bin/python3 -B "$root/examples/recordings/icub_slide20.py" \
    "$data/icub_slide20" icub
  sed -i -n -e 1p -e '3~3p' icub/trials.csv
  show import icub --out=icub.h5
  chosen icub.h5 loco
  printf '\n## Simulated objects, each material left out\n'
  show simulate --protocol=grid --sample=240 --skin=good --seed=5 --out=grid.h5
  chosen grid.h5 leave-one-material-out
}

paper-tables() {
  title "The paper's tables" "none, ideal signals (simulation); good (Cody)" \
    "contacts and training 1 to 5, the same number for both" \
    "the 1,835 contacts of the paper's set and the 240 of Cody, all of them felt"
  printf '\n```\n'
  local runs=()
  # reproduced NAME FLAGS...
  reproduced() {
    printf '$ trainctl reproduce %s --json >%s.json\n' "${*:2}" "$1"
    "$trainctl" reproduce "${@:2}" --json >"$1.json"
    runs+=("$1.json")
  }
  reproduced relative-1 --seed=1 --figures=paper-tables
  for seed in 2 3 4 5; do
    reproduced "relative-$seed" --seed="$seed"
  done
  for seed in 1 2 3 4 5; do
    reproduced "absolute-$seed" --seed="$seed" --noise=absolute --experiment=simulation
  done
  printf '$ research/paper_tables.py {relative,absolute}-{1,2,3,4,5}.json\n```\n'
  /usr/bin/python3 -B "$research/paper_tables.py" "${runs[@]}"
  mkdir -p "$out/paper-tables"
  cp paper-tables/*-accuracy.png paper-tables/*-f-m-a.png "$out/paper-tables"
}

# Why the paper's tables differ from ours: the same rows, made in other ways.
explanations() {
  title "The paper's tables: what explains the differences" "${paper_signals[@]}"
  printf '\nOne robot condition is left out, as in [the tables](paper-tables.md), and every way is tried on the same contacts.\n\n## HMMs\n\n```\n'
  quietly simulate --protocol=paper --goal=0.019 --seed=1 --out=signals.h5
  printf '$ paper-hmms --data=signals.h5\n```\n\n'
  "$bin/paper-hmms" --data=signals.h5 2>/dev/null
  cat <<'EOT'

- *As reproduced:* in the tables, our HMMs' smallest variance is 1e-3 of the scaled
  feature's, and Baum-Welch updates them at most 15 times.
- *Floor:* another smallest variance, and more updates.
- *Any state follows any:* without the order of the states.
- *libghmm:* the paper's library updates the same initial HMMs and finds the best paths.
  A broken HMM holds a NaN or an invalid covariance after that. A contact is refused if
  libghmm finds no path in the HMM of the contact's own class; such answers count as
  wrong.
- *One feature not scaled:* the paper scales features that are combined.

## 1-NN

```
EOT
  reference paper/paper_nearest.py signals.h5
}

# Processor times are this machine's; their ratios are what counts.
simulator() {
  title "The contact simulator: error and work" "none, signals without noise" \
    "none, the random scenes are always the same" \
    "the contacts of each sample, as its line says"
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

# fingerprint PAGE: of all that the page is made by and from.
fingerprint() {
  local text name
  text=$(
    declare -f show quietly world_signals reference title commas compare taxel_nearest "$1"
    declare -p paper_signals
  )
  {
    echo "$text"
    cat "$trainctl" "$bench" "$bin"/{world-signals,paper-hmms} \
      server/registry/*.tactus research/*.py \
      research/{upper,paper}/*.py examples/recordings/*.py
    for name in "${!TACTUS_@}"; do
      [[ $text != *"$name"* ]] || echo "$name=${!name}"
    done
    if [[ $text == *'$data'* ]]; then
      find "$data" -type f -print0 | LC_ALL=C sort -z | xargs -0r sha256sum
    fi
  } | sha256sum
}

# write PAGE: in a folder of its own.
write() (
  mkdir -p "$out" "$work/$page"
  cp "$root"/server/registry/*.tactus "$work/$page"
  cd "$work/$page"
  "$page" >"$work/$page.md"
  # The folder of this run is no one else's business.
  sed "s#$out#research/results#g" "$work/$page.md" >"$out/$page.md"
  mkdir -p "$research/results"
  cp -r "$out/." "$research/results"
  rm -r "$out" "${work:?}/$page"
)

pages=("$@")
[[ $# -gt 0 ]] || pages=("${all_pages[@]}")
for page in "${pages[@]}"; do
  if [[ " ${all_pages[*]} ${named_pages[*]} " != *" $page "* ]]; then
    echo "make-results: unknown page '$page'" >&2
    exit 2
  fi
  if [[ $page == eflesh && ! -f ${TACTUS_EFLESH_DIR:-}/labels ]]; then
    echo "make-results: eflesh: TACTUS_EFLESH_DIR is '${TACTUS_EFLESH_DIR:-}'; it must be the folder" \
      "slip_detection/data of the repository notvenky/eFlesh" >&2
    exit 2
  fi
done

for program in "$trainctl" "$bench" "$bin"/{world-signals,paper-hmms}; do
  if [[ ! -x $program ]]; then
    echo "make-results: $program is missing: build the preset 'release'" >&2
    exit 1
  fi
done

mkdir -p "$stamps"
written=0
for page in "${pages[@]}"; do
  now=$(fingerprint "$page")
  if [[ $# -eq 0 && -f research/results/$page.md &&
    $now == "$(cat "$stamps/$page" 2>/dev/null)" ]]; then
    echo "make-results: $page: left alone, this build has written it" >&2
    continue
  fi
  began=$SECONDS
  writing=$page
  write
  writing=
  echo "$now" >"$stamps/$page"
  written=$((written + 1))
  echo "make-results: $page: written in $((SECONDS - began)) s" >&2
done
echo "make-results: $written of ${#pages[@]} pages written in $SECONDS s" >&2
