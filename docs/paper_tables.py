"""Writes the JSON of `trainctl reproduce --json` (stdin) as Markdown tables."""

import json
import sys


def percent(value):
    return "-" if value is None else f"{value:.2f}"


def main():
    rows = json.load(sys.stdin)["rows"]
    for experiment in ("simulation", "cody"):
        print(f"\n## {experiment.capitalize()}\n")
        print("| algorithm | features | here, % | paper, % | difference |")
        print("|---|---|---|---|---|")
        for row in rows:
            if row["experiment"] != experiment:
                continue
            print(
                f"| {row['algorithm']} | {row['features']} "
                f"| {percent(row['ours'])} | {percent(row['paper'])} "
                f"| {percent(row['difference'])} |"
            )
        print(f"\n![Accuracy](paper-tables/{experiment}-accuracy.png)\n")
        for algorithm in ("hmm", "lstm", "1nn"):
            figure = f"paper-tables/{experiment}-confusion-{algorithm}-f-m-a.png"
            print(f"![{algorithm}, all features]({figure})")


main()
