#!/usr/bin/python3
r"""How well boosted trees classify contacts of the random world, beside a bundle.

    world-signals --data=world:skin=good,contacts=30000,seed=2 \
      --model=default.tactus --out=train
    world-signals --data=world:skin=good,contacts=20000,seed=1001 \
      --model=default.tactus --out=test
    upper_reference.py --oracle train test

Trains scikit-learn's HistGradientBoostingClassifier on summaries of the contacts
in the first folder and prints its accuracy on those in the second, as rows of a
Markdown table. With --oracle also on the simulator's signals, without skin and
noise.
"""

import argparse
import math
import sys

import numpy as np
from sklearn.ensemble import HistGradientBoostingClassifier

from summaries import Contacts

# What is asked, and until which time after the onset.
QUESTIONS = [(5.0, False), (1.2, True), (1.2, False)]


def wilson(right, count):
    """The 95 % interval of Wilson's score, as trainctl evaluate prints it."""
    z = 1.959963984540054
    p = right / count
    middle = (p + z * z / (2 * count)) / (1 + z * z / count)
    half = z / (1 + z * z / count) * math.sqrt(p * (1 - p) / count + z * z / (4 * count**2))
    return middle - half, middle + half


def cell(answers, labels):
    right = int((answers == labels).sum())
    low, high = wilson(right, len(labels))
    return f"{100 * right / len(labels):.2f} ({100 * low:.2f} to {100 * high:.2f})"


def trees(table, labels, iterations):
    learner = HistGradientBoostingClassifier(
        max_iter=iterations,
        learning_rate=0.15,
        max_leaf_nodes=31,
        l2_regularization=1.0,
        early_stopping=False,
        random_state=1,
    )
    return learner.fit(table, labels)


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("train")
    parser.add_argument("test")
    parser.add_argument("--contacts", type=int, help="train on the first ones only")
    parser.add_argument("--iterations", type=int, default=120)
    parser.add_argument("--oracle", action="store_true")
    flags = parser.parse_args()
    train = Contacts(flags.train, flags.contacts)
    test = Contacts(flags.test)

    rows = {}
    for column, (seconds, so_far) in enumerate(QUESTIONS):
        known = train.labels(seconds, so_far)
        asked = test.labels(seconds, so_far)

        def add(name, answers):
            cells = rows.setdefault(name, ["-"] * len(QUESTIONS))
            cells[column] = cell(answers, asked)
            print(seconds, so_far, name, cells[column], file=sys.stderr, flush=True)

        def add_trees(name, learnt, tested):
            add(name, trees(learnt, known, flags.iterations).predict(tested))

        add("the most frequent class", np.full(len(asked), np.bincount(known).argmax()))
        if "posterior" in test.names():
            add("the bundle", test.posterior(seconds).argmax(axis=1))
        learnt, tested = train.felt(seconds), test.felt(seconds)
        add_trees("trees", learnt, tested)
        if "posterior" in train.names() and "posterior" in test.names() and column == 0:
            add_trees(
                "trees that also see the bundle's answer",
                np.hstack([learnt, train.posterior(seconds)]),
                np.hstack([tested, test.posterior(seconds)]),
            )
        if flags.oracle:
            add_trees(
                "trees, signals without skin and noise", train.true(seconds), test.true(seconds)
            )

    print(
        f"Trained on {train.count:,} contacts, tested on {test.count:,}; "
        f"{test.recorded - test.count:,} of {test.recorded:,} were never felt.\n"
    )
    print("| accuracy, % (95 % interval) | 5 s | 1.2 s, class so far | 1.2 s, in the end |")
    print("|---|---|---|---|")
    for name, cells in rows.items():
        print(f"| {name} | {' | '.join(cells)} |")


if __name__ == "__main__":
    main()
