"""Draws touches of made-up people on a skin of 8 x 8 taxels.

    made_touches.py FOLDER

Writes what `trainctl import FOLDER` reads: six people, who press, move and cover the
skin each in a way of their own, make five kinds of touch seven times each.
"""

import json
import pathlib
import sys

import numpy

SEED = 5
SIDE, RATE_HZ, FRAMES = 8, 50, 100
PEOPLE, TIMES = 6, 7
KINDS = ["tap", "press", "rub", "stroke", "poke-twice"]
ROWS, COLUMNS = numpy.mgrid[0:SIDE, 0:SIDE]


def bump(t, begin, end):
    within = (t > begin) & (t < end)
    return within * numpy.sin(numpy.pi * numpy.clip((t - begin) / (end - begin), 0, 1))


def hold(t):
    return numpy.clip((t - 0.2) / 0.2, 0, 1) * numpy.clip((1.5 - t) / 0.2, 0, 1)


def load(kind, t):
    """How hard it is pressed over time, as a share of the person's force."""
    if kind == "tap":
        return bump(t, 0.2, 0.5)
    if kind == "poke-twice":
        return bump(t, 0.2, 0.5) + bump(t, 0.7, 1.0)
    return hold(t)


def travel(kind, t):
    """Where the touch is along the columns, in taxels."""
    if kind == "rub":
        return 1.5 * numpy.sin(8 * (t - 0.2))
    if kind == "stroke":
        return (numpy.clip(t - 0.2, 0, 1.3) - 0.65) * 3
    return 0 * t


def touch(kind, person, random):
    t = numpy.arange(FRAMES) / RATE_HZ * person["speed"] * random.uniform(0.85, 1.15)
    row = person["place"][0] + random.normal(0, 0.5)
    column = person["place"][1] + random.normal(0, 0.5) + travel(kind, t)
    force = person["force"] * random.uniform(0.7, 1.3)
    square = (ROWS - row) ** 2 + (COLUMNS - column[:, None, None]) ** 2
    frames = force * load(kind, t)[:, None, None] * numpy.exp(
        -square / (2 * person["size"] ** 2)
    )
    noisy = frames + random.normal(0, 1.5, frames.shape)
    counts = numpy.clip(numpy.round(noisy), 0, 1000)
    return counts.reshape(FRAMES, -1).astype("f4")


def main(folder):
    folder = pathlib.Path(folder)
    folder.mkdir(parents=True, exist_ok=True)
    random = numpy.random.default_rng(SEED)
    lines = ["frames,label,group"]
    for number in range(PEOPLE):
        person = {
            "force": random.uniform(60, 160),
            "speed": random.uniform(0.7, 1.5),
            "size": random.uniform(1.0, 1.8),
            "place": random.uniform(2.5, 4.5, 2),
        }
        for kind in KINDS:
            for _ in range(TIMES):
                name = f"{len(lines) - 1:04d}.npy"
                numpy.save(folder / name, touch(kind, person, random))
                lines.append(f"{name},{kind},person-{number}")
    (folder / "trials.csv").write_text("\n".join(lines) + "\n")
    skin = {
        "name": "pad",
        "rows": SIDE,
        "columns": SIDE,
        "row_pitch_m": 0.005,
        "column_pitch_m": 0.005,
        "taxel_area_m2": 2.5e-5,
        "unit": "counts",
        "contact_threshold": 8,
        "onset_threshold": 14,
        "sample_rate_hz": RATE_HZ,
    }
    (folder / "skin.json").write_text(json.dumps(skin, indent=1) + "\n")


main(sys.argv[1])
