"""Tests of unknown_bound.py: it finds what differs, and nothing else."""

import sys
import unittest

try:
    import numpy as np
    import sklearn  # noqa: F401
except ImportError:
    print("skipped: needs python3-numpy and python3-sklearn")
    sys.exit(0)

import unknown_bound


def contacts(random, group, count, mean):
    """Two hundred contacts a material, whose summaries also name the material."""
    materials = np.repeat(np.arange(count), 200)
    own = random.normal(size=(count, 1))[materials]
    noise = random.normal(mean, 1, size=(len(materials), 3))
    names = np.array([f"{group}/{n}" for n in materials])
    return np.hstack([own, noise]), names


class UnknownBoundTest(unittest.TestCase):
    def found(self, mean):
        random = np.random.default_rng(1)
        known, answer = unknown_bound.foreign(
            contacts(random, "inside", 12, 0), contacts(random, "outside", 8, mean)
        )
        return float(unknown_bound.area(known, answer).split()[0])

    def test_finds_what_differs(self):
        self.assertGreater(self.found(mean=3), 0.99)

    def test_does_not_learn_the_materials_by_heart(self):
        self.assertLess(abs(self.found(mean=0) - 0.5), 0.25)


if __name__ == "__main__":
    unittest.main()
