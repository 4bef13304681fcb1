#!/usr/bin/python3
"""Makes a folder that `trainctl import` reads from the recordings icub_slide20.

    /usr/bin/python3 icub_slide20.py SOURCE FOLDER

SOURCE holds index.csv and trials/NNNN.npy. FOLDER gets skin.json, trials.csv
and frames/NNNN.npy.

The recordings need one repair. Each file is frames x 60, but its triangles of
10 taxels are in a wrong order: frames x triangles was taken for triangles x
frames. Put right, a taxel changes by 0.19 from a frame to the next on average,
and by 7.1 as the files have them.
"""

import csv
import json
import pathlib
import sys

import numpy

SKIN = {
    "name": "icub-6x10",  # A preset: shape, unit and thresholds are known.
    "sample_rate_hz": 50,  # Assumed: the recordings do not state it.
    "fields": {
        "id": "00{trial}",
        "frames": "frames/{trial}.npy",
        "object": "{label}",
        "material": "{label}",
    },
}


def in_order_of_time(stored):
    frames = len(stored)
    return stored.reshape(frames, 6, 10).transpose(1, 0, 2).reshape(frames, 60)


def main(source, folder):
    source, folder = pathlib.Path(source), pathlib.Path(folder)
    (folder / "frames").mkdir(parents=True, exist_ok=True)
    (folder / "skin.json").write_text(json.dumps(SKIN, indent=2) + "\n")
    with open(source / "index.csv") as index, open(
        folder / "trials.csv", "w"
    ) as table:
        table.write("trial,label,condition\n")
        for row in csv.DictReader(index):
            name = f"{row['trial']}.npy"
            frames = numpy.load(source / "trials" / name)
            numpy.save(folder / "frames" / name, in_order_of_time(frames))
            table.write(
                f"{row['trial']},{row['material_by_index']},{row['part']}\n"
            )


if __name__ == "__main__":
    main(*sys.argv[1:])
