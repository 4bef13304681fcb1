"""The 1-NN rows of the paper's table of the simulation, made in other ways too.

    paper_nearest.py signals.h5

One robot condition is left out at a time. A trial is the vector of all its
frames, feature after feature; principal components of the training trials;
the label of the nearest training trial. Prints a Markdown table.
"""

import sys

import h5py
import numpy as np

# Columns of the dataset `signals` (docs/formats.md).
COLUMNS = {"f": 0, "a": 1, "m": 2}
# Of the paper's table of the simulation, %.
PAPER = {
    "f": 40.71,
    "m": 64.41,
    "a": 57.60,
    "f+m": 40.93,
    "f+a": 40.44,
    "m+a": 62.72,
    "f+m+a": 40.54,
}


def read(path):
    """Signals [trials x frames x 3], labels, and conditions."""
    with h5py.File(path) as file:
        trials = [file["trials"][name] for name in sorted(file["trials"])]
        signals = np.array([trial["signals"][:] for trial in trials])
        labels = np.array([trial.attrs["label"] for trial in trials])
        conditions = np.array([trial.attrs["condition"] for trial in trials])
    return signals, labels, conditions


def components_for(share, singular_values):
    """The fewest components that hold this share of the variance."""
    held = np.cumsum(singular_values**2) / np.sum(singular_values**2)
    return int(np.searchsorted(held, share) + 1)


def answers(training, labels, tests, components):
    """`components`: a number, or a share of the variance."""
    mean = training.mean(axis=0)
    _, singular_values, axes = np.linalg.svd(
        training - mean, full_matrices=False
    )
    if components < 1:
        components = components_for(components, singular_values)
    axes = axes[:components].T
    known, asked = (training - mean) @ axes, (tests - mean) @ axes
    squared = (
        (asked**2).sum(axis=1)[:, None]
        + (known**2).sum(axis=1)
        - 2 * asked @ known.T
    )
    return labels[squared.argmin(axis=1)], components


def accuracy(signals, labels, conditions, features, scale, components):
    """In %, and the numbers of components that were kept."""
    right, kept = 0, set()
    for condition in np.unique(conditions):
        test = conditions == condition
        chosen = signals[:, :, [COLUMNS[f] for f in features.split("+")]]
        if scale:
            frames = chosen[~test].reshape(-1, chosen.shape[2])
            chosen = (chosen - frames.mean(axis=0)) / frames.std(axis=0)
        vectors = chosen.transpose(0, 2, 1).reshape(len(chosen), -1)
        answer, number = answers(
            vectors[~test], labels[~test], vectors[test], components
        )
        right += np.sum(answer == labels[test])
        kept.add(number)
    return 100 * right / len(labels), kept


def main(path):
    data = read(path)
    ways = [(True, 0.95), (True, 3), (False, 0.95), (False, 3)]
    print(
        "| features | paper, % | scaled, 95 % of the variance"
        " | scaled, three components | not scaled, 95 % of the variance"
        " | not scaled, three components |"
    )
    print("|---|---|---|---|---|---|")
    for features, paper in PAPER.items():
        cells = []
        for scale, components in ways:
            percent, kept = accuracy(*data, features, scale, components)
            cell = f"{percent:.2f}"
            if components < 1:
                cell += f" ({min(kept)} to {max(kept)} components)"
            cells.append(cell)
        print(f"| {features} | {paper:.2f} | {' | '.join(cells)} |", flush=True)


if __name__ == "__main__":
    main(*sys.argv[1:])
