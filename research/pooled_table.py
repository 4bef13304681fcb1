"""Writes reports of `trainctl evaluate --json`, one of each seed, as a Markdown table.

    pooled_table.py cody-1.json cody-2.json ...

The last row pools the contacts of all seeds: one accuracy, one calibration error.
"""

import json
import sys

from intervals import wilson

AT = "1.2"


def calibration_error(bins):
    """Expected calibration error of bins: (sum of probabilities, right, contacts)."""
    contacts = sum(count for _, _, count in bins.values())
    return sum(abs(probability - right) for probability, right, _ in bins.values()) / contacts


def main():
    rows = []
    for path in sys.argv[1:]:
        with open(path, encoding="utf-8") as file:
            report = json.load(file)
        felt = report["felt"]
        bins = {
            round(b["low"], 6): (b["mean_probability"] * b["contacts"], b["right"], b["contacts"])
            for b in report["reliability"]
        }
        soon = round(report["so_far"]["accuracy_at"][AT] * felt)
        rows.append((str(report["seed"]), report["trials"], felt, report["right"], soon, bins))
    pooled = {}
    for *_, bins in rows:
        for low, values in bins.items():
            pooled[low] = tuple(map(sum, zip(pooled.get(low, (0, 0, 0)), values)))
    totals = [sum(row[column] for row in rows) for column in range(1, 5)]
    rows.append(("**all**", *totals, pooled))
    print(f"| seed | felt | right in the end, % | right so far after {AT} s, % | calibration error in the end |")
    print("|---|---|---|---|---|")
    for seed, trials, felt, right, soon, bins in rows:
        print(
            f"| {seed} | {felt} of {trials} | {wilson(right, felt)} | {wilson(soon, felt)} "
            f"| {calibration_error(bins):.3f} |"
        )


if __name__ == "__main__":
    main()
