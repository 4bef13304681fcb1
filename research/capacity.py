#!/usr/bin/python3
"""How many servers and proxies robots need: a simulation, seeded.

    capacity.py [--seed=N] replica_load.csv

The file is that of research/replica_load.sh: what messages cost here. Prints tables in
Markdown, which docs/scaling.md shows: the measured cases beside the simulation of the
same queues, then fleets with failures and rolling upgrades. What is assumed stands in
the constants below; nothing larger than three servers was measured.
"""

import argparse
import csv
import heapq
import math
import random

import numpy

RATE_HZ = 100
# The work of the generator for a message, and how often it looked for answers, when
# MEASURED_MOST was measured: by gRPC's client, before it used nghttp2.
GENERATOR_US = 9
POLL_US = 100
PROCESSORS = 2
# Service times vary: caches, and the steps of models.
VARIATION = 0.3
P99_LIMIT_MS = 10
# Of docs/performance.md, load/max_robots: what --find-max found on this machine.
MEASURED_MOST = {1: 387, 4: 975}

# A fleet's machines: sixteen processors, eight serving threads (tactusd's default).
SERVING_THREADS = 8
PROXY_THREADS = 8
PROXY_SHARE = 0.6
PROXY_GBIT_S = 8
# The busiest server may be so busy. HAProxy's consistent hash fills it more than others.
MOST_BUSY = 0.8
HASH_IMBALANCE = 1.15
MOST_TIME_ABOVE = 1e-4
DAY_S = 86_400
FAILS_EVERY_S = 30 * DAY_S
REPAIR_S = 600
UPGRADE_EVERY_S = 7 * DAY_S
UPGRADE_S = 90
UPGRADE_BATCH = 0.05
# A robot that moves sends the frames of its contact again.
RESUME_US = 2_000
RESUMED_WITHIN_S = 10
STEP_S = 30
DAYS = 365
# Servers of one catalogue. Each reads the signs of life of all.
CELL = 32
STATEMENTS_PER_HOUR = 29_160
CONNECTIONS = 9


def cost_of(rows):
    """Microseconds of a server for a message and for each frame in it, of a proxy for
    a message, and bytes of a message with its answer; of one frame each."""
    def of(case, servers, frames, column):
        return next(
            float(row[column]) for row in rows
            if row["case"] == case and row["servers"] == servers
            and row["frames"] == frames and row["cadence"] == "every-frame")
    one, four = (of("direct", "1", frames, "server_us") for frames in ("1", "4"))
    frame = (four - one) / 3
    return {
        "message_us": one - frame,
        "frame_us": frame,
        "proxy_us": of("proxied", "3", "1", "proxy_us"),
        "bytes": of("direct", "1", "1", "bytes"),
    }


def service_us(cost, frames):
    return cost["message_us"] + cost["frame_us"] * frames


class Case:
    """Robots that send to servers of one thread each on this machine."""

    def __init__(self, robots, servers, frames, server_us, proxy_us, seed):
        self.random = random.Random(seed)
        self.robots, self.servers, self.frames = robots, servers, frames
        messages = robots * RATE_HZ / frames / 1e6
        busy = messages * (server_us + proxy_us + GENERATOR_US)
        # All share the processors: more work than that takes longer.
        self.slower = max(1.0, busy / PROCESSORS)
        self.server_us, self.proxy_us = server_us, proxy_us

    def vary(self, mean_us):
        return mean_us * self.slower * self.random.lognormvariate(
            -VARIATION**2 / 2, VARIATION)

    def run(self, seconds=2.0):
        """Delays from due to answer in ms, sorted."""
        period = 1e6 * self.frames / RATE_HZ
        due = [(self.random.uniform(0, period), robot) for robot in range(self.robots)]
        heapq.heapify(due)
        free = {"generator": 0.0, "proxy": 0.0}
        servers = [0.0] * self.servers
        delays = []

        def queue(name, at, mean_us):
            free[name] = max(free[name], at) + self.vary(mean_us)
            return free[name]

        while due[0][0] < seconds * 1e6:
            at, robot = due[0]
            heapq.heapreplace(due, (at + period, robot))
            seen = math.ceil(at / POLL_US) * POLL_US
            sent = queue("generator", seen, GENERATOR_US)
            if self.proxy_us:
                sent = queue("proxy", sent, self.proxy_us)
            server = robot % self.servers
            servers[server] = max(servers[server], sent) + self.vary(self.server_us)
            answered = math.ceil(servers[server] / POLL_US) * POLL_US
            delays.append((answered - at) / 1000)
        return sorted(delays)


def quantile(values, p):
    """By nearest rank."""
    return values[max(0, math.ceil(p * len(values)) - 1)]


