#!/usr/bin/python3
"""Makes what `trainctl import` needs to read the recordings vitac384.

    /usr/bin/python3 vitac384.py SOURCE FOLDER
    trainctl import SOURCE --skin=FOLDER/skin.json --out=vitac384.h5

SOURCE holds index.csv, trials/NNNN.npy and trials/NNNN_time.npy. FOLDER gets
skin.json and the table trials.csv; the frames are read where they are.
"""

import csv
import json
import pathlib
import sys

SKIN = {
    "name": "vitac-12x32",  # A preset: shape, unit and thresholds are known.
    # Rows are logged at 100 Hz; the skin delivers about 30 new ones a second.
    "sample_rate_hz": 100,
    "scale": 0.5,  # The files hold twice the counts.
    "fields": {
        "id": "00{trial}",
        "frames": "trials/{trial}.npy",
        "time": "trials/{trial}_time.npy",
    },
}


def main(source, folder):
    source, folder = pathlib.Path(source), pathlib.Path(folder)
    folder.mkdir(parents=True, exist_ok=True)
    (folder / "skin.json").write_text(json.dumps(SKIN, indent=2) + "\n")
    with open(source / "index.csv") as index, open(
        folder / "trials.csv", "w"
    ) as table:
        table.write("trial,label,condition,object,material\n")
        for row in csv.DictReader(index):
            label = row["hardness"][0].upper() + row["motion"][0].upper()
            # "session_2026-02-16_14-11-55" was recorded on 2026-02-16, and
            # "ramp_rubber" is of rubber.
            day = row["session"].split("_")[1]
            material = row["object"].split("_")[-1]
            table.write(
                f"{row['trial']},{label},{day},{row['object']},{material}\n"
            )


if __name__ == "__main__":
    main(*sys.argv[1:])
