#!/usr/bin/python3
"""Writes docs/own-skins.md: what trainctl makes of recordings of skins it did not know.

    research/own_skins.py TRAINCTL FOLDER [--seeds=5] >docs/own-skins.md
    research/own_skins.py TRAINCTL FOLDER --only=eflesh     one set: its rows and its part

FOLDER holds a folder and a trial file of each set, fabric and fabric.h5 and so on. They
are made by the scripts of examples/recordings and by `trainctl import`:

    cd FOLDER
    fabric_slide.py FABRIC_SLIDE/data/fabric fabric
    biotac_slip.py BIOTAC_SP_DOS/csvs slip
    icub_grasp.py ICUB_GRASP/iCubGraspDataset grasp
    eflesh.py EFLESH/slip_detection/data eflesh
    icub_slide20.py ICUB_SLIDE20 icub_slide20
    vitac384.py VITAC384 vitac384
    ln -s VITAC384/trials vitac384/trials       with an absolute path
    cp -r vitac384 pads
    sed -n -e '1s/,object,.*/,group/p' -e 's/,\\([a-z]*_rubber\\),.*/,\\1/p' \\
      vitac384/trials.csv >pads/trials.csv
    for set in fabric slip grasp eflesh icub_slide20 vitac384 pads; do
      trainctl import $set --out=$set.h5
    done

Each run of `trainctl evaluate` is kept in FOLDER/results, so an interrupted run goes on
when it is started again. A kept result is used if program, trials and flags are the
same ones; do not rebuild the program meanwhile. A named preset that is refused is a row
that says so, and is tried again the next time. The page is printed at the end, progress
goes to stderr.
"""

import argparse
import collections
import csv
import dataclasses
import hashlib
import json
import pathlib
import resource
import statistics
import subprocess
import sys

import binned_nearest
from intervals import wilson

PRESETS = ["ridge", "trees", "nearest", "pattern", "whole-skin", "profile"]
MOMENTS = ["0.25", "0.5", "1.2"]
NAMED_SEED = 1  # of the runs with a named preset


@dataclasses.dataclass
class Split:
    name: str
    flags: list
    published: str


@dataclasses.dataclass
class Set:
    name: str
    title: str
    source: str
    licence: str
    skin: str
    rate: str
    made: list
    remarks: str
    splits: list


def loco(name, published):
    return Split(name, ["--protocol=loco"], published)


def groups(name, published):
    return Split(name, ["--protocol=leave-one-material-out"], published)


def k_fold(folds, published):
    return Split(f"{folds} folds", ["--protocol=k-fold", f"--folds={folds}"], published)


EFLESH_PUBLISHED = "95 (its paper, another split)"
ICUB_PUBLISHED = "96.5 (1-NN with statistics of each taxel; split not stated)"

