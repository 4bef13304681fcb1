#!/usr/bin/python3
"""Tests of research/binned_nearest.py on trials made by hand."""

import json
import os
import pathlib
import sys
import tempfile
import unittest

import numpy

sys.path.insert(0, os.path.dirname(os.path.abspath(__file__)))
import binned_nearest  # noqa: E402
from binned_nearest import Trials, binned, count_right, folds_of, seen, settings  # noqa: E402


class BinnedNearestTest(unittest.TestCase):
    def setUp(self):
        self.scratch = tempfile.TemporaryDirectory()
        self.addCleanup(self.scratch.cleanup)
        self.folder = pathlib.Path(self.scratch.name)

    def trials(self, frames, header, rows, **skin):
        for i, values in enumerate(frames):
            numpy.save(self.folder / f"{i}.npy", numpy.array(values, "<f4"))
        skin = {"name": "test", "contact_threshold": 1} | skin
        (self.folder / "skin.json").write_text(json.dumps(skin))
        (self.folder / "trials.csv").write_text("\n".join([header, *rows]) + "\n")
        return Trials(self.folder)

    def test_stretches(self):
        frames = numpy.arange(20.0).reshape(20, 1)
        numpy.testing.assert_allclose(binned(frames), numpy.arange(10) * 2 + 0.5)
        # Of 5 frames each is in two stretches; of one frame all are the same.
        numpy.testing.assert_allclose(binned(frames[:5]), numpy.repeat(numpy.arange(5), 2))
        numpy.testing.assert_allclose(binned(frames[3:4]), [3] * 10)

    def test_views(self):
        values = numpy.array([[9.0, 16.0]])
        numpy.testing.assert_allclose(seen(values, values, "raw"), [[9, 16, 25]])
        numpy.testing.assert_allclose(seen(values, values, "root"), [[3, 4, 5]])
        shape = [[0.6, 0.8, numpy.log(25)]]
        numpy.testing.assert_allclose(seen(values, values, "shape"), shape)
        numpy.testing.assert_allclose(seen(values, values, "shape 0"), [[0.6, 0.8]])

    def test_values_are_those_of_the_import(self):
        trials = self.trials(
            [[[255, 255], [250, 254.5], [245, 255]]],
            "frames,label",
            ["0.npy,a"],
            baseline=255,
            pressing="lowers",
            scale=2,
        )
        # 0.5 x 2 is a touch, and the first frame is untouched.
        numpy.testing.assert_allclose(trials.frames[0], [[10, 1], [20, 0]])

    def test_axes(self):
        # Two idle frames, whose mean is 1, 1, 1 for each taxel.
        idle = [[0] * 6, [2] * 6]
        trials = self.trials(
            [idle + [[4, 1, -3, 1, 1, 1.5]]],
            "frames,label",
            ["0.npy,a"],
            axes=3,
            signed_values=True,
            baseline="from idle frames",
            idle_frames=2,
        )
        numpy.testing.assert_allclose(trials.frames[0][-1], [3, 0, -4, 0, 0, 0])
        numpy.testing.assert_allclose(trials.loads[0][-1], [5, 0])
        root = seen(trials.frames[0], trials.loads[0], "root")[-1]
        numpy.testing.assert_allclose(root, [3**0.5, 0, -2, 0, 0, 0, 5**0.5])

    def test_folds(self):
        frames = [[[i]] for i in [1, 2, 3, 4, 5, 2]]
        rows = [f"{i}.npy,{label},{c},{g}" for i, (label, c, g) in enumerate(
            [("a", "x", "p"), ("a", "y", "q"), ("b", "x", "r"), ("b", "y", "p"),
             ("a", "x", "q"), ("a", "x", "r")])]
        trials = self.trials(frames, "frames,label,condition,group", rows)
        # The last trial is a copy of the second one.
        self.assertEqual(folds_of(trials, "k-fold", 2).tolist(), [0, 1, 0, 1, 0, 1])
        self.assertEqual(folds_of(trials, "loco").tolist(), [0, 1, 0, 1, 0, 1])
        self.assertEqual(folds_of(trials, "leave-one-material-out").tolist(), [0, 1, 2, 0, 1, 1])
        self.assertEqual(folds_of(trials, "leave-one-out").tolist(), [0, 1, 2, 3, 4, 1])

    def test_one_condition_is_refused(self):
        trials = self.trials([[[1]], [[2]]], "frames,label", ["0.npy,a", "1.npy,b"])
        with self.assertRaises(SystemExit):
            folds_of(trials, "loco")

    def test_as_a_loop_over_all_pairs(self):
        dice = numpy.random.default_rng(1)
        vectors = dice.normal(3, 1, (40, 7)) * 10.0 ** numpy.arange(7)
        vectors[:, 5] = 8  # Never changes.
        labels = dice.choice(["a", "b", "c"], 40)
        folds = dice.integers(0, 4, 40)
        for standardised in (False, True):
            right = 0
            for i in range(40):
                known = [j for j in range(40) if folds[j] != folds[i]]
                deviation = vectors[known].std(axis=0) if standardised else numpy.ones(7)
                deviation[deviation == 0] = 1
                far = [(((vectors[i] - vectors[j]) / deviation) ** 2).sum() for j in known]
                right += labels[known[int(numpy.argmin(far))]] == labels[i]
            self.assertEqual(count_right(vectors, labels, folds, standardised), right)

    def test_all_settings(self):
        frames = [[[1, 9]] * 3, [[9, 1]] * 4, [[2, 18]] * 5, [[18, 2]] * 3]
        rows = ["0.npy,a", "1.npy,b", "2.npy,a", "3.npy,b"]
        trials = self.trials(frames, "frames,label", rows)
        results = settings(trials, folds_of(trials, "k-fold", 2))
        self.assertEqual(len(results), 2 * len(binned_nearest.VIEWS) + 2)
        self.assertEqual(results["shape 0", False], 4)


if __name__ == "__main__":
    unittest.main()
