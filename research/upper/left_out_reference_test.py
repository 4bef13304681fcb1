"""Tests of left_out_reference.py: the condition that is asked about is left out."""

import sys
import unittest

import numpy as np

try:
    import left_out_reference
except ImportError:
    print("skipped: scikit-learn is not installed")
    sys.exit(0)


class LeftOutReferenceTest(unittest.TestCase):
    def setUp(self):
        self.conditions = np.repeat(["slow", "fast", "stiff"], 100)
        self.labels = np.tile([0, 1], 150)

    def right(self, table):
        answer = left_out_reference.answers(table, self.labels, self.conditions)
        return np.mean(answer == self.labels)

    def test_learns_what_holds_in_all_conditions(self):
        self.assertGreater(self.right(self.labels[:, None].astype(float)), 0.99)

    def test_learns_nothing_from_the_condition_left_out(self):
        # In each condition another value tells the labels apart.
        _, number = np.unique(self.conditions, return_inverse=True)
        table = (10.0 * number + self.labels)[:, None]
        self.assertLess(self.right(table), 0.6)


if __name__ == "__main__":
    unittest.main()
