"""Writes docs/performance.md to stdout; docs/make-performance.sh calls it.

Arguments: a file that names the machine, the JSON of `tactus-bench all --json`,
the CSV of `tactus-bench frontier --table`; --quick if they are of quick runs.
"""

import csv
import json
import pathlib
import sys

sys.path.insert(
    0, str(pathlib.Path(__file__).resolve().parent.parent / "research"))
from intervals import wilson

COMPARISONS = {
    "classifier": (
        "Classifiers",
        "Models fitted to the paper's 1,835 trials as ideal signals (seed 1), tested on "
        "contacts at robot conditions that were not trained at (seed 7). Time is processor "
        "time of the whole classifier on a contact frame, mean over the first 1.2 s of 48 "
        "contacts, median of 15 rounds in which the variants take turns. Models step at "
        "intervals of a tenth of the time since onset, but at least 5 and at most 20 frames; "
        "\"at 10-40\": at least 10 and at most 40. HMMs are counted per class, of four; "
        "\"tuned\" is the preset for one's own trials: 20 HMMs, one network and a network that "
        "estimates the object; \"nothing skipped\" is the same with all skip rules off, of "
        "which two apply here ([skipping.md](skipping.md)): unused cues and unchanged scores. "
        "What the built-in model costs is in [results/served.md](../research/results/served.md).",
        "wrong after 1.2 s, %",
    ),
    "precision": (
        "Precision of the HMM scores",
        "The forward algorithm of all HMMs of the model \"tuned\" on what they see of some "
        "of the contacts up to 1.2 s, scores read after each step. Time is processor time of a step; "
        "error is the largest of a class's log-likelihood, nats per step, against "
        "logarithms in long double. \"pruned\": in double, state by state, and without the "
        "states that hold no more than the bound of their class's forward mass; this "
        "is measured here and not served ([skipping.md](skipping.md)).",
        "error, nats",
    ),
    "simulator": (
        "Methods of the simulator",
        "Scenes of the grid of robot conditions, every other one with the object fixed, "
        "without those of more than 20,000 events. Time is processor time per frame of the "
        "100 Hz signals, median of 3 rounds; error is the largest of a noiseless feature as "
        "a fraction of its peak, against long double matrix exponentials. The model "
        "\"tuned\" classifies the contacts of each method.",
        "error / peak",
    ),
}


def number(value):
    if value is None or value == "":
        return "-"
    value = float(value)
    if value == 0:
        return "0"
    if abs(value) < 1e-3:
        return f"{value:.1e}"
    return f"{value:.0f}" if abs(value) >= 1000 else f"{value:.3g}"


def percent(share, contacts):
    return "-" if share == "" else wilson(float(share) * contacts, contacts)


def print_rows(rows):
    print("| name | unit | here | peer | ratio | peer's name | error |")
    print("|---|---|---|---|---|---|---|")
    for row in rows:
        peer = row["peer_name"] or ""
        if peer and row["peer"] is None:
            peer += " (not installed)"
        error = ""
        if row["error"] is not None:
            error = f"{number(row['error'])} to {row['error_reference']}"
        ratio = "-" if row["ratio"] is None else f"{row['ratio']:.2f}"
        print(
            f"| {row['name']} | {row['unit']} | {number(row['ours'])} "
            f"| {number(row['peer'])} | {ratio} | {peer} | {error} |"
        )


def print_comparison(comparison, points):
    title, text, wrong = COMPARISONS[comparison]
    points = [point for point in points if point["comparison"] == comparison]
    contacts = int(points[0]["contacts"])
    print(f"\n### {title}\n\n{text}")
    print(f"\nRight answers are of {contacts:,} contacts; in brackets are 95 % intervals.\n")
    print(f"![{title}](performance/frontier-{comparison}.png)\n")
    print(f"| variant | ns | {wrong} | right after 1.2 s, % | right at the end, % | front |")
    print("|---|---|---|---|---|---|")
    for point in points:
        error = (
            number(point["error"])
            if point["error"]
            else f"{100 - 100 * float(point['accuracy']):.2f}"
        )
        front = "yes" if point["front"] == "yes" else ""
        print(
            f"| {point['family']}: {point['variant']} | {number(point['ns_per_frame'])} "
            f"| {error} | {percent(point['accuracy'], contacts)} "
            f"| {percent(point['final_accuracy'], contacts)} | {front} |"
        )


def main():
    machine_file, rows_file, points_file = sys.argv[1:4]
    with open(machine_file, encoding="utf-8") as file:
        cpu, cores, system, compiler, version = file.read().splitlines()
    with open(rows_file, encoding="utf-8") as file:
        rows = json.load(file)
    with open(points_file, encoding="utf-8", newline="") as file:
        points = list(csv.DictReader(file))
    print("# Performance\n")
    print(
        "Written by `docs/make-performance.sh`; another machine gives other times, and "
        "ratios that resemble these. [training-speed.md](../research/training-speed.md) is about "
        "whole trainings.\n"
    )
    if "--quick" in sys.argv:
        print("**Of quick runs: only shows that the page can be written.**\n")
    print("| | |\n|---|---|")
    print(f"| processor | {cpu}, {cores} cores |")
    print(f"| system | {system} |")
    print(f"| compiler | {compiler} |")
    print(f"| program | {version} |")
    print("\n## Beside peers\n\n`tactus-bench all --except=frontier,served,fit-scale`\n")
    print(
        "Ours and the peer take turns in one run; medians count. The ratio says how many "
        "times better ours is. An error is the largest difference from the reference.\n"
    )
    print_rows(rows)
    print("\n## Run time against error\n\n`tactus-bench frontier`\n")
    print(
        "Points on the front are those that no other point of their table beats on both "
        "time and error; rings mark them in the pictures."
    )
    for comparison in COMPARISONS:
        print_comparison(comparison, points)


main()
