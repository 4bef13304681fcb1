"""Summaries of contacts that world-signals wrote, as a table for tree learners.

    contacts = Contacts("train")
    table = contacts.felt(seconds=1.2)
    labels = contacts.labels(seconds=1.2, so_far=True)

A table has one row for each contact. It depends on the frames until `seconds`
after the onset only.
"""

import os
import warnings

import numpy as np

CLASSES = ["HU", "HM", "SU", "SM"]
RATE = 100
TIMES = [0.1, 0.25, 0.5, 1.2, 2.5, 5.0]
EDGES = [0, 1, 2, 4, 7, 11, 16, 22, 30, 40, 52, 68, 90, 120, 160, 210, 270, 340, 420, 500]
# Below these, logarithms say nothing: N, m^2, m.
FORCE_FLOOR, AREA_FLOOR, MOTION_FLOOR = 1e-6, 1e-7, 1e-7
CHUNK = 2000


def blocks(x, reduce):
    """`reduce` over each stretch of frames; stretches grow longer."""
    ends = [(a, min(b, x.shape[1])) for a, b in zip(EDGES, EDGES[1:]) if a < x.shape[1]]
    return [reduce(x[:, a:b], axis=1) for a, b in ends]


def smooth(x, window=5):
    """A running mean that begins as the mean of all frames so far."""
    sums = np.cumsum(np.nan_to_num(x), axis=1)
    count = np.cumsum(~np.isnan(x), axis=1).astype(float)
    sums[:, window:] -= sums[:, :-window].copy()
    count[:, window:] -= count[:, :-window].copy()
    return sums / np.maximum(count, 1)


def regression(x, y):
    """Slope of y on x, and the share of y's variance that it leaves."""
    x = x - np.nanmean(x, axis=1, keepdims=True)
    y = y - np.nanmean(y, axis=1, keepdims=True)
    xx, xy, yy = (np.nanmean(p, axis=1) for p in (x * x, x * y, y * y))
    slope = xy / np.maximum(xx, 1e-30)
    return [slope, 1 - slope * xy / np.maximum(yy, 1e-30)]


def summarise(force, area, motion, peak=None):
    """Columns of one chunk; each argument is contacts x frames."""
    frames = force.shape[1]
    series = {"force": force, "area": area, "motion": motion}
    if peak is not None:
        series["peak"] = peak
    columns = [np.isnan(force).sum(axis=1)]
    for x in series.values():
        columns += blocks(x, np.nanmean)
        columns += list(np.nanquantile(x, [0, 0.1, 0.25, 0.5, 0.75, 0.9, 1], axis=1))
        columns += [np.nanmean(x, axis=1), np.nanstd(x, axis=1), np.nanmean(x[:, -20:], axis=1)]
        s = smooth(x)
        top = np.maximum.accumulate(s, axis=1)
        columns += [
            s.argmax(axis=1),
            s.argmin(axis=1),
            (top - s).max(axis=1),
            (top - s).argmax(axis=1),
            s[:, -1] / np.where(top[:, -1] == 0, 1, top[:, -1]),
        ]
        change = np.diff(x, axis=1)
        columns += blocks(change, np.nanstd)
        columns += list(np.nanquantile(change, [0, 0.05, 0.5, 0.95, 1], axis=1))
    f, a, m = smooth(force), smooth(area), smooth(motion)
    columns += blocks(np.log(np.maximum(f, FORCE_FLOOR) / np.maximum(m, MOTION_FLOOR)), np.mean)
    columns += blocks(
        np.log(np.maximum(f, FORCE_FLOOR)) - 1.5 * np.log(np.maximum(a, AREA_FLOOR)), np.mean
    )
    # How far the object has slid if its spring is the stiffest one so far.
    spring = np.cumsum(np.nan_to_num(f * m), axis=1) / np.maximum(
        np.cumsum(np.nan_to_num(m * m), axis=1), MOTION_FLOOR**2
    )
    stiffest = np.maximum.accumulate(spring[:, 5:], axis=1)
    slid = m[:, 5:] - f[:, 5:] / np.maximum(stiffest, 1e-3)
    columns += [np.log(np.maximum(stiffest[:, -1], 1e-3)), slid[:, -1], slid.max(axis=1)]
    columns += [spring[:, 5:].argmax(axis=1), np.log(np.maximum(spring[:, -1], 1e-3))]
    time = np.broadcast_to(np.arange(frames, dtype=float), force.shape)
    for begin, end in [(0, frames), (0, 10), (0, 40), (frames // 2, frames), (frames - 40, frames)]:
        part = slice(begin, end)
        columns += regression(motion[:, part], force[:, part])
        columns += regression(force[:, part], area[:, part])
        columns += regression(time[:, part], motion[:, part])
        columns += regression(time[:, part], force[:, part])
    return np.stack(columns, axis=1).astype(np.float32)


class Contacts:
    """The arrays of one folder."""

    def __init__(self, folder, limit=None):
        self._arrays = {}
        for name in os.listdir(folder):
            array = np.load(os.path.join(folder, name), mmap_mode="r")
            own = name not in ("recorded.npy", "cue_names.npy")
            self._arrays[name.removesuffix(".npy")] = array[:limit] if own else array
        self.recorded = int(self._arrays["recorded"])
        self.count = len(self._arrays["label"])

    def names(self):
        return self._arrays.keys()

    def array(self, name):
        return self._arrays[name]

    def labels(self, seconds, so_far):
        """The class in the end, or so far, as a number."""
        label = np.array([CLASSES.index(name) for name in self.array("label")])
        if so_far:
            moved = self.array("moved")
            moves = (moved >= 0) & (moved < round(seconds * RATE))
            label = label - label % 2 + moves
        return label

    def cues(self, seconds):
        return self.array("cues")[:, TIMES.index(seconds)]

    def posterior(self, seconds):
        return self.array("posterior")[:, TIMES.index(seconds)]

    def felt(self, seconds):
        """What the skin felt, and the cues of the models."""
        frames = round(seconds * RATE)

        def part(rows):
            x = self.array("felt")[rows, :frames].astype(float)
            return summarise(x[..., 3], x[..., 1], x[..., 2], x[..., 0])

        return np.hstack([self._in_chunks(part), self.cues(seconds)])

    def true(self, seconds):
        """The signals of the simulator without skin and noise, at the same frames."""
        frames = round(seconds * RATE)
        onset = self.array("onset").astype(int)

        def part(rows):
            x = self.array("true")[rows].astype(float)
            at = onset[rows, None] + np.arange(frames)
            x = np.take_along_axis(x, np.clip(at, 0, x.shape[1] - 1)[..., None], axis=1)
            x[at >= len(self.array("true")[0])] = np.nan
            return summarise(x[..., 0], x[..., 1], x[..., 2])

        return self._in_chunks(part)

    def _in_chunks(self, part):
        with np.errstate(all="ignore"):
            with warnings.catch_warnings():
                warnings.simplefilter("ignore", RuntimeWarning)
                return np.vstack(
                    [part(slice(i, i + CHUNK)) for i in range(0, self.count, CHUNK)]
                )