SETS = [
    Set(
        "fabric",
        "FabricSlide: fabrics under a sliding finger",
        "`data/fabric` of the public repository wngfra/FabricSlide (Wang et al., Frontiers in "
        "Neurorobotics 16:808222, 2022)",
        "MIT",
        "capacitive finger, 16 taxels as 4 x 4",
        "35.6 Hz, from the times of the files",
        ["examples/recordings/fabric_slide.py $FABRIC_SLIDE/data/fabric fabric"],
        "A slide lasts 4 to 59 s. Each fabric was recorded in one stretch of time, so what "
        "drifted is confounded with the class. Two fabrics slide in one direction only, and "
        "three lack some of the five forces.",
        [loco("a force left out", "up to 96 (k-NN, another split)")],
    ),
    Set(
        "slip",
        "BioTacSP-DoS: direction of slip",
        "`csvs` of the public repository yayaneath/BioTacSP-DoS (Zapata-Impata et al., Sensors "
        "19(3):523, 2019)",
        "none stated",
        "BioTac SP, 24 electrodes as 4 x 6",
        "100 Hz, by its README",
        ["examples/recordings/biotac_slip.py $BIOTAC_SP_DOS/csvs slip"],
        "Six directions of slip and a stable touch, on 11 objects. A recording is all slip, so "
        "it has no onset.",
        [groups("an object left out", "82.6 (50 ms of data, another split)")],
    ),
    Set(
        "grasp",
        "iCub Grasp Dataset: objects in the hand",
        "`iCubGraspDataset` of the public repository clear-nus/icub_grasp_dataset (Soh et al., "
        "IROS 2012)",
        "copyright 2012 Harold Soh; free to use and distribute with that notice",
        "capacitive fingertips, 60 taxels as 5 x 12",
        "50 Hz, assumed; a grasp has 4 to 22 frames",
        ["examples/recordings/icub_grasp.py $ICUB_GRASP/iCubGraspDataset grasp"],
        "Without full_coke, which its README calls unreliable. A session is a run of five "
        "grasps of an object in a row. The grasps of one object seem to have been recorded "
        "together, and readings of the open hand drift: the first frame, before any grip, gives "
        "most objects away. So these figures say little about a grasp on another day.",
        [groups("a session left out", "none of this split")],
    ),
    Set(
        "eflesh",
        "eFlesh: slip",
        "`slip_detection/data` of the public repository notvenky/eFlesh (arXiv 2506.09994)",
        "MIT",
        "two pads of five magnetometers of three axes",
        "100 Hz",
        ["examples/recordings/eflesh.py $EFLESH/slip_detection/data eflesh"],
        "Sequences of 3 s. Labels come in blocks, so what changed between sessions is "
        "confounded with the class; in the second split each fold holds one of the two blocks "
        "of `one`. More on it: [results/eflesh.md](../research/results/eflesh.md).",
        [k_fold(10, EFLESH_PUBLISHED), loco("a block left out", EFLESH_PUBLISHED)],
    ),
    Set(
        "icub_slide20",
        "icub_slide20: materials under a sliding finger",
        "dexrob/BioTac_slide_20_50 (Gao et al., IROS 2020), 680 of its recordings",
        "none stated",
        "capacitive, 6 triangles of 10 taxels",
        "50 Hz, assumed",
        ["examples/recordings/icub_slide20.py $ICUB_SLIDE20 icub_slide20"],
        "The finger touches the material from the first frame on. "
        "More on it: [recordings.md](../research/recordings.md).",
        [k_fold(5, ICUB_PUBLISHED), loco("a part left out", ICUB_PUBLISHED)],
    ),
    Set(
        "vitac384",
        "vitac384: hard or soft, pressed or slid",
        "jsheng45/ViTac-Tactile-Sensing, 43 of its recordings",
        "CC BY-NC 4.0, by the line of its readme on FlexiTac (c) 2025 Columbia University",
        "piezoresistive, 12 x 32",
        "100 Hz, some 30 of the frames new",
        [
            "examples/recordings/vitac384.py $VITAC384 vitac384",
            "ln -s $VITAC384/trials vitac384/trials",
        ],
        "All 43 are of one day, so no day can be left out. "
        "More on it: [recordings.md](../research/recordings.md).",
        [Split("one left out", ["--protocol=leave-one-out"], "none of these 43")],
    ),
    Set(
        "pads",
        "vitac384: a rubber pad left out",
        "the recordings of vitac384 with one of its two rubber pads",
        "as vitac384",
        "piezoresistive, 12 x 32",
        "100 Hz, some 30 of the frames new",
        [
            "cp -r vitac384 pads",
            "sed -n -e '1s/,object,.*/,group/p' -e 's/,\\([a-z]*_rubber\\),.*/,\\1/p' "
            "vitac384/trials.csv >pads/trials.csv"
        ],
        "Both classes are hard, so this asks only whether the pad slid. That is easier than "
        "the table of [recordings.md](../research/recordings.md), whose models also know foam.",
        [groups("a pad left out", "none of this split")],
    ),
]


