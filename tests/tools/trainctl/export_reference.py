"""Trials that NumPy writes, through trainctl, and read by NumPy again.

NumPy's own .npz files are imported and exported as .npz and as Zarr. What is
read of both, by numpy.load and by the Zarr specification, must be what NumPy
wrote.

  export_reference.py build/release/bin/trainctl
"""

import json
import os
import subprocess
import sys
import tempfile
import zlib

import numpy as np

FRAMES = 3000  # several chunks of taxels


def trial(seed, taxel_type):
    print("seed", seed)
    random = np.random.default_rng(seed)
    taxels = random.integers(0, 30000, (FRAMES, 16, 24)).astype(taxel_type)
    poses = np.zeros((FRAMES, 7))
    poses[:, :3] = random.normal(size=(FRAMES, 3))
    poses[:, 6] = 1
    return {
        "time": np.arange(FRAMES) / 100,
        "signals": random.normal(size=(FRAMES, 3)),
        "taxels": taxels,
        "pose": poses,
        "label": "HU",
        "condition": "grün \"k543\"",
        "source": f"press {seed}",
        "layout": "cody-forearm",
        "stiffness": 1 / 3 + seed,
        "taxel_scale": 1.0 if taxel_type == "f4" else 0.01,
    }


def zarr_array(folder):
    with open(os.path.join(folder, ".zarray")) as file:
        about = json.load(file)
    assert about["zarr_format"] == 2 and about["order"] == "C"
    assert about["filters"] is None and about["compressor"]["id"] == "zlib"
    shape, chunks = about["shape"], about["chunks"]
    out = np.full(shape, 99, about["dtype"])
    counts = [-(-size // chunk) for size, chunk in zip(shape, chunks)]
    for place in np.ndindex(*counts):
        path = os.path.join(folder, ".".join(map(str, place)))
        with open(path, "rb") as file:
            chunk = np.frombuffer(zlib.decompress(file.read()), about["dtype"])
        where = tuple(slice(p * c, (p + 1) * c) for p, c in zip(place, chunks))
        part = out[where]
        part[...] = chunk.reshape(chunks)[tuple(map(slice, part.shape))]
    return out


def zarr_group(folder):
    with open(os.path.join(folder, ".zgroup")) as file:
        assert json.load(file) == {"zarr_format": 2}
    with open(os.path.join(folder, ".zattrs")) as file:
        values = json.load(file)
    for name in os.listdir(folder):
        if not name.startswith("."):
            values[name] = zarr_array(os.path.join(folder, name))
    return values


def with_package(folder):
    """The same by the package zarr, if it is there."""
    try:
        import zarr
    except ImportError:
        return None
    group = zarr.open_group(folder, mode="r")
    return dict(group.attrs) | {name: a[...] for name, a in group.arrays()}


def check(want, got, where):
    for name, value in want.items():
        have = np.asarray(got[name])
        value = np.asarray(value)
        assert have.shape == value.shape, (where, name, have.shape)
        assert value.dtype.kind == "U" or have.dtype == value.dtype, name
        assert np.array_equal(have, value), (where, name)


def main():
    trainctl = sys.argv[1]

    def run(*arguments):
        subprocess.run([trainctl, *arguments], check=True,
                       stdout=subprocess.DEVNULL)

    with tempfile.TemporaryDirectory() as folder:
        trials = {"000000": trial(1, "u2"), "seven": trial(2, "f4")}
        start = os.path.join(folder, "start")
        os.mkdir(start)
        for name, arrays in trials.items():
            np.savez_compressed(os.path.join(start, name), **arrays)
        data = os.path.join(folder, "data.h5")
        run("import", start, "--out=" + data)
        back = os.path.join(folder, "back.h5")
        for form in ("npz", "zarr"):
            out = os.path.join(folder, form)
            run("trials", "export", data, "--format=" + form, "--out=" + out)
            if form == "zarr":
                run("import", out, "--out=" + back)
        again = os.path.join(folder, "again")
        run("trials", "export", back, "--format=npz", "--out=" + again)
        readers = 0
        for name, want in trials.items():
            for npz in ("npz", "again"):
                path = os.path.join(folder, npz, name + ".npz")
                check(want, np.load(path, allow_pickle=False), path)
            path = os.path.join(folder, "zarr", name)
            for got in (zarr_group(path), with_package(path)):
                if got is None:
                    continue
                check(want, got, path)
                readers += 1
        print(readers, "readings of Zarr")


if __name__ == "__main__":
    main()
