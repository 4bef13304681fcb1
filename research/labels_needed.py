#!/usr/bin/python3
"""How many labels a model needs to learn a material that it has not met.

    research/labels_needed.py TRAINCTL MATERIALS [--repetitions=20] [--folder=FOLDER]

A model of simulated contacts without one material answers other contacts, most of them
with that material. Some of these get their labels, and a model is trained again with
them: those that were answered with the least certainty, as the contact log lists them, or
some by chance. Then both models answer contacts with the material on arms of other
stiffnesses. MATERIALS is core/sim/model/materials.csv. With --folder, repetitions that are
done are kept there, and an interrupted run goes on when it is started again.

Prints a table in Markdown; progress goes to stderr.
"""

import argparse
import csv
import dataclasses
import hashlib
import json
import math
import os
import pathlib
import random
import statistics
import subprocess
import sys
import tempfile

import h5py
from scipy.stats import t as student

MATERIAL = "natural-rubber"
LABELS = [10, 20, 30, 60, 120]
TRAINING_ARMS = ["250", "630", "1600", "4000"]
LOGGED_ARMS = ["250", "1600"]
HELD_OUT_ARMS = ["630", "4000"]
# Seeds between two repetitions.
STRIDE = 10


@dataclasses.dataclass
class Set:
    """Contacts of --protocol=grid."""

    is_new: bool
    arms: list
    contacts: int


# Those of the first model, then those that it answers.
SETS = [
    Set(False, TRAINING_ARMS, 160),
    Set(False, LOGGED_ARMS, 240),
    Set(True, LOGGED_ARMS, 60),
]
HELD_OUT = Set(True, HELD_OUT_ARMS, 100)


class Study:
    def __init__(self, trainctl, materials, folder):
        self.trainctl = trainctl
        self.folder = folder
        lines = [
            line
            for line in materials.read_text(encoding="utf-8").splitlines()
            if line and not line.startswith("#")
        ]
        for name, is_new in (("new.csv", True), ("known.csv", False)):
            rows = [line for line in lines[1:] if line.startswith(MATERIAL + ",") == is_new]
            (folder / name).write_text("\n".join([lines[0], *rows, ""]), encoding="utf-8")

    def run(self, *words):
        done = subprocess.run(
            [self.trainctl, *words], stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True
        )
        if done.returncode != 0:
            sys.exit(f"labels_needed: trainctl {' '.join(words)}\n{done.stderr}")
        return done.stdout

    def simulate(self, contacts, seed, out):
        self.run(
            "simulate",
            "--protocol=grid",
            "--skin=good",
            f"--materials={self.folder / ('new.csv' if contacts.is_new else 'known.csv')}",
            "--stiffness",
            *contacts.arms,
            f"--sample={contacts.contacts}",
            f"--seed={seed}",
            f"--out={out}",
        )

    def fit(self, data, where, out):
        self.run(
            "fit",
            f"--data={data}",
            f"--where={where}",
            "--preset=paper",
            "--networks=0",
            "--seed=1",
            f"--out={out}",
        )

    def answers(self, data, model, where=None):
        """{trial: (right, certainty)} of the contacts that the skin felt."""
        path = self.folder / "answers.csv"
        words = ["evaluate", f"--data={data}", f"--model={model}", f"--answers={path}"]
        self.run(*words, *([f"--where={where}"] if where else []))
        with open(path, encoding="utf-8", newline="") as file:
            return {
                row["trial"]: (
                    row["answer"] == row["label"],
                    float(row["probability_" + row["answer"]]),
                )
                for row in csv.DictReader(file)
            }

    def repetition(self, number):
        """{"before": errors, "least certain": [errors, ...], "chance": [...], ...}."""
        seed = STRIDE * number
        data, held_out = self.folder / "all.h5", self.folder / "held-out.h5"
        parts = [self.folder / f"{place}.h5" for place in range(len(SETS))]
        for place, contacts in enumerate(SETS):
            self.simulate(contacts, seed + place, parts[place])
        self.simulate(HELD_OUT, seed + len(SETS), held_out)
        join(parts, data)

        known = f"trial < {SETS[0].contacts}"
        model = self.folder / "model.tactus"
        self.fit(data, known, model)
        before = self.answers(held_out, model)
        logged = self.answers(data, model, f"not {known}")
        by_chance = sorted(logged)
        random.Random(seed).shuffle(by_chance)
        orders = {
            "least certain": sorted(logged, key=lambda trial: (logged[trial][1], trial)),
            "chance": by_chance,
        }
        errors = {
            "before": sum(not right for right, _ in before.values()),
            "of": len(before),
            "logged": len(logged),
            "all": self.errors_with(data, held_out, known, by_chance),
        }
        for way, order in orders.items():
            errors[way] = [
                self.errors_with(data, held_out, known, order[:count]) for count in LABELS
            ]
        return errors

    def errors_with(self, data, held_out, known, trials):
        model = self.folder / "model.tactus"
        self.fit(data, f"{known} or trial in ({', '.join(sorted(trials))})", model)
        return sum(not right for right, _ in self.answers(held_out, model).values())


