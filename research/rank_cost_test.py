#!/usr/bin/python3
"""Tests of research/rank_cost.py on trainings that are made by hand."""

import os
import sys
import unittest

sys.path.insert(0, os.path.dirname(os.path.abspath(__file__)))
import rank_cost  # noqa: E402

COST = {
    "start": 0.4, "further": 0.2, "read": 2e-4, "shared": 3e-4, "gradient": 2e-4,
    "shard": 1e-4, "sum": 5e-5, "update": 4e-4, "exchange": 3e-4,
}


class RankCostTest(unittest.TestCase):
    def test_the_fit_finds_the_cost_of_exact_times(self):
        rows = []
        for contacts in (1000, 8000):
            for shards in (1, 2, 8, 32):
                for epochs in (1, 4):
                    for ranks in (1, 2, 3, 4):
                        training = (contacts, shards, epochs, ranks)
                        time = rank_cost.processor_time(COST, *training)
                        rows.append((*training, 0, time))
        found = rank_cost.fit(rows)
        for name, cost in COST.items():
            self.assertAlmostEqual(found[name] / cost, 1, places=3, msg=name)

    def test_nothing_costs_less_than_nothing(self):
        rows = [(1000, 8, epochs, ranks, 0, 1 + 0.3 * ranks - 0.1 * epochs)
                for epochs in (1, 2, 4) for ranks in (1, 2, 3)]
        self.assertTrue(all(cost >= 0 for cost in rank_cost.fit(rows).values()))

    def test_tasks_are_shared_out(self):
        self.assertEqual(rank_cost.largest_task([3, 3, 2, 2, 2], 1), 12)
        # The best is 6; this rule finds 7 (Graham, 1969).
        self.assertEqual(rank_cost.largest_task([3, 3, 2, 2, 2], 2), 7)
        self.assertEqual(rank_cost.largest_task([3, 3, 2, 2, 2], 64), 3)

    def test_steps(self):
        # Of 1,000 contacts 900 are fitted to, in 29 batches of 32.
        self.assertEqual(rank_cost.steps_of(1000, 2), 58)

    def test_one_rank_takes_its_processor_time(self):
        for shards in (1, 8):
            training = (50_000, shards, 3, 1)
            self.assertAlmostEqual(
                rank_cost.predicted_time(COST, *training)
                / rank_cost.processor_time(COST, *training), 1, places=2)

    def test_more_ranks_than_shards_help_no_more(self):
        one, eight, many = (rank_cost.predicted_time(COST, 50_000, 8, 3, ranks)
                            for ranks in (1, 8, 64))
        self.assertLess(eight, one)
        self.assertGreater(many, eight)


if __name__ == "__main__":
    unittest.main()
