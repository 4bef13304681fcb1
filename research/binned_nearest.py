#!/usr/bin/python3
"""1-NN on ten time bins of all taxels, in eight settings: a standard of comparison.

    binned_nearest.py FOLDER --protocol=loco
    binned_nearest.py FOLDER --protocol=k-fold --folds=5

FOLDER is one that `trainctl import` reads, made by a script of examples/recordings.
The protocols and their folds are those of `trainctl evaluate`: loco, k-fold,
leave-one-out and leave-one-material-out. Prints a Markdown table.

A trial is its touched frames, cut into ten stretches of equal length. Its vector is the
mean of a view of the frames over each stretch, as it is or standardised over the trials
that are learned from. The views have a number per taxel, and but for one of them one
more for the whole load:

    raw      the values, and the load
    root     their roots, and that of the load
    shape    the roots of the values over the load, and its logarithm
    shape 0  the same without the logarithm

Of skins with axes every number keeps its sign, and a load is the length of the three.

The best setting is known once the answers are seen, so its accuracy is too good. The
last row is 1-NN on the values of the first touched frame alone. If it is good, the
classes differ from the beginning: by what is touched, or only by the session.
"""

import argparse
import collections
import csv
import json
import pathlib

import numpy

from intervals import wilson

BINS = 10
VIEWS = ["raw", "root", "shape", "shape 0"]
FIRST = "first frame"
TINY = 1e-9
# Thresholds of the presets of layouts (core/skin/layout.cc), by name.
THRESHOLDS = {"icub-6x10": 4, "vitac-12x32": 20}


class Trials:
    """The trials of a folder: frames [frames x numbers], loads, labels, parts."""

    def __init__(self, folder):
        folder = pathlib.Path(folder)
        skin = json.loads((folder / "skin.json").read_text())
        pattern = skin.get("fields", {}).get("frames", "{frames}")
        with open(folder / "trials.csv", newline="", encoding="utf-8") as table:
            rows = list(csv.DictReader(table))
        self.frames, self.loads = [], []
        for row in rows:
            frames = values_of(numpy.load(folder / pattern.format(**row)), skin)
            loads = loads_of(frames, skin)
            touched = loads.sum(axis=1) > 0
            if not touched.any():
                touched[0] = True
            self.frames.append(frames[touched])
            self.loads.append(loads[touched])
        self.labels = numpy.array([row["label"] for row in rows])
        self.conditions = [row.get("condition", "") for row in rows]
        self.groups = [row.get("group") or row.get("material", "") for row in rows]


def values_of(frames, skin):
    """What the import makes of the numbers of a file [frames x numbers]."""
    values = frames.reshape(len(frames), -1).astype(float)
    baseline = skin.get("baseline", 0)
    if baseline == "from idle frames":
        baseline = values[: skin["idle_frames"]].mean(axis=0)
    values = skin.get("scale", 1) * (values - baseline)
    return -values if skin.get("pressing") == "lowers" else values


def loads_of(values, skin):
    """The load of each taxel; it and its numbers become 0 below the threshold."""
    axes = skin.get("axes", 1)
    each = values.reshape(len(values), -1, axes)
    loads = numpy.linalg.norm(each, axis=2) if axes > 1 else each[:, :, 0].copy()
    threshold = skin.get("contact_threshold", THRESHOLDS.get(skin["name"]))
    below = loads < threshold
    each[below] = 0
    loads[below] = 0
    return loads


def seen(values, loads, view):
    load = loads.sum(axis=1, keepdims=True)
    if view == "raw":
        return numpy.hstack([values, load])
    roots = numpy.sign(values) * numpy.sqrt(abs(values))
    if view == "root":
        return numpy.hstack([roots, numpy.sqrt(load)])
    shape = roots / numpy.sqrt(load.clip(TINY))
    return shape if view == "shape 0" else numpy.hstack([shape, numpy.log(load.clip(TINY))])


def binned(frames):
    """The mean over each of ten equal stretches; a frame may be in two of them."""
    sums = numpy.vstack([numpy.zeros(frames.shape[1]), frames.cumsum(axis=0)])
    edges = numpy.linspace(0, len(frames), BINS + 1)
    at = [numpy.interp(edges, numpy.arange(len(sums)), column) for column in sums.T]
    return (numpy.diff(at, axis=1) / (len(frames) / BINS)).T.ravel()


def vectors_of(trials, view):
    if view == FIRST:
        return numpy.array([frames[0] for frames in trials.frames])
    pairs = zip(trials.frames, trials.loads)
    return numpy.array([binned(seen(frames, loads, view)) for frames, loads in pairs])


def dealt(labels, count):
    """The trials of each class are dealt to the folds in turn."""
    dealt_of = collections.Counter()
    folds = []
    for label in labels:
        folds.append(dealt_of[label] % count)
        dealt_of[label] += 1
    return folds


def folds_of(trials, protocol, count=10):
    """The fold of each trial. Copies of a trial are in the fold of the first one."""
    first = {}
    places = [first.setdefault(frames.tobytes(), i) for i, frames in enumerate(trials.frames)]
    if protocol == "k-fold":
        originals = [i for i, place in enumerate(places) if i == place]
        folds = dict(zip(originals, dealt(trials.labels[originals], count)))
    else:
        folds = {
            "loco": trials.conditions,
            "leave-one-material-out": trials.groups,
            "leave-one-out": range(len(places)),
        }[protocol]
    folds = numpy.unique([folds[place] for place in places], return_inverse=True)[1]
    if folds.max() == 0:
        raise SystemExit(f"binned_nearest: {protocol} leaves nothing to learn from")
    return folds


def count_right(vectors, labels, folds, standardised):
    right = 0
    for fold in numpy.unique(folds):
        test = folds == fold
        known, asked = vectors[~test], vectors[test]
        middle, deviation = known.mean(axis=0), known.std(axis=0)
        # What never changes in training says nothing.
        scale = numpy.where(deviation > TINY, deviation, numpy.inf) if standardised else 1
        known, asked = (known - middle) / scale, (asked - middle) / scale
        squared = (known**2).sum(axis=1) - 2 * asked @ known.T
        right += int((labels[~test][squared.argmin(axis=1)] == labels[test]).sum())
    return right


def settings(trials, folds):
    """{(view, standardised): right} of all eight, and of the first frame."""
    results = {}
    for view in VIEWS + [FIRST]:
        vectors = vectors_of(trials, view)
        for standardised in (False, True):
            results[view, standardised] = count_right(vectors, trials.labels, folds, standardised)
    return results


def table(results, count):
    lines = ["| view | as it is, % | standardised, % |", "|---|---|---|"]
    for view in VIEWS + [FIRST]:
        cells = [wilson(results[view, standardised], count) for standardised in (False, True)]
        lines.append(f"| {view} | {' | '.join(cells)} |")
    return lines


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("folder")
    parser.add_argument("--protocol", required=True)
    parser.add_argument("--folds", type=int, default=10)
    flags = parser.parse_args()
    trials = Trials(flags.folder)
    folds = folds_of(trials, flags.protocol, flags.folds)
    print("\n".join(table(settings(trials, folds), len(folds))))


if __name__ == "__main__":
    main()
