#!/usr/bin/python3
"""Makes a folder that `trainctl import` reads from the slip recordings of eFlesh.

    /usr/bin/python3 eflesh.py SOURCE FOLDER [SECONDS]

SECONDS cuts the recordings off, which last 3 s. SOURCE is slip_detection/data of the public repository notvenky/eFlesh: labels,
and seq_0.pt, seq_1.pt and so on. FOLDER gets skin.json, trials.csv and
frames/NNN.npy.

Each .pt file is a zip archive whose member data/0 holds 300 frames of 30
float32 at 100 Hz: two pads of five magnetometers of three axes. No pickle is
read. Labels come in blocks, so what changed between sessions is confounded with
the class. The column `condition` has two parts: each has one of the two blocks
of ones, and one half of the zeros.
"""

import json
import pathlib
import sys
import zipfile

import numpy

FRAMES, PADS, MAGNETOMETERS, AXES = 300, 2, 5, 3

SKIN = {
    "name": "eflesh-2x5",
    "rows": PADS,
    "columns": MAGNETOMETERS,
    "row_pitch_m": 0.02,  # Nominal: the recordings do not state them.
    "column_pitch_m": 0.007,
    "unit": "counts",
    # The load is the distance from the mean of the first half second, which
    # every frame has some of: a contact begins with the recording.
    "axes": AXES,
    "signed_values": True,
    "baseline": "from idle frames",
    "idle_frames": 50,
    "contact_threshold": 1e-3,
    "sample_rate_hz": 100,
}


def frames_of(path):
    with zipfile.ZipFile(path) as archive:
        (name,) = (n for n in archive.namelist() if n.endswith("/data/0"))
        values = numpy.frombuffer(archive.read(name), "<f4")
    return values.reshape(FRAMES, PADS, MAGNETOMETERS, AXES)


def conditions_of(labels):
    """Each block of ones is a part; the zeros are divided between the parts."""
    zeros = [i for i, label in enumerate(labels) if label == 0]
    conditions = []
    for i, label in enumerate(labels):
        late = i > zeros[-1] if label else i >= zeros[len(zeros) // 2]
        conditions.append("second" if late else "first")
    return conditions


def main(source, folder, seconds=3):
    source, folder = pathlib.Path(source), pathlib.Path(folder)
    (folder / "frames").mkdir(parents=True, exist_ok=True)
    (folder / "skin.json").write_text(json.dumps(SKIN, indent=2) + "\n")
    labels = [int(word) for word in (source / "labels").read_text().split()]
    conditions = conditions_of(labels)
    with open(folder / "trials.csv", "w") as table:
        table.write("frames,label,condition\n")
        for i, label in enumerate(labels):
            name = f"frames/{i:03}.npy"
            frames = frames_of(source / f"seq_{i}.pt")
            numpy.save(folder / name, frames[: round(100 * float(seconds))])
            table.write(f"{name},{'one' if label else 'zero'},{conditions[i]}\n")


if __name__ == "__main__":
    main(*sys.argv[1:])
