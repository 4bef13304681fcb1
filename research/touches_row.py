"""A row of the page of touches: the counts of one evaluation.

    research/touches_row.py NAME EVALUATION.json
"""

import json
import sys


def commas(number):
    return f"{number:,}"


def row(name, evaluation):
    contacts = evaluation["contacts"]
    felt = contacts["found"] + contacts["merged"]
    low, high = contacts["accuracy_interval"]
    labels = [line["contacts"] for line in evaluation["per_class"]]
    cells = [name]
    for count in ("touches", "found", "broken", "merged", "switched", "spurious"):
        cells.append(commas(contacts[count]))
    cells.append(
        f"{100 * contacts['accuracy']:.2f} % ({100 * low:.2f} to "
        f"{100 * high:.2f} %) of {commas(felt)}"
    )
    cells.append(f"{evaluation['ece']:.3f}")
    cells.append(f"{100 * max(labels) / sum(labels):.1f} %")
    return "| " + " | ".join(cells) + " |"


if __name__ == "__main__":
    with open(sys.argv[2], encoding="utf-8") as file:
        print(row(sys.argv[1], json.load(file)))
