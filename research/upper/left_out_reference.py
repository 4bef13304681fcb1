#!/usr/bin/python3
"""How well boosted trees classify contacts with one robot condition left out.

    trainctl simulate --protocol=paper --out=signals.h5
    world-signals --data=signals.h5 --out=signals
    left_out_reference.py signals

The trees and their summaries are those of upper_reference.py. Prints accuracies, by
the class in the end, as a Markdown table.
"""

import sys

import numpy as np

from summaries import Contacts
from upper_reference import cell, trees

SECONDS = [1.2, 5.0]
ITERATIONS = 120


def answers(table, labels, conditions):
    """Each contact's answer by trees that learned from the other conditions."""
    answer = np.zeros(len(labels), dtype=int)
    for condition in np.unique(conditions):
        test = conditions == condition
        learner = trees(table[~test], labels[~test], ITERATIONS)
        answer[test] = learner.predict(table[test])
    return answer


def main(folder):
    contacts = Contacts(folder)
    conditions = np.array(contacts.array("condition"))
    cells = []
    for seconds in SECONDS:
        labels = contacts.labels(seconds, so_far=False)
        found = answers(contacts.felt(seconds), labels, conditions)
        cells.append(cell(found, labels))
    print("| accuracy, % (95 % interval) | 1.2 s | 5 s |")
    print("|---|---|---|")
    print(f"| trees | {' | '.join(cells)} |")


if __name__ == "__main__":
    main(*sys.argv[1:])
