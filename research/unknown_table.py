"""Writes answers of `trainctl classify --json` as a Markdown table of `unknown`.

    unknown_table.py inside.json softer-3x.json ...

The contacts of the first file are known; each other file is compared with them.
"""

import json
import math
import os
import sys

from intervals import Z, wilson


def area(positive, negative):
    """Area under the ROC curve, and its interval (Hanley and McNeil 1982, eq. 1)."""
    wins = sum((p > n) + 0.5 * (p == n) for p in positive for n in negative)
    a = wins / len(positive) / len(negative)
    q1, q2 = a / (2 - a), 2 * a * a / (1 + a)
    variance = a * (1 - a) + (len(positive) - 1) * (q1 - a * a) + (len(negative) - 1) * (q2 - a * a)
    half = Z * math.sqrt(variance / len(positive) / len(negative))
    return f"{a:.3f} ({max(a - half, 0):.3f} to {min(a + half, 1):.3f})"


def main():
    groups = {}
    for path in sys.argv[1:]:
        with open(path, encoding="utf-8") as file:
            trials = json.load(file)["trials"]
        felt = [trial for trial in trials if trial["detected"]]
        groups[os.path.basename(path).removesuffix(".json")] = (felt, len(trials))
    known = [trial["unknown"] for trial in next(iter(groups.values()))[0]]
    print("| materials | felt | right answers, % | most frequent class, % | called unknown, % | area under the ROC curve |")
    print("|---|---|---|---|---|---|")
    for number, (name, (felt, count)) in enumerate(groups.items()):
        scores = [trial["unknown"] for trial in felt]
        right = sum(trial["answer"] == trial["label"] for trial in felt)
        labels = [trial["label"] for trial in felt]
        most = max(labels.count(label) for label in set(labels))
        called = sum(score > 0.5 for score in scores)
        against = "-" if number == 0 else area(scores, known)
        print(
            f"| {name} | {len(felt)} of {count} | {wilson(right, len(felt), 1)} "
            f"| {100 * most / len(felt):.1f} | {wilson(called, len(felt), 1)} | {against} |"
        )


if __name__ == "__main__":
    main()
