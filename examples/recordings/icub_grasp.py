#!/usr/bin/python3
"""Makes a folder that `trainctl import` reads from the iCub Grasp Dataset.

    /usr/bin/python3 icub_grasp.py SOURCE FOLDER

SOURCE is iCubGraspDataset of the public repository clear-nus/icub_grasp_dataset
(copyright 2012 Harold Soh; free to use and distribute with that notice), with
files like book_7.txt. FOLDER gets skin.json, trials.csv and frames/NNNN.npy.
The label is the object, or none.

After a first line to ignore, a frame has 7 lines: 9 encoders, the largest
reading of each finger, and the 12 taxels of each of 5 fingers. The last 5 are
read. Pressing lowers a taxel from 255, so a value is 255 - taxel.

Left out are full_coke, which the README calls unreliable, and files with a
number above 20: it says that each object was grasped 20 times.

Traps:

- The sample rate is not stated. 50 Hz is assumed, the rate of the skin's ports.
  A grasp has 4 to 22 frames, so times in seconds mean little.
- Sessions are not stated either. The group is a run of five grasps of an object
  in a row: s0 is 1 to 5, s3 is 16 to 20. It is no day and no new mounting.
- Each object seems to have been grasped 20 times in a row. Readings of the
  open hand drift from grasp to grasp and differ from object to object, so the
  first frame gives away part of the answer.
- "none" is shorter (4 to 7 frames) than any grasp (7 to 22).
- Untouched taxels read about 11 counts. That is above the threshold, so every
  frame counts as touched.
"""

import json
import pathlib
import re
import sys

import numpy

FINGERS, TAXELS = 5, 12
LINES, BEFORE_TAXELS = 7, 2  # Of a frame: all, and those before the taxels.
GRASPS, GRASPS_OF_A_RUN = 20, 5
UNRELIABLE = "full_coke"

SKIN = {
    "name": "icub-fingers-5x12",
    "rows": FINGERS,
    "columns": TAXELS,
    "row_pitch_m": 0.004,  # Nominal: the recordings do not state them.
    "column_pitch_m": 0.004,
    "unit": "counts",
    "baseline": 255,
    "pressing": "lowers",
    "contact_threshold": 1,
    "sample_rate_hz": 50,  # Assumed: the recordings do not state it.
}


def frames_of(path):
    lines = path.read_text().splitlines()[1:]
    frames = []
    for first in range(0, len(lines) - LINES + 1, LINES):
        taxels = " ".join(lines[first + BEFORE_TAXELS : first + LINES])
        frames.append([float(word) for word in taxels.split()])
    return numpy.array(frames, "<f4").reshape(-1, FINGERS * TAXELS)


def grasps(source):
    """(object, number, path) of each file to convert, in order."""
    for path in source.glob("*.txt"):
        thing, number = re.fullmatch(r"(\w+)_(\d+)", path.stem).groups()
        if thing != UNRELIABLE and int(number) <= GRASPS:
            yield thing, int(number), path


def main(source, folder):
    source, folder = pathlib.Path(source), pathlib.Path(folder)
    (folder / "frames").mkdir(parents=True, exist_ok=True)
    (folder / "skin.json").write_text(json.dumps(SKIN, indent=2) + "\n")
    with open(folder / "trials.csv", "w") as table:
        table.write("frames,label,group\n")
        for trial, (thing, number, path) in enumerate(sorted(grasps(source))):
            name = f"frames/{trial:04}.npy"
            numpy.save(folder / name, frames_of(path))
            table.write(f"{name},{thing},s{(number - 1) // GRASPS_OF_A_RUN}\n")


if __name__ == "__main__":
    main(*sys.argv[1:])