class Runner:
    """Runs trainctl evaluate, or takes the result that a former run has kept."""

    def __init__(self, trainctl, folder):
        self.trainctl = trainctl
        self.folder = folder
        self.program = digest(trainctl)
        self.trials = {}
        (folder / "results").mkdir(exist_ok=True)

    def evaluate(self, name, flags, preset, seed):
        """The JSON of an evaluation and its CPU-seconds.

        {"refused": why} if trainctl refuses a named preset.
        """
        if name not in self.trials:
            self.trials[name] = digest(self.folder / f"{name}.h5")
        command = evaluation(name, flags, preset, seed)
        made_by = [self.program, self.trials[name], command]
        protocol = flags[0].removeprefix("--protocol=")
        kept = self.folder / "results" / f"{name}-{protocol}-{preset or 'default'}-{seed}.json"
        if kept.exists():
            former = json.loads(kept.read_text())
            if former["made_by"] == made_by:
                report(f"{kept.stem}: kept")
                return with_cpu_seconds(former)
        report(f"{kept.stem}: runs")
        before = cpu_seconds_of_children()
        run = subprocess.run(
            [self.trainctl, *command],
            cwd=self.folder,
            capture_output=True,
            text=True,
            check=False,
        )
        cpu_seconds = cpu_seconds_of_children() - before
        if run.returncode != 0:
            why = (run.stderr.strip().splitlines() or ["no message"])[-1]
            if not preset or run.returncode < 0:
                sys.exit(f"own_skins: {kept.stem}: trainctl {' '.join(command)}: {why}")
            report(f"{kept.stem}: refused: {why}")
            return {"refused": why.removeprefix("trainctl: ")}
        made = {
            "made_by": made_by,
            "cpu_seconds": cpu_seconds,
            "result": json.loads(run.stdout),
        }
        # Whole or not at all.
        unfinished = kept.with_suffix(".unfinished")
        unfinished.write_text(json.dumps(made))
        unfinished.replace(kept)
        result = with_cpu_seconds(made)
        report(f"{kept.stem}: {percent(result['accuracy'])} % in {cpu_seconds:.0f} CPU s")
        return result


def with_cpu_seconds(kept):
    return kept["result"] | {"cpu_seconds": kept["cpu_seconds"]}


def cpu_seconds_of_children():
    """User and system time of all programs that this one has waited for."""
    usage = resource.getrusage(resource.RUSAGE_CHILDREN)
    return usage.ru_utime + usage.ru_stime


def report(text):
    print(f"own_skins: {text}", file=sys.stderr, flush=True)


def digest(path):
    with open(path, "rb") as file:
        return hashlib.file_digest(file, "sha256").hexdigest()


def evaluation(name, flags, preset, seed):
    preset = [f"--preset={preset}"] if preset else []
    return ["evaluate", f"--data={name}.h5", *flags, *preset, f"--seed={seed}", "--json"]


def percent(fraction):
    return f"{100 * fraction:.2f}"


def spread(values, text):
    """The mean of the values, and the smallest and largest in brackets."""
    return f"{text(statistics.mean(values))} ({text(min(values))} to {text(max(values))})"


def row(*cells):
    return f"| {' | '.join(cells)} |"


def interval_of(result):
    low, high = result["accuracy_interval"]
    return f"{percent(result['accuracy'])} ({percent(low)} to {percent(high)})"


def surer(area):
    return "-" if area is None else f"{area:.2f}"


def learner_row(learner, result):
    if "refused" in result:
        return row(learner, f"refused: {result['refused']}", *["-"] * 7)
    sure = result["selective"]
    return row(
        learner,
        interval_of(result),
        f"{result['ece']:.3f}",
        f"{sure['answered']}, {sure['right']} right",
        surer(sure["auroc"]),
        *[percent(result["accuracy_at"][moment]) for moment in MOMENTS],
        f"{result['cpu_seconds']:.0f}",
    )


def seeds_row(results):
    def over(key, text):
        return spread([key(result) for result in results], text)

    def count(value):
        return f"{value:.0f}"

    areas = [result["selective"]["auroc"] for result in results]
    areas = [area for area in areas if area is not None]
    return row(
        f"default, seeds 1 to {len(results)}: mean (smallest to largest)",
        over(lambda r: r["accuracy"], percent),
        over(lambda r: r["ece"], "{:.3f}".format),
        f"{over(lambda r: r['selective']['answered'], count)}, "
        f"{over(lambda r: r['selective']['right'], count)} right",
        spread(areas, surer) if areas else "-",
        *[over(lambda r, at=at: r["accuracy_at"][at], percent) for at in MOMENTS],
        over(lambda r: r["cpu_seconds"], count),
    )


def chosen_text(results):
    """The presets that the runs of the default chose, and how often."""
    counts = collections.Counter(result["preset"] for result in results).most_common()
    if len(counts) == 1:
        return f"`{counts[0][0]}`"
    return ", ".join(f"`{preset}` in {count}" for preset, count in counts) + " of the runs"


def fall(result):
    """How much larger the accuracy was at its best moment than it is in the end."""
    return max(result["accuracy"], *result["accuracy_at"].values()) - result["accuracy"]


