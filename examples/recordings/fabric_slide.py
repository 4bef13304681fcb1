#!/usr/bin/python3
"""Makes a folder that `trainctl import` reads from the fabric slides of FabricSlide.

    /usr/bin/python3 fabric_slide.py SOURCE FOLDER

SOURCE is data/fabric of the public repository wngfra/FabricSlide (MIT), with
files like Linen_F120_V-100mmps_0.csv. FOLDER gets skin.json, trials.csv and
frames/NNNN.npy. The label is the fabric, the condition the force: F120, F150
and so on.

A row has a time in ms, two proximities, which are left out, and 16 taxels.
The times are 28.08 ms apart on average: 35.6 Hz. In four files the last row is
written twice, and one of the two is dropped.

Traps:

- Fabric and session are confounded: by their times, each fabric was recorded in
  one stretch, one fabric after another.
- Not all fabrics have all settings. Denim and DenimFlex slide in one direction
  only and have no F250. WovenFabric has three of the five forces.
- A slide lasts from 4 to 59 s: the faster, the shorter. Contact begins before
  the recording, and no frame is untouched.
- The taxels are not put where they are on the finger: 4 x 4 is a guess.
"""

import json
import pathlib
import re
import sys

import numpy

LEAST_FRAMES = 10
BEFORE_TAXELS = 3  # Columns: time, two proximities.

SKIN = {
    "name": "fabric-slide-4x4",
    "rows": 4,
    "columns": 4,
    "row_pitch_m": 0.004,  # Nominal: the recordings do not state them.
    "column_pitch_m": 0.004,
    "unit": "counts",
    "contact_threshold": 1,
    "sample_rate_hz": 35.6,
}


def frames_of(path):
    rows = numpy.loadtxt(path, delimiter=",", skiprows=1, ndmin=2)
    repeated = numpy.diff(rows[:, 0], prepend=-1) == 0
    return rows[~repeated, BEFORE_TAXELS:].astype("<f4")


def main(source, folder):
    source, folder = pathlib.Path(source), pathlib.Path(folder)
    (folder / "frames").mkdir(parents=True, exist_ok=True)
    (folder / "skin.json").write_text(json.dumps(SKIN, indent=2) + "\n")
    trials = skipped = 0
    with open(folder / "trials.csv", "w") as table:
        table.write("frames,label,condition\n")
        for path in sorted(source.glob("*.csv")):
            fabric, force = re.match(r"([A-Za-z]+)_(F\d+)_", path.name).groups()
            frames = frames_of(path)
            if len(frames) < LEAST_FRAMES:
                skipped += 1
                continue
            name = f"frames/{trials:04}.npy"
            numpy.save(folder / name, frames)
            table.write(f"{name},{fabric},{force}\n")
            trials += 1
    print(f"{trials} trials, {skipped} files of fewer than {LEAST_FRAMES} frames skipped")


if __name__ == "__main__":
    main(*sys.argv[1:])
