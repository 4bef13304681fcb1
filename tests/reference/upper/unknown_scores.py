#!/usr/bin/python3
"""Other scores of `unknown`, with one category left out at a time.

    world-signals --data=world:skin=good,contacts=8000,seed=3 --out=world
    unknown_scores.py world

The scores see the HMMs' ten cues 5 s after the onset. They are fitted to three
categories of three quarters of the contacts and tested on the last quarter, each
quarter in turn. Prints areas under the ROC curve, with 95 % intervals, as a Markdown table.
"""

import math
import sys

import numpy as np
from sklearn.metrics import roc_auc_score
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
    """Squared distance from the nearest category's mean, by its covariance."""
    distances = []
    for category in np.unique(labels):
        own = fitted[labels == category]
        covariance = np.cov(own.T) + 0.01 * np.eye(own.shape[1])
        away = tested - own.mean(axis=0)
        distances.append((away @ np.linalg.inv(covariance) * away).sum(axis=1))
    return np.min(distances, axis=0)


def neighbours(fitted, labels, tested):
    """Mean distance from the 20 nearest contacts, whatever their category."""
    del labels
    return NearestNeighbors(n_neighbors=20).fit(fitted).kneighbors(tested)[0].mean(axis=1)


def with_interval(area, positive, negative):
    """The area and its 95 % interval (Hanley and McNeil 1982, eq. 1)."""
    q1, q2 = area / (2 - area), 2 * area**2 / (1 + area)
    variance = area * (1 - area) + (positive - 1) * (q1 - area**2) + (negative - 1) * (q2 - area**2)
    half = 1.959963984540054 * math.sqrt(variance / positive / negative)
    return f"{area:.3f} ({max(area - half, 0):.3f} to {min(area + half, 1):.3f})"


def main():
    contacts = Contacts(sys.argv[1])
    names = list(contacts.array("cue_names"))
    cues = contacts.cues(SECONDS)[:, [names.index(name) for name in CUES]].astype(float)
    labels = contacts.labels(SECONDS, so_far=False)
    fold = np.arange(contacts.count) % FOLDS
    print(f"| score | {' | '.join('without ' + name for name in CLASSES)} |")
    print("|---|---|---|---|---|")
    for name, score in [("Mahalanobis", mahalanobis), ("20 nearest", neighbours)]:
        areas = []
        for category in range(len(CLASSES)):
            values = np.zeros(contacts.count)
            for part in range(FOLDS):
                fitted = (fold != part) & (labels != category)
                mean, scale = cues[fitted].mean(axis=0), cues[fitted].std(axis=0)
                inputs = np.clip((cues - mean) / scale, -5, 5)
                tested = fold == part
                values[tested] = score(inputs[fitted], labels[fitted], inputs[tested])
            left_out = int((labels == category).sum())
            area = roc_auc_score(labels == category, values)
            areas.append(with_interval(area, left_out, contacts.count - left_out))
        print(f"| {name} | {' | '.join(areas)} |")


if __name__ == "__main__":
    main()