def fall_line(results):
    falls = [fall(result) for result in results]
    return (
        f"The largest fall from an earlier moment to the end: {percent(falls[0])} points "
        f"(seed 1), {percent(max(falls))} (largest of the seeds)."
    )


def constant(result):
    """What the most frequent class as the only answer gives."""
    classes = [sum(answers) for answers in result["confusion"]]
    return wilson(max(classes), sum(classes))


def setting_text(setting):
    view, standardised = setting
    return f"{view}, {'standardised' if standardised else 'as it is'}"


@dataclasses.dataclass
class Measured:
    defaults: list
    named: dict
    nearest: dict
    count: int

    def ends(self):
        """The settings of 1-NN with the most and with the least right answers."""
        ranked = sorted(
            (s for s in self.nearest if s[0] != binned_nearest.FIRST), key=self.nearest.get
        )
        return ranked[-1], ranked[0]

    def nearest_text(self, setting):
        return wilson(self.nearest[setting], self.count)


def measure(runner, each, split, seeds):
    defaults = [runner.evaluate(each.name, split.flags, None, s) for s in range(1, seeds + 1)]
    named = {p: runner.evaluate(each.name, split.flags, p, NAMED_SEED) for p in PRESETS}
    trials = binned_nearest.Trials(runner.folder / each.name)
    protocol = split.flags[0].removeprefix("--protocol=")
    count = [int(flag.removeprefix("--folds=")) for flag in split.flags[1:]]
    folds = binned_nearest.folds_of(trials, protocol, *count)
    return Measured(defaults, named, binned_nearest.settings(trials, folds), len(folds))


def choice_lines(result):
    """The inner comparison by which the default chose its preset."""
    choice = result.get("choice")
    if not choice:
        return ["", "No presets were compared."]
    lines = [
        "",
        f"What chose for seed {result['seed']}, among {choice['contacts']} contacts in "
        f"{choice['folds']} inner folds:",
        "",
        "| preset | right in inner folds, % | standard error, points | |",
        "|---|---|---|---|",
    ]
    for candidate in result["candidates"]:
        mark = "chosen" if candidate["chosen"] else ""
        error = percent(candidate["standard_error"])
        lines.append(row(candidate["name"], percent(candidate["accuracy"]), error, mark))
    lines.append(row("1-NN on summaries", percent(choice["nearest_accuracy"]), "-", ""))
    lines.append(row("chance", percent(choice["chance"]), "-", ""))
    return lines


def commands(each, split, seeds):
    lines = ["```"]
    lines += [f"$ {command}" for command in each.made]
    lines.append(f"$ trainctl import {each.name} --out={each.name}.h5")
    for seed in range(1, seeds + 1):
        lines.append(f"$ trainctl {' '.join(evaluation(each.name, split.flags, None, seed))}")
    for preset in PRESETS:
        command = evaluation(each.name, split.flags, preset, NAMED_SEED)
        lines.append(f"$ trainctl {' '.join(command)}")
    lines.append(f"$ research/binned_nearest.py {each.name} {' '.join(split.flags)}")
    return lines + ["```"]


def split_lines(each, split, measured):
    first = measured.defaults[0]
    best, worst = measured.ends()
    rest = ["-"] * 7
    lines = [
        "",
        f"### Split: {split.name}",
        "",
        *commands(each, split, len(measured.defaults)),
        "",
        f"{first['felt']} of {first['trials']} trials were felt. The default chose "
        f"{chosen_text(measured.defaults)}.",
        "",
        "| learner | right, % (95 % interval) | calibration error | sure answers "
        "| right surer than wrong | 0.25 s, % | 0.5 s, % | 1.2 s, % | CPU s |",
        "|---|---|---|---|---|---|---|---|---|",
        learner_row(f"default, seed 1: `{first['preset']}`", first),
        seeds_row(measured.defaults),
    ]
    lines += [learner_row(f"`{preset}`", result) for preset, result in measured.named.items()]
    lines.append(row(f"1-NN, best: {setting_text(best)}", measured.nearest_text(best), *rest))
    lines.append(row(f"1-NN, worst: {setting_text(worst)}", measured.nearest_text(worst), *rest))
    first_frame = measured.nearest_text((binned_nearest.FIRST, False))
    lines.append(row("1-NN on the first touched frame", first_frame, *rest))
    lines.append(row("constant answer", constant(first), *rest))
    lines.append(row("published", split.published, *rest))
    lines += ["", fall_line(measured.defaults)]
    lines += choice_lines(first)
    lines += ["", "All settings of 1-NN in the same folds:", ""]
    lines += binned_nearest.table(measured.nearest, measured.count)
    return lines


