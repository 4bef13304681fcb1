#!/usr/bin/python3
"""Makes a folder that `trainctl import` reads from the slips of BioTacSP-DoS.

    /usr/bin/python3 biotac_slip.py SOURCE FOLDER

SOURCE is csvs of the public repository yayaneath/BioTacSP-DoS (no licence is
stated), with files like aw/bottle0.csv. FOLDER gets skin.json, trials.csv and
frames/NNNN.npy. The label is the folder: a slip to the north, east, south or
west, clockwise (cw) or anti-clockwise (aw), or a stable touch (t). The group is
the object.

A row has the 24 electrodes of one BioTac SP. Its README gives the rate as up to
100 Hz, and 3 s as the length of a recording, which has 271 to 282 rows.

Traps:

- "strippes" in one file name is a misspelling of the object "striped".
- The README says four recordings of each object and class, which makes 308.
  There are 306, and in four cells there are three or five.
- Electrodes read from 1900 to 3750 counts at all times. So no frame is
  untouched, and contact begins with the recording.
- The electrodes are not put where they are on the finger: 4 x 6 is a guess.
"""

import json
import pathlib
import re
import sys

import numpy

MISSPELT = {"strippes": "striped"}

SKIN = {
    "name": "biotac-sp-4x6",
    "rows": 4,
    "columns": 6,
    "row_pitch_m": 0.004,  # Nominal: the recordings do not state them.
    "column_pitch_m": 0.004,
    "unit": "counts",
    "contact_threshold": 1,
    "sample_rate_hz": 100,
}


def main(source, folder):
    source, folder = pathlib.Path(source), pathlib.Path(folder)
    (folder / "frames").mkdir(parents=True, exist_ok=True)
    (folder / "skin.json").write_text(json.dumps(SKIN, indent=2) + "\n")
    with open(folder / "trials.csv", "w") as table:
        table.write("frames,label,group\n")
        for trial, path in enumerate(sorted(source.glob("*/*.csv"))):
            name = f"frames/{trial:04}.npy"
            rows = numpy.loadtxt(path, delimiter=",", skiprows=1, ndmin=2)
            numpy.save(folder / name, rows.astype("<f4"))
            thing = re.match("[a-z]+", path.name).group()
            table.write(f"{name},{path.parent.name},{MISSPELT.get(thing, thing)}\n")


if __name__ == "__main__":
    main(*sys.argv[1:])
