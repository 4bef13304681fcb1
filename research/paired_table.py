#!/usr/bin/python3
"""Compares answers to the same trials, as a Markdown table.

    paired_table.py [--spread] all.csv without-area.csv ...

The files are those of `trainctl evaluate --answers=FILE.csv`. Each file is compared
with the first one by the trials that only one of them answers rightly, and by McNemar's
exact test of them: how probable so uneven a split is if both are equally good. With
--spread, a line below the table has mean and standard deviation of the accuracies.
"""

import csv
import math
import os
import statistics
import sys

from intervals import wilson

SMALLEST = 1e-12  # of a probability, as in core/eval/metrics.h


def read(path):
    """{trial: (label, right, log loss)} of a file of answers."""
    with open(path, encoding="utf-8", newline="") as file:
        answers = {}
        for row in csv.DictReader(file):
            probability = float(row["probability_" + row["label"]])
            loss = -math.log(max(probability, SMALLEST))
            answers[row["trial"]] = (row["label"], row["answer"] == row["label"], loss)
    return answers


def refuse_unless_same_trials(first, other, names):
    for trial in sorted(first.keys() | other.keys()):
        if first.get(trial, ("no such trial",))[0] != other.get(trial, ("no such trial",))[0]:
            sys.exit(f"paired_table: trial {trial} differs between {names[0]} and {names[1]}")


def mcnemar(gained, lost):
    """Probability of a split at least so uneven, either way, by fair coins."""
    both = gained + lost
    ways = tail = 1  # to choose k of both, and their sum
    for k in range(1, min(gained, lost) + 1):
        ways = ways * (both - k + 1) // k
        tail += ways
    return min(1.0, 2 * tail / 2**both)


def name(path):
    return os.path.basename(path).removesuffix(".csv")


def table(paths):
    """The lines of the table, and the accuracies in per cent."""
    answers = [read(path) for path in paths]
    first = answers[0]
    lines = [
        f"| answers | trials | right, % | log loss | right, {name(paths[0])} wrong "
        f"| wrong, {name(paths[0])} right | p (McNemar) |",
        "|---|---|---|---|---|---|---|",
    ]
    accuracies = []
    for path, other in zip(paths, answers):
        refuse_unless_same_trials(first, other, (paths[0], path))
        right = sum(answer[1] for answer in other.values())
        accuracies.append(100 * right / len(other))
        loss = sum(answer[2] for answer in other.values()) / len(other)
        gained = sum(other[trial][1] and not first[trial][1] for trial in first)
        lost = sum(first[trial][1] and not other[trial][1] for trial in first)
        paired = "- | - | -" if other is first else f"{gained} | {lost} | {mcnemar(gained, lost):.2g}"
        lines.append(
            f"| {name(path)} | {len(other)} | {wilson(right, len(other))} | {loss:.4f} | {paired} |"
        )
    return lines, accuracies


def main():
    arguments = sys.argv[1:]
    spread = "--spread" in arguments
    paths = [argument for argument in arguments if argument != "--spread"]
    if len(paths) < 2:
        sys.exit("paired_table: got fewer than two files of answers")
    lines, accuracies = table(paths)
    print("\n".join(lines))
    if spread:
        print(
            f"\nMean {statistics.mean(accuracies):.2f} %, standard deviation "
            f"{statistics.stdev(accuracies):.2f} points, of {len(paths)}."
        )


if __name__ == "__main__":
    main()