def join(parts, out):
    """The trials of all parts, in their order, as one trial file."""
    with h5py.File(out, "w") as file:
        trials = file.create_group("trials")
        for path in parts:
            with h5py.File(path) as part:
                for name, value in part.attrs.items():
                    file.attrs[name] = value
                for trial in part["trials"]:
                    part.copy(f"trials/{trial}", trials, f"{len(trials):06}")


def interval(values):
    """Mean, and half the width of its 95 % interval."""
    if len(values) < 2:
        return statistics.mean(values), math.nan
    error = statistics.stdev(values) / math.sqrt(len(values))
    return statistics.mean(values), student.ppf(0.975, len(values) - 1) * error


def shown(values):
    mean, half = interval(values)
    return f"{mean:.1f} ± {half:.1f}"


def table(repetitions):
    of, before, everything = (
        [repetition[name] for repetition in repetitions] for name in ("of", "before", "all")
    )
    lines = [
        "| labels | errors, by chance | errors, least certain first | difference, pairs |",
        "|---|---|---|---|",
        f"| 0 | {shown(before)} | {shown(before)} | |",
    ]
    for place, count in enumerate(LABELS):
        chance = [repetition["chance"][place] for repetition in repetitions]
        certain = [repetition["least certain"][place] for repetition in repetitions]
        pairs = [a - b for a, b in zip(certain, chance)]
        lines.append(f"| {count} | {shown(chance)} | {shown(certain)} | {shown(pairs)} |")
    logged = statistics.mean(repetition["logged"] for repetition in repetitions)
    lines.append(f"| all {logged:.0f} | {shown(everything)} | {shown(everything)} | |")
    lines.append("")
    lines.append(
        f"{len(repetitions)} repetitions; errors of {statistics.mean(of):.0f} held-out "
        "contacts, mean and 95 % interval."
    )
    return lines


def identity(*paths):
    digest = hashlib.sha256()
    for path in paths:
        digest.update(pathlib.Path(path).read_bytes())
    return digest.hexdigest()


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("trainctl")
    parser.add_argument("materials", type=pathlib.Path)
    parser.add_argument("--repetitions", type=int, default=20)
    parser.add_argument("--folder", type=pathlib.Path)
    arguments = parser.parse_args()
    with tempfile.TemporaryDirectory() as scratch:
        study = Study(arguments.trainctl, arguments.materials, pathlib.Path(scratch))
        kept = arguments.folder
        if kept is not None:
            kept.mkdir(parents=True, exist_ok=True)
            made_by = identity(arguments.trainctl, arguments.materials, __file__)
        repetitions = []
        for number in range(1, arguments.repetitions + 1):
            path = kept and kept / f"{number}-{made_by}.json"
            if path is not None and path.exists():
                repetitions.append(json.loads(path.read_text(encoding="utf-8")))
                continue
            errors = study.repetition(number)
            print(f"repetition {number}: {json.dumps(errors)}", file=sys.stderr, flush=True)
            if path is not None:
                part = path.with_suffix(".part")
                part.write_text(json.dumps(errors), encoding="utf-8")
                os.replace(part, path)
            repetitions.append(errors)
    print("\n".join(table(repetitions)))


if __name__ == "__main__":
    main()
