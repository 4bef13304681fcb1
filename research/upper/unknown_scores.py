#!/usr/bin/python3
"""Other scores of `unknown`, for classes that are left out or foreign materials.

    world-signals --data=world:skin=good,contacts=8000,seed=3 --out=world
    unknown_scores.py world
    unknown_scores.py world inside softer-3x lighter-10x

The scores see the HMMs' ten cues 5 s after the onset. In the first form they are fitted
to three classes of three quarters of the contacts and tested on the last quarter,
each quarter in turn. In the second they are fitted to all contacts of the first folder,
and tell those of the second from those of each of the others. Prints areas under the ROC
curve, with 95 % intervals, as a Markdown table.
"""

import math
import sys

import numpy as np
from sklearn.metrics import roc_auc_score
from sklearn.mixture import GaussianMixture
from sklearn.neighbors import NearestNeighbors

from summaries import CLASSES, Contacts

# The inputs of the preset world's HMMs (core/train/fit_options.cc).
CUES = [
    "log_drag",
    "log_motion",
    "log_area",
    "log_slope",
    "log_slope_misfit",
    "force_ripple_long",
    "motion_ripple_long",
    "log_spring",
    "log_spring_misfit",
    "force_drop",
]
SECONDS = 5.0
FOLDS = 4


def mahalanobis(fitted, labels, tested):
    """Squared distance from the nearest class's mean, by its covariance."""
    distances = []
    for category in np.unique(labels):
        own = fitted[labels == category]
        covariance = np.cov(own.T) + 0.01 * np.eye(own.shape[1])
        away = tested - own.mean(axis=0)
        distances.append((away @ np.linalg.inv(covariance) * away).sum(axis=1))
    return np.min(distances, axis=0)


def neighbours(fitted, labels, tested):
    """Mean distance from the 20 nearest contacts, whatever their class."""
    del labels
    return NearestNeighbors(n_neighbors=20).fit(fitted).kneighbors(tested)[0].mean(axis=1)


def ranks(known, asked):
    """The share of known values that are at most as large as each one asked."""
    return (np.searchsorted(np.sort(known), asked, side="right") + 1) / (len(known) + 2)


def density_and_slope(fitted, labels, tested):
    """How rare is so low a density, times how rare is so extreme a `log_slope`."""
    del labels
    mixture = GaussianMixture(20, reg_covar=0.1, random_state=0).fit(fitted[::2])
    density = ranks(mixture.score_samples(fitted[1::2]), mixture.score_samples(tested))
    slope = CUES.index("log_slope")
    rank = ranks(fitted[:, slope], tested[:, slope])
    return -density * np.minimum(rank, 1 - rank)


def with_interval(area, positive, negative):
    """The area and its 95 % interval (Hanley and McNeil 1982, eq. 1)."""
    q1, q2 = area / (2 - area), 2 * area**2 / (1 + area)
    variance = area * (1 - area) + (positive - 1) * (q1 - area**2) + (negative - 1) * (q2 - area**2)
    half = 1.959963984540054 * math.sqrt(variance / positive / negative)
    return f"{area:.3f} ({max(area - half, 0):.3f} to {min(area + half, 1):.3f})"


SCORES = [
    ("Mahalanobis", mahalanobis),
    ("20 nearest", neighbours),
    ("density and slope", density_and_slope),
]


def read(folder):
    """Cues [contacts x 10] and classes."""
    contacts = Contacts(folder)
    names = list(contacts.array("cue_names"))
    cues = contacts.cues(SECONDS)[:, [names.index(name) for name in CUES]].astype(float)
    return cues, contacts.labels(SECONDS, so_far=False)


def apply(score, fitted, labels, tested):
    """The score on cues that are scaled as those that it is fitted to."""
    mean, scale = fitted.mean(axis=0), fitted.std(axis=0)
    inputs = [np.clip((cues - mean) / scale, -5, 5) for cues in (fitted, tested)]
    return score(inputs[0], labels, inputs[1])


def area(unknown, values):
    positive = int(unknown.sum())
    return with_interval(
        roc_auc_score(unknown, values), positive, len(unknown) - positive
    )


def without_categories(folder):
    cues, labels = read(folder)
    fold = np.arange(len(labels)) % FOLDS
    print(f"| score | {' | '.join('without ' + name for name in CLASSES)} |")
    print("|---|---|---|---|---|")
    for name, score in SCORES:
        areas = []
        for category in range(len(CLASSES)):
            values = np.zeros(len(labels))
            for part in range(FOLDS):
                fitted = (fold != part) & (labels != category)
                tested = fold == part
                values[tested] = apply(
                    score, cues[fitted], labels[fitted], cues[tested]
                )
            areas.append(area(labels == category, values))
        print(f"| {name} | {' | '.join(areas)} |")


def foreign_materials(fitted, known, folders):
    cues, labels = read(fitted)
    inside, _ = read(known)
    print(f"| score | {' | '.join(folders)} |")
    print("|---" * (len(folders) + 1) + "|")
    for name, score in SCORES:
        areas = []
        for folder in folders:
            outside, _ = read(folder)
            unknown = np.repeat([False, True], [len(inside), len(outside)])
            tested = np.vstack([inside, outside])
            areas.append(area(unknown, apply(score, cues, labels, tested)))
        print(f"| {name} | {' | '.join(areas)} |")


if __name__ == "__main__":
    if len(sys.argv) == 2:
        without_categories(sys.argv[1])
    else:
        foreign_materials(sys.argv[1], sys.argv[2], sys.argv[3:])
