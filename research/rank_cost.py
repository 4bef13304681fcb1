#!/usr/bin/python3
"""What a training on several ranks costs: a model that is fitted to measured trainings.

    rank_cost.py rank_times.csv

The file is that of research/rank_times.sh. Prints tables in Markdown, which
docs/scaling.md shows: the coefficients, the measured trainings beside the model, and
what it predicts for as many processors as ranks. The model is fitted to processor time,
because other programs on the machine lengthen the time on the clock.
"""

import csv
import itertools
import math
import sys

import numpy

BATCH = 32  # preset world
EPOCHS = 12
HELD_OUT = 0.1
CLASSES = 4
# The largest class of the grid's contacts; its HMMs are one task.
LARGEST_CLASS = 0.315
# Networks of the preset: the classifier and the estimator, in bytes of their weights.
NETWORK_BYTES = (150_000, 40_000)
# From about so many contacts on, inputs are made anew for each batch, which takes as
# long as training on it (research/training-speed.md).
KEPT_CONTACTS = 70_000
CONTACT_BYTES = 16_000
FIXED_BYTES = 5e8
# Assumed of a network between hosts: 10 Gbit/s Ethernet with TCP.
HOP_SECONDS = 50e-6
BYTES_PER_SECOND = 1.1e9

# Seconds of processor time for one unit of work.
NAMES = {
    "start": "the first rank starts",
    "further": "each further rank starts",
    "read": "each rank reads a contact, and makes its inputs",
    "shared": "a contact's part of the HMMs and of the scores, at one rank",
    "gradient": "a contact's gradient of both networks, in each epoch",
    "shard": "a shard begins and ends, at one rank",
    "sum": "each rank adds a shard to the sum",
    "update": "each rank updates the weights after a batch",
    "exchange": "each rank waits for others, for each batch",
}


def steps_of(contacts, epochs):
    """Batches of one network in all epochs."""
    return epochs * math.ceil((1 - HELD_OUT) * contacts / BATCH)


def work(contacts, shards, epochs, ranks):
    """How many units of each kind a training does, at all ranks together."""
    # Networks of one shard are whole tasks: nobody waits for a batch.
    shards = min(shards, BATCH)
    steps = 2 * steps_of(contacts, epochs)
    together = ranks if shards > 1 else 1
    again = 2 if contacts > KEPT_CONTACTS else 1
    return {
        "start": 1,
        "further": ranks - 1,
        "read": contacts * ranks,
        "shared": contacts,
        "gradient": (1 - HELD_OUT) * contacts * epochs * again,
        "shard": steps * shards,
        "sum": steps * shards * together if shards > 1 else 0,
        "update": steps * together,
        "exchange": steps * ranks if ranks > 1 and shards > 1 else 0,
    }


def fit(rows):
    """Coefficients that are not negative, with the least squares of relative errors."""
    units = [work(*row[:4]) for row in rows]
    matrix = numpy.array([[unit[name] for name in NAMES] for unit in units], float)
    matrix /= numpy.array([row[5] for row in rows])[:, None]
    scale = numpy.abs(matrix).max(axis=0)
    scale[scale == 0] = 1
    best = None
    # All sets of coefficients that may be more than zero: exact, and only 511.
    for size in range(1, len(NAMES) + 1):
        for chosen in itertools.combinations(range(len(NAMES)), size):
            part = matrix[:, chosen] / scale[list(chosen)]
            solved = numpy.linalg.lstsq(part, numpy.ones(len(rows)), rcond=None)[0]
            if (solved < 0).any():
                continue
            error = ((part @ solved - 1) ** 2).sum()
            if best is None or error < best[0] - 1e-12:
                best = error, chosen, solved
    found = dict.fromkeys(NAMES, 0.0)
    for column, value in zip(best[1], best[2]):
        found[list(NAMES)[column]] = value / scale[column]
    return found


def processor_time(cost, *training):
    return sum(cost[name] * amount for name, amount in work(*training).items())


def largest_task(weights, ranks):
    """The work of the rank that has the most, if the heaviest task is given first."""
    loads = [0.0] * ranks
    for weight in sorted(weights, reverse=True):
        loads[loads.index(min(loads))] += weight
    return max(loads)


def predicted_time(cost, contacts, shards, epochs, ranks):
    """Seconds on the clock, if each rank has a processor and hosts are connected."""
    shards = min(shards, BATCH)
    steps = steps_of(contacts, epochs)
    units = work(contacts, shards, epochs, 1)
    gradient = cost["gradient"] * units["gradient"]
    update = cost["update"] * steps
    rest = (1 - LARGEST_CLASS) / (CLASSES - 1)
    hmms = [cost["shared"] * contacts * share for share in [LARGEST_CLASS] + [rest] * 3]
    time = cost["start"] + (cost["further"] if ranks > 1 else 0) + cost["read"] * contacts
    if shards == 1:
        # By their sizes, the classifier is three quarters of both networks.
        networks = [gradient * share + update + cost["shard"] * steps for share in (0.75, 0.25)]
        return time + largest_task(hmms + networks, ranks)
    time += largest_task(hmms, ranks)
    mine = math.ceil(shards / ranks) / shards
    time += mine * (gradient + 2 * cost["shard"] * steps * shards)
    time += 2 * steps * (cost["sum"] * shards + cost["update"])
    if ranks > 1:
        hops = 2 * math.ceil(math.log2(ranks)) * HOP_SECONDS
        for weights in NETWORK_BYTES:
            sent = weights * shards * (ranks - 1) / ranks / BYTES_PER_SECOND
            time += steps * (hops + sent)
    return time


def memory(contacts):
    """Bytes of each rank."""
    return FIXED_BYTES + CONTACT_BYTES * contacts


def read(path):
    with open(path, encoding="utf-8", newline="") as file:
        return [
            (int(row["contacts"]), int(row["shards"]), int(row["epochs"]), int(row["ranks"]),
             float(row["seconds"]), float(row["processor_seconds"]))
            for row in csv.DictReader(file)
        ]


def duration(seconds):
    if seconds < 3600:
        return f"{seconds / 60:.0f} min"
    return f"{seconds / 3600:.1f} h" if seconds < 100 * 3600 else f"{seconds / 86400:.0f} d"


def print_report(rows):
    cost = fit(rows)
    print("| coefficient | us |\n|---|---|")
    for name, text in NAMES.items():
        print(f"| {text} | {1e6 * cost[name]:.3g} |")
    print("\n| contacts | shards | epochs | ranks | measured: time, s | processor time, s "
          "| model: processor time, s | off by, % |\n|---|---|---|---|---|---|---|---|")
    for row in rows:
        model = processor_time(cost, *row[:4])
        print(f"| {' | '.join(str(value) for value in row[:4])} | {row[4]:.1f} | {row[5]:.1f} "
              f"| {model:.1f} | {100 * (model / row[5] - 1):+.0f} |")
    print("\n| contacts | shards | memory of a rank, GB | "
          + " | ".join(f"{2**k} rank{'s' if k else ''}" for k in range(7)) + " |")
    print("|" + "---|" * 10)
    for contacts in (64_000, 1_000_000, 10_000_000):
        for shards in (1, 8, 32):
            times = [
                duration(predicted_time(cost, contacts, shards, EPOCHS, 2**k))
                for k in range(7)
            ]
            print(f"| {contacts} | {shards} | {memory(contacts) / 1e9:.1f} | "
                  f"{' | '.join(times)} |")


if __name__ == "__main__":
    if len(sys.argv) != 2:
        sys.exit("rank_cost: got not one file of times")
    print_report(read(sys.argv[1]))
