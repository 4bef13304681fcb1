#!/usr/bin/python3
"""Tests of summaries.py and upper_reference.py on arrays made by hand."""

import os
import sys
import tempfile
import unittest

import numpy as np

try:
    from upper_reference import wilson
except ImportError:
    print("skipped: scikit-learn is not installed")
    sys.exit(0)
from summaries import Contacts


def write(folder, felt, onset=(0, 3), moved=(-1, 40)):
    generator = np.random.default_rng(2)
    arrays = {
        "label": np.array(["HU", "SM"]),
        "felt": felt,
        "true": generator.random((2, 500, 3)),
        "onset": np.array(onset, float),
        "moved": np.array(moved, float),
        "cues": np.zeros((2, 6, 1)),
        "cue_names": np.array(["force"]),
        "recorded": np.array(3.0),
    }
    for name, array in arrays.items():
        np.save(os.path.join(folder, name + ".npy"), array)
    return Contacts(folder)


class SummariesTest(unittest.TestCase):
    def setUp(self):
        self.folder = tempfile.mkdtemp()
        self.felt = np.random.default_rng(1).random((2, 500, 4))

    def test_only_frames_so_far_count(self):
        before = write(self.folder, self.felt).felt(1.2)
        later = self.felt.copy()
        later[:, 120:] *= 7
        np.testing.assert_array_equal(before, write(self.folder, later).felt(1.2))
        later[:, 119] *= 7
        after = write(self.folder, later).felt(1.2)
        self.assertFalse(np.array_equal(before, after, equal_nan=True))

    def test_true_signals_begin_at_the_onset(self):
        contacts = write(self.folder, self.felt)
        moved = np.load(os.path.join(self.folder, "true.npy"))
        moved[1, :-3] = moved[1, 3:].copy()
        before = contacts.true(1.2)
        np.save(os.path.join(self.folder, "true.npy"), moved)
        np.save(os.path.join(self.folder, "onset.npy"), np.zeros(2))
        np.testing.assert_array_equal(before, Contacts(self.folder).true(1.2))

    def test_an_object_is_unmoved_until_it_has_moved(self):
        contacts = write(self.folder, self.felt, moved=(-1, 120))
        self.assertEqual(contacts.labels(1.2, so_far=False).tolist(), [0, 3])
        self.assertEqual(contacts.labels(1.2, so_far=True).tolist(), [0, 2])
        self.assertEqual(contacts.labels(2.5, so_far=True).tolist(), [0, 3])

    def test_wilson_is_trainctls(self):
        # trainctl evaluate: 18,668 of 19,619 are 95.15 % (94.84 to 95.44 %).
        low, high = wilson(18668, 19619)
        self.assertEqual((round(100 * low, 2), round(100 * high, 2)), (94.84, 95.44))


if __name__ == "__main__":
    unittest.main()
