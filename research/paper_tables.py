"""Writes the tables of several `trainctl reproduce --json` as Markdown.

Usage: paper_tables.py FILE.json...

Runs that differ only in their seeds share a column: the mean of their
accuracies, then the least and the largest.
"""

import json
import sys


def column(runs, experiment, key):
    """The results of a row in the given runs."""
    values = [
        row["ours"]
        for run in runs
        for row in run["rows"]
        if row["experiment"] == experiment
        and (row["algorithm"], row["features"]) == key
    ]
    if not values:
        return "-", "-", None
    mean = sum(values) / len(values)
    return f"{mean:.2f}", f"{min(values):.2f} to {max(values):.2f}", mean


def denominator(runs, experiment):
    row = next(r for r in runs[0]["rows"] if r["experiment"] == experiment)
    trials, never = row["trials"], row["undetectable"]
    return (
        "Accuracies are means of the seeds. Each seed's is of "
        f"{trials - never:,} felt contacts; {never:,} of {trials:,} were never felt."
    )


def table(runs, experiment, noises):
    """One table; a pair of columns for each reading of the noise."""
    print(f"\n{denominator(runs, experiment)}\n")
    heads = ["algorithm", "features"]
    for noise in noises:
        heads += [f"here{noise and ', ' + noise + ' noise'}, %", "least to largest"]
    heads += ["paper, %", "difference"]
    print("| " + " | ".join(heads) + " |")
    print("|---" * len(heads) + "|")
    for row in (r for r in runs[0]["rows"] if r["experiment"] == experiment):
        key = row["algorithm"], row["features"]
        cells = list(key)
        first = None
        for noise in noises:
            chosen = [run for run in runs if noise in ("", run["noise"])]
            mean, span, value = column(chosen, experiment, key)
            cells += [mean, span]
            first = value if first is None else first
        cells += [f"{row['paper']:.2f}", f"{first - row['paper']:.2f}"]
        print("| " + " | ".join(cells) + " |")


def figures(experiment):
    print(f"\nSeed 1:\n\n![Accuracy](paper-tables/{experiment}-accuracy.png)\n")
    for algorithm in ("hmm", "lstm", "1nn"):
        figure = f"paper-tables/{experiment}-confusion-{algorithm}-f-m-a.png"
        print(f"![{algorithm}, all features]({figure})")


def main():
    runs = [json.load(open(path)) for path in sys.argv[1:]]
    print("\n## Simulation")
    table(runs, "simulation", ["relative", "absolute"])
    figures("simulation")
    print("\n## Cody")
    with_cody = [
        run
        for run in runs
        if any(row["experiment"] == "cody" for row in run["rows"])
    ]
    table(with_cody, "cody", [""])
    figures("cody")


main()