def labels_of(folder):
    with open(folder / "trials.csv", newline="", encoding="utf-8") as table:
        return collections.Counter(row["label"] for row in csv.DictReader(table))


def set_lines(folder, each):
    labels = labels_of(folder / each.name)
    classes = ", ".join(f"{label} {count}" for label, count in sorted(labels.items()))
    return [
        "",
        f"## {each.title}",
        "",
        "| | |",
        "|---|---|",
        row("source", each.source),
        row("licence", each.licence),
        row("trials", str(sum(labels.values()))),
        row("classes", f"{len(labels)}: {classes}"),
        row("skin", each.skin),
        row("rate", each.rate),
        row("splits", ", ".join(split.name for split in each.splits)),
        "",
        each.remarks,
    ]


def head(rows):
    return [
        "# Recordings of other skins",
        "",
        "What `trainctl` makes of recordings of skins that it was not made for, without a word "
        "about them but what the import needs. None of the recordings is part of this "
        "repository. Written by [`research/own_skins.py`](../research/own_skins.py), whose head "
        "says how to make this page again.",
        "",
        "- *right*: the answer after the last frame, of the trials that were felt. Brackets "
        "behind a single figure are its 95 % interval by Wilson.",
        "- *default*: no preset is named. The interval of seed 1 is about other trials; the "
        "smallest and largest of the seeds are about other random choices.",
        "- *sure answers*: those in the end with a probability of at least 0.95.",
        "- *right surer than wrong*: the fraction of pairs of a right and a wrong answer in which "
        "the right one has the larger probability (AUROC). 0.5 is chance.",
        "- *0.25 s* and so on: the answer after that time, or the last one if a trial is shorter.",
        "- *largest fall*: *right* at the best moment up to 5 s, or in the end if that is better, "
        "minus *right* in the end.",
        "- *CPU s*: CPU-seconds of the whole evaluation, all folds and inner comparisons, on one "
        "machine.",
        "- *1-NN*: [`research/binned_nearest.py`](../research/binned_nearest.py), one nearest "
        "neighbour on ten time bins of all taxels, in eight settings. The best of them is picked "
        "with the answers in sight, so it is too good; a single setting taken beforehand lies "
        "between worst and best.",
        "- *1-NN on the first touched frame*: if it is good, the classes differ from the "
        "beginning, by what is touched or only by the session. A new session may look "
        "otherwise.",
        "- *published*: figures of others, by other splits. They stand beside ours and are not "
        "to be compared with them.",
        "",
        "| set | split | default, % | 1-NN, worst to best, % | constant, % | published, % |",
        "|---|---|---|---|---|---|",
        *rows,
    ]


def summary_row(each, split, measured):
    best, worst = measured.ends()
    accuracies = [result["accuracy"] for result in measured.defaults]
    ends = [percent(measured.nearest[s] / measured.count) for s in (worst, best)]
    return row(
        each.name,
        split.name,
        spread(accuracies, percent),
        " to ".join(ends),
        constant(measured.defaults[0]).split()[0],
        split.published,
    )


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("trainctl", type=pathlib.Path)
    parser.add_argument("folder", type=pathlib.Path)
    parser.add_argument("--seeds", type=int, default=5, help="runs of the default")
    parser.add_argument("--only", choices=[s.name for s in SETS], help="print its part alone")
    flags = parser.parse_args()
    folder = flags.folder.resolve()
    sets = [s for s in SETS if flags.only in (None, s.name)]
    needed = [f for s in sets for f in (f"{s.name}.h5", f"{s.name}/skin.json")]
    missing = [file for file in needed if not (folder / file).exists()]
    if missing:
        sys.exit(
            f"own_skins: {folder} lacks {', '.join(missing)}; the head of this program says "
            "how to make it"
        )
    runner = Runner(flags.trainctl.resolve(), folder)
    rows, lines = [], []
    for each in sets:
        lines += set_lines(folder, each)
        for split in each.splits:
            measured = measure(runner, each, split, flags.seeds)
            rows.append(summary_row(each, split, measured))
            lines += split_lines(each, split, measured)
    print("\n".join((rows if flags.only else head(rows)) + lines))


if __name__ == "__main__":
    main()
