#!/usr/bin/python3
"""Tests of research/capacity.py against closed forms."""

import os
import sys
import unittest

sys.path.insert(0, os.path.dirname(os.path.abspath(__file__)))
import capacity  # noqa: E402

COST = {"message_us": 20, "frame_us": 5, "proxy_us": 12, "bytes": 1200}


class CapacityTest(unittest.TestCase):
    def test_costs_of_measured_cases(self):
        row = {"case": "direct", "servers": "1", "frames": "1", "cadence": "every-frame",
               "server_us": "25", "proxy_us": "0", "bytes": "1200"}
        rows = [row, row | {"frames": "4", "server_us": "40"},
                row | {"case": "proxied", "servers": "3", "proxy_us": "12"}]
        self.assertEqual(capacity.cost_of(rows), COST)

    def test_a_message_without_a_queue_waits_for_its_service_and_two_looks(self):
        delays = capacity.Case(1, 1, 1, 25, 0, seed=1).run()
        # Sent at a look, 0 to 0.1 ms after it is due, and seen at the next one.
        self.assertGreaterEqual(delays[0], 0.1)
        self.assertLessEqual(delays[-1], 0.2 + 0.1)
        self.assertEqual(len(delays), 200)

    def test_a_server_serves_what_its_thread_can(self):
        # One thread has 1e6 us a second.
        self.assertAlmostEqual(capacity.most_robots(COST, 1, seed=1) / (1e4 / 25), 1,
                               delta=0.05)
        self.assertAlmostEqual(capacity.most_robots(COST, 4, seed=1) / (4e4 / 40), 1,
                               delta=0.05)

    def test_the_same_seed_gives_the_same_delays(self):
        run = [capacity.Case(50, 2, 1, 25, 12, seed).run(0.2) for seed in (1, 1, 2)]
        self.assertEqual(run[0], run[1])
        self.assertNotEqual(run[0], run[2])

    def test_a_lone_server_is_away_as_often_as_it_fails_and_is_upgraded(self):
        result = capacity.Fleet(10, 1, COST, seed=3).run()
        fails = capacity.REPAIR_S / (capacity.FAILS_EVERY_S + capacity.REPAIR_S)
        upgrades = capacity.UPGRADE_S / capacity.UPGRADE_EVERY_S
        self.assertAlmostEqual(result["above"] / (fails + upgrades), 1, delta=0.5)
        self.assertEqual(result["fewest"], 0)

    def test_one_more_server_than_the_load_needs_outlives_a_failure(self):
        servers, result = capacity.smallest_fleet(100, COST, seed=1)
        self.assertGreaterEqual(servers, 2)
        self.assertLess(result["above"], capacity.MOST_TIME_ABOVE)

    def test_proxies_have_one_to_spare(self):
        self.assertEqual(capacity.proxies_for(100, COST), 2)
        # 1e8 messages a second of 12 us, on 8 threads that may be busy by 0.6.
        # The network would need 1,920 Gbit/s, twice 1,200 bytes, of 240.
        self.assertEqual(capacity.proxies_for(1_000_000, COST), 250 + 1)


if __name__ == "__main__":
    unittest.main()
