"""Contacts of SkinTracker against SciPy: regions by scipy.ndimage.label, and
which region is which contact by the assignment of least total distance.

    tracking_reference.py PATH_OF_tracking_samples
"""

import subprocess
import sys
import tempfile

import numpy as np
from scipy import ndimage, optimize

SEED = 11
# A track ends when it was lost for half a second.
LONGEST_LOSS = 50
# A region farther away than this is no track's, taxels.
REACH = 6


def regions_of(frame, wraps):
    """(taxels, centroid row, centroid column) of each region."""
    labels, count = ndimage.label(frame, structure=np.ones((3, 3)))
    columns = frame.shape[1]
    if wraps:
        # Joins regions across the seam, with diagonal neighbours.
        for row in range(frame.shape[0]):
            for other in (row - 1, row, row + 1):
                if not 0 <= other < frame.shape[0]:
                    continue
                a, b = labels[row, -1], labels[other, 0]
                if a and b and a != b:
                    labels[labels == b] = a
    regions = []
    for label in np.unique(labels[labels > 0]):
        row, column = np.nonzero(labels == label)
        if wraps and np.ptp(column) > columns / 2:
            column = np.where(column < columns / 2, column + columns, column)
        regions.append((len(row), row.mean(), column.mean() % columns))
    return regions


def distance(a, b, columns, wraps):
    across = abs(a[1] - b[1])
    if wraps:
        across = min(across, columns - across)
    return np.hypot(a[0] - b[0], across)


class Tracks:
    """One track for each contact: optimal assignment from frame to frame."""

    def __init__(self, columns, wraps):
        self.columns = columns
        self.wraps = wraps
        self.places = {}
        self.lost = {}
        self.begun = 0

    def step(self, regions):
        """Returns the track of each region."""
        tracks = list(self.places)
        cost = np.array(
            [
                [
                    distance(self.places[t], r[1:], self.columns, self.wraps)
                    for r in regions
                ]
                for t in tracks
            ]
        ).reshape(len(tracks), len(regions))
        track_of = [None] * len(regions)
        for i, k in zip(*optimize.linear_sum_assignment(np.minimum(cost, REACH))):
            if cost[i, k] < REACH:
                track_of[k] = tracks[i]
        for track in tracks:
            self.lost[track] = 0 if track in track_of else self.lost[track] + 1
            if self.lost[track] >= LONGEST_LOSS:
                del self.places[track]
        for k, region in enumerate(regions):
            if track_of[k] is None:
                self.begun += 1
                track_of[k] = self.begun
                self.lost[self.begun] = 0
            self.places[track_of[k]] = region[1:]
        return track_of


def check(folder, name, rows, columns):
    wraps = name == "round"
    frames = np.fromfile(f"{folder}/{name}.frames", np.uint8)
    frames = frames.reshape(-1, rows, columns)
    contacts = [[] for _ in frames]
    for line in open(f"{folder}/{name}.csv", encoding="utf-8"):
        frame, number, taxels, row, column = line.split(",")
        contacts[int(frame)].append(
            (int(number), int(taxels), float(row), float(column))
        )
    tracks = Tracks(columns, wraps)
    first_seen = {}
    id_of = {}
    compared = 0
    for t, frame in enumerate(frames):
        regions = regions_of(frame, wraps)
        left = list(contacts[t])
        for track, region in zip(tracks.step(regions), regions):
            first_seen.setdefault(track, t)
            same = [
                c
                for c in left
                if c[1] == region[0]
                and distance(c[2:], region[1:], columns, wraps) < 1e-6
            ]
            if not same:
                # Beside others, a contact begins with its second frame.
                assert t == first_seen[track], f"{name} {t}: no contact at {region}"
                continue
            left.remove(same[0])
            number = id_of.setdefault(track, same[0][0])
            assert number == same[0][0], f"{name} {t}: {number} became {same[0][0]}"
            compared += 1
        assert not left, f"{name} {t}: contacts without a region: {left}"
    assert len(set(id_of.values())) == len(id_of), f"{name}: two tracks share an id"
    assert compared > 5000 and len(id_of) > 40, (compared, len(id_of))
    print(f"{name}: {compared} regions of {len(id_of)} contacts agree, seed {SEED}")


def main():
    with tempfile.TemporaryDirectory() as folder:
        size = subprocess.run(
            [sys.argv[1], folder, str(SEED)],
            check=True,
            capture_output=True,
            text=True,
        ).stdout
        rows, columns = map(int, size.split())
        for name in ("flat", "round"):
            check(folder, name, rows, columns)


if __name__ == "__main__":
    main()
