#!/usr/bin/python3
"""1-NN on time-binned taxels: what a recording set gives to the simplest learner.

    taxel_nearest.py --folds=5 icub_slide20.h5         k-fold, as trainctl evaluate
    taxel_nearest.py vitac384.h5                       leave one out
    taxel_nearest.py --train=without-ramp.h5 ramp.h5   tested on the second file

Each trial is cut into stretches of equal length. Its vector is the mean of every
taxel over each stretch, or the roots of these means, which weigh light touches more.
Prints a Markdown table.
"""

import argparse
import collections

import h5py
import numpy as np

from upper_reference import wilson

BINS = [1, 5, 10, 20]


def text(value):
    return value.decode() if isinstance(value, bytes) else value


def read(path):
    """The taxels of every trial [frames x taxels], and the labels."""
    with h5py.File(path) as file:
        trials = [file["trials"][name] for name in sorted(file["trials"])]
        taxels = [trial["taxels"][:].reshape(len(trial["taxels"]), -1) for trial in trials]
        labels = [text(trial.attrs["label"]) for trial in trials]
    return taxels, np.array(labels)


def binned(taxels, bins):
    """The mean of each taxel over each stretch [trials x (bins x taxels)]."""
    parts = [np.array_split(np.nan_to_num(trial), bins) for trial in taxels]
    return np.array([np.concatenate([p.mean(axis=0) for p in trial]) for trial in parts])


def folds_of(labels, count):
    """The fold of each trial: those of each class are dealt in turn."""
    seen = collections.Counter()
    folds = []
    for label in labels:
        folds.append(seen[label] % count)
        seen[label] += 1
    return np.array(folds)


def nearest(known, labels, asked):
    squared = (
        (asked**2).sum(axis=1)[:, None] + (known**2).sum(axis=1) - 2 * asked @ known.T
    )
    return labels[squared.argmin(axis=1)]


def count_right(vectors, labels, folds):
    """`folds`: the number of each trial's fold; trials of -1 are only learned from."""
    right = 0
    for fold in np.unique(folds[folds >= 0]):
        test = folds == fold
        right += np.sum(nearest(vectors[~test], labels[~test], vectors[test]) == labels[test])
    return int(right)


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("test")
    parser.add_argument("--train", help="trials that are only learned from")
    parser.add_argument("--folds", type=int, help="default: leave one out")
    flags = parser.parse_args()
    taxels, labels = read(flags.test)
    if flags.train:
        more, more_labels = read(flags.train)
        folds = np.repeat([0, -1], [len(labels), len(more_labels)])
        taxels, labels = taxels + more, np.concatenate([labels, more_labels])
    elif flags.folds:
        folds = folds_of(labels, flags.folds)
    else:
        folds = np.arange(len(labels))
    tested = int((folds >= 0).sum())
    print("| stretches | taxels | roots of taxels |")
    print("|---|---|---|")
    for bins in BINS:
        vectors = binned(taxels, bins)
        cells = []
        for values in (vectors, np.sqrt(np.maximum(vectors, 0))):
            right = count_right(values, labels, folds)
            low, high = wilson(right, tested)
            interval = f"({100 * low:.2f} to {100 * high:.2f})"
            cells.append(f"{100 * right / tested:.2f} {interval}, {right} of {tested}")
        print(f"| {bins} | {' | '.join(cells)} |")


if __name__ == "__main__":
    main()
