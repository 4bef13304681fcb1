#!/usr/bin/python3
"""How well a learner that is told what to look for finds foreign materials.

    world-signals --data=inside.h5 --out=inside
    unknown_bound.py inside softer-3x lighter-10x

Compares folders of contacts with the first one's. Boosted trees learn from summaries
of both, and are tested on materials that they have not learned from. Prints areas
under the ROC curve as a Markdown table: of all contacts, and of those with objects
that do not move and that do.
"""

import sys

import numpy as np
from sklearn.model_selection import GroupKFold

from summaries import Contacts
from unknown_scores import area
from upper_reference import trees

FOLDS = 4
SECONDS = 5.0


def read(folder):
    """Summaries, materials, and whether the object has moved in the end."""
    contacts = Contacts(folder)
    moved = np.char.endswith(np.array(contacts.array("label")), "M")
    return contacts.felt(SECONDS), np.array(contacts.array("material")), moved


def foreign(inside, outside):
    """Whether each contact is one of outside, and how probable the trees find it."""
    table = np.vstack([inside[0], outside[0]])
    truth = np.repeat([0, 1], [len(inside[0]), len(outside[0])])
    materials = np.concatenate([inside[1], outside[1]])
    answer = np.zeros(len(truth))
    for learn, test in GroupKFold(FOLDS).split(table, truth, materials):
        learner = trees(table[learn], truth[learn], 100)
        answer[test] = learner.predict_proba(table[test])[:, 1]
    return truth, answer


def compare(folders):
    inside = read(folders[0])
    print("| materials | felt | all | not moved | moved |")
    print("|---|---|---|---|---|")
    for folder in folders[1:]:
        outside = read(folder)
        truth, answer = foreign(inside, outside)
        moved = np.concatenate([inside[2], outside[2]])
        cells = [area(truth, answer)]
        for part in (~moved, moved):
            both = len(set(truth[part])) == 2
            cells.append(area(truth[part], answer[part]) if both else "none")
        print(f"| {folder} | {len(outside[0])} | {' | '.join(cells)} |", flush=True)


if __name__ == "__main__":
    compare(sys.argv[1:])
