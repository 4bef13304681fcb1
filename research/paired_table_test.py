#!/usr/bin/python3
"""Tests of research/paired_table.py on answers made by hand."""

import math
import os
import subprocess
import sys
import tempfile
import unittest

sys.path.insert(0, os.path.dirname(os.path.abspath(__file__)))
from paired_table import mcnemar, table  # noqa: E402


class PairedTableTest(unittest.TestCase):
    def setUp(self):
        self.scratch = tempfile.TemporaryDirectory()
        self.addCleanup(self.scratch.cleanup)

    def answers(self, file, right, first_trial=0):
        """Writes answers; the characters of `right` say which are right: x or not."""
        path = os.path.join(self.scratch.name, file)
        with open(path, "w", encoding="utf-8") as out:
            out.write('trial,label,label_so_far,answer,probability_HU,"probability_a, b"\n')
            for number, mark in enumerate(right, first_trial):
                answer = "HU,0.8,0.2" if mark == "x" else '"a, b",0.4,0.6'
                out.write(f"t{number},HU,,{answer}\n")
        return path

    def test_exact_probabilities(self):
        # Of a table of the binomial distribution.
        self.assertEqual(mcnemar(0, 0), 1)
        self.assertEqual(mcnemar(3, 3), 1)
        self.assertAlmostEqual(mcnemar(5, 0), 2 / 32)
        self.assertAlmostEqual(mcnemar(2, 8), 2 * (1 + 10 + 45) / 1024)
        self.assertEqual(mcnemar(2, 8), mcnemar(8, 2))
        # Many trials: as the normal distribution with continuity correction.
        z = (5200 - 4800 - 1) / math.sqrt(10000)
        self.assertAlmostEqual(mcnemar(5200, 4800), math.erfc(z / math.sqrt(2)), places=5)

    def test_rows(self):
        first = self.answers("all.csv", "xxxx..xxxx")
        other = self.answers("less.csv", "xx..x.xx..")
        lines, accuracies = table([first, other])
        self.assertEqual(accuracies, [80, 50])
        self.assertEqual(
            lines[2], "| all | 10 | 80.00 (49.02 to 94.33) | 0.3618 | - | - | - |"
        )
        self.assertEqual(
            lines[3], "| less | 10 | 50.00 (23.66 to 76.34) | 0.5697 | 1 | 4 | 0.38 |"
        )
        loss = -(8 * math.log(0.8) + 2 * math.log(0.4)) / 10
        self.assertAlmostEqual(loss, 0.3618, places=4)

    def test_the_order_of_trials_does_not_matter(self):
        first = self.answers("a.csv", "x.x")
        with open(first, encoding="utf-8") as file:
            header, *rows = file.readlines()
        other = os.path.join(self.scratch.name, "b.csv")
        with open(other, "w", encoding="utf-8") as file:
            file.writelines([header, *reversed(rows)])
        self.assertTrue(table([first, other])[0][3].endswith("| 0 | 0 | 1 |"))

    def test_other_trials_are_refused(self):
        first = self.answers("a.csv", "xxx")
        other = self.answers("b.csv", "xxx", first_trial=1)
        run = self.run_program(first, other)
        self.assertNotEqual(run.returncode, 0)
        self.assertIn("trial t0 differs", run.stderr)
        self.assertNotEqual(self.run_program(first).returncode, 0)

    def test_spread(self):
        first = self.answers("1.csv", "xx..")
        other = self.answers("2.csv", "xxx.")
        self.assertIn(
            "Mean 62.50 %, standard deviation 17.68 points, of 2.",
            self.run_program("--spread", first, other).stdout,
        )
        self.assertNotIn("Mean", self.run_program(first, other).stdout)

    def run_program(self, *arguments):
        program = os.path.join(os.path.dirname(os.path.abspath(__file__)), "paired_table.py")
        return subprocess.run(
            [sys.executable, "-B", program, *arguments], capture_output=True, text=True, check=False
        )


if __name__ == "__main__":
    unittest.main()
