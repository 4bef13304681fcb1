"""Tests of taxel_nearest.py, beside scikit-learn's nearest neighbour."""

import sys
import unittest

try:
    import h5py  # noqa: F401
    import numpy as np
    from sklearn.neighbors import KNeighborsClassifier

    import taxel_nearest
except ImportError as error:
    print(f"skipped: {error}")
    sys.exit(0)


class TaxelNearestTest(unittest.TestCase):
    def test_bins_are_means_over_stretches_of_equal_length(self):
        trial = np.array([[1.0, 10], [3, 30], [5, 50], [7, np.nan]])
        binned = taxel_nearest.binned([trial], 2)
        self.assertEqual(binned.tolist(), [[2, 20, 6, 25]])

    def test_the_trials_of_each_class_are_dealt_to_the_folds_in_turn(self):
        folds = taxel_nearest.folds_of(["a", "a", "b", "a", "b"], 2)
        self.assertEqual(folds.tolist(), [0, 1, 0, 0, 1])

    def test_agrees_with_scikit_learn(self):
        random = np.random.default_rng(1)
        labels = np.arange(90) % 3
        vectors = random.normal(size=(90, 5)) + labels[:, None]
        # The last 30 are only learned from.
        folds = np.where(np.arange(90) < 60, np.arange(90) % 4, -1)
        right = 0
        for fold in range(4):
            test = folds == fold
            learner = KNeighborsClassifier(1).fit(vectors[~test], labels[~test])
            right += np.sum(learner.predict(vectors[test]) == labels[test])
        self.assertEqual(taxel_nearest.count_right(vectors, labels, folds), right)


if __name__ == "__main__":
    unittest.main()
