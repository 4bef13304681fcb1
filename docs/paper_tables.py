"""Writes the JSON of `trainctl reproduce --json` (stdin) as Markdown tables."""

import json
import sys


def percent(value):
    return "-" if value is None else f"{value:.2f}"


def interval(bounds):
    return "-" if bounds is None else f"{bounds[0]:.2f} to {bounds[1]:.2f}"


def denominator(row):
    trials, never = row["trials"], row["undetectable"]
    return (
        f"Accuracies here are of {trials - never:,} felt contacts; "
        f"{never:,} of {trials:,} were never felt."
    )


def main():
    rows = json.load(sys.stdin)["rows"]
    for experiment in ("simulation", "cody"):
        own = [row for row in rows if row["experiment"] == experiment]
        print(f"\n## {experiment.capitalize()}\n")
        print(denominator(own[0]))
        print("\n| algorithm | features | here, % | 95 % interval | paper, % | difference |")
        print("|---|---|---|---|---|---|")
        for row in own:
            print(
                f"| {row['algorithm']} | {row['features']} "
                f"| {percent(row['ours'])} | {interval(row['ours_interval'])} "
                f"| {percent(row['paper'])} "
                f"| {percent(row['difference'])} |"
            )
        print(f"\n![Accuracy](paper-tables/{experiment}-accuracy.png)\n")
        for algorithm in ("hmm", "lstm", "1nn"):
            figure = f"paper-tables/{experiment}-confusion-{algorithm}-f-m-a.png"
            print(f"![{algorithm}, all features]({figure})")


main()