def most_robots(cost, frames, seed):
    """The most robots that one server answers in time."""
    low, high = 1, 20_000
    while high - low > max(1, low // 100):
        middle = (low + high) // 2
        # A server and its generator have a processor each; the queue decides.
        case = Case(middle, 1, frames, service_us(cost, frames), 0, seed)
        if quantile(case.run(), 0.99) < P99_LIMIT_MS:
            low = middle
        else:
            high = middle
    return low


class Fleet:
    """Servers of a fleet in steps of STEP_S: which share of time the busiest one is
    busier than MOST_BUSY."""

    def __init__(self, robots, servers, cost, seed):
        self.random = numpy.random.default_rng(seed)
        self.robots, self.servers = robots, servers
        self.work = robots * RATE_HZ * service_us(cost, 1) / 1e6 / SERVING_THREADS
        # Robots of a server vary as the hash throws them.
        spread = 3 / math.sqrt(max(1, robots / servers))
        self.imbalance = max(HASH_IMBALANCE, 1 + spread) if servers > 1 else 1

    def run(self):
        steps = DAYS * DAY_S // STEP_S
        batch = max(1, int(self.servers * UPGRADE_BATCH))
        upgrade_steps = math.ceil(self.servers / batch) * UPGRADE_S // STEP_S
        every = UPGRADE_EVERY_S // STEP_S
        failing = self.random.random(steps).tolist()
        chance = STEP_S / FAILS_EVERY_S
        down, above, moved, fewest = 0, 0, 0, self.servers
        for step in range(steps):
            if down:
                down -= self.random.binomial(down, STEP_S / REPAIR_S)
            upgraded = batch if step % every < upgrade_steps else 0
            serving = max(0, self.servers - down - upgraded)
            fails = failing[step] < serving * chance
            lost = int(fails)
            down += lost
            # Drains move robots, too, one batch after the other.
            leaves = lost + (upgraded if step % (UPGRADE_S // STEP_S) == 0 else 0)
            serving = max(0, serving - lost)
            fewest = min(fewest, serving)
            if serving == 0:
                above += 1
                continue
            gone = self.robots * leaves / self.servers
            moved += gone
            resumed = gone * RESUME_US / 1e6 / RESUMED_WITHIN_S / SERVING_THREADS
            busy = (self.work + resumed) / serving * self.imbalance
            above += busy > MOST_BUSY
        return {"above": above / steps, "moved_a_day": moved / DAYS, "fewest": fewest}


def smallest_fleet(robots, cost, seed):
    """The fewest servers that are too busy for less than MOST_TIME_ABOVE."""
    servers = max(1, math.floor(Fleet(robots, 1, cost, seed).work / MOST_BUSY))
    while True:
        result = Fleet(robots, servers, cost, seed).run()
        if result["above"] < MOST_TIME_ABOVE:
            return servers, result
        servers += max(1, servers // 50)


def proxies_for(robots, cost):
    """Proxies, of which one may be away."""
    messages = robots * RATE_HZ
    by_time = messages * cost["proxy_us"] / 1e6 / PROXY_THREADS / PROXY_SHARE
    by_network = 2 * messages * cost["bytes"] * 8 / 1e9 / PROXY_GBIT_S
    return math.ceil(max(by_time, by_network)) + 1


def print_cases(rows, cost, seed):
    print("| case | servers | robots | frames a message | measured p50, p99, ms "
          "| simulated p50, p99, ms | server, us a message | proxy, us |")
    print("|---|---|---|---|---|---|---|---|")
    for row in rows:
        if row["cadence"] != "every-frame":
            continue
        case = Case(int(row["robots"]), int(row["servers"]), int(row["frames"]),
                    float(row["server_us"]), float(row["proxy_us"]), seed)
        delays = case.run()
        print(f"| {row['case']} | {row['servers']} | {row['robots']} | {row['frames']} "
              f"| {float(row['p50_ms']):.2f}, {float(row['p99_ms']):.2f} "
              f"| {quantile(delays, 0.5):.2f}, {quantile(delays, 0.99):.2f} "
              f"| {float(row['server_us']):.1f} | {float(row['proxy_us']):.1f} |")
    print("\n| frames a message | robots of one server, measured | simulated |")
    print("|---|---|---|")
    for frames, measured in MEASURED_MOST.items():
        print(f"| {frames} | {measured} | {most_robots(cost, frames, seed)} |")


def print_fleets(cost, seed):
    print("\n| robots | servers | fewest that served | time above the limit | robots that "
          "move in a day | proxies | catalogues | statements/s | connections of a database "
          "| network of all servers, Gbit/s |")
    print("|---|---|---|---|---|---|---|---|---|---|")
    for robots in (100, 10_000, 1_000_000):
        servers, result = smallest_fleet(robots, cost, seed)
        cells = math.ceil(servers / CELL)
        print(f"| {robots:,} | {servers} | {result['fewest']} | {result['above']:.1e} "
              f"| {result['moved_a_day']:.0f} | {proxies_for(robots, cost)} | {cells} "
              f"| {servers * STATEMENTS_PER_HOUR / 3600:.0f} "
              f"| {math.ceil(servers / cells) * CONNECTIONS} "
              f"| {robots * RATE_HZ * cost['bytes'] * 8 / 1e9:.2f} |")


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--seed", type=int, default=1)
    parser.add_argument("cases")
    arguments = parser.parse_args()
    with open(arguments.cases, encoding="utf-8", newline="") as file:
        rows = list(csv.DictReader(file))
    cost = cost_of(rows)
    print_cases(rows, cost, arguments.seed)
    print_fleets(cost, arguments.seed)


if __name__ == "__main__":
    main()
