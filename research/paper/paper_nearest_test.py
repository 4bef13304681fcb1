"""Tests of paper_nearest.py beside scikit-learn's PCA and nearest neighbour."""

import sys
import unittest

try:
    import numpy as np
    from sklearn.decomposition import PCA
    from sklearn.neighbors import KNeighborsClassifier

    import paper_nearest
except ImportError as error:
    print(f"skipped: {error}")
    sys.exit(0)


class PaperNearestTest(unittest.TestCase):
    def setUp(self):
        random = np.random.default_rng(3)
        shapes = random.normal(size=(4, 30, 3)) * [5, 1e-3, 1e-2]
        kinds = np.arange(200) % 4
        noise = random.normal(size=(200, 30, 3)) * [8, 2e-3, 2e-2]
        self.signals = shapes[kinds] + noise
        self.labels = np.array(["HU", "HM", "SU", "SM"])[kinds]
        self.conditions = np.array(["slow", "fast", "stiff"])[np.arange(200) % 3]

    def by_scikit_learn(self, features, scale, components):
        right = 0
        columns = [paper_nearest.COLUMNS[f] for f in features.split("+")]
        for condition in set(self.conditions):
            test = self.conditions == condition
            chosen = self.signals[:, :, columns]
            if scale:
                chosen = (chosen - chosen[~test].mean(axis=(0, 1))) / chosen[
                    ~test
                ].std(axis=(0, 1))
            vectors = chosen.transpose(0, 2, 1).reshape(200, -1)
            pca = PCA(components, svd_solver="full").fit(vectors[~test])
            nearest = KNeighborsClassifier(1).fit(
                pca.transform(vectors[~test]), self.labels[~test]
            )
            answers = nearest.predict(pca.transform(vectors[test]))
            right += np.sum(answers == self.labels[test])
        return right / 2

    def test_agrees_with_scikit_learn(self):
        for features in ("f", "m+a", "f+m+a"):
            for scale in (True, False):
                for components in (3, 0.95):
                    percent, _ = paper_nearest.accuracy(
                        self.signals,
                        self.labels,
                        self.conditions,
                        features,
                        scale,
                        components,
                    )
                    self.assertEqual(
                        percent,
                        self.by_scikit_learn(features, scale, components),
                        (features, scale, components),
                    )


if __name__ == "__main__":
    unittest.main()
