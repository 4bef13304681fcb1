"""Writes the frames of a trial file for c_answers, which reads no HDF5.

    frames_of_trials.py TRIALS.h5 FRAMES

Each trial: the number of its frames (int32), and of each frame the time in
nanoseconds (int64), the pose (7 float64) and the taxels (384 float32).
"""
import sys

import h5py
import numpy as np

with h5py.File(sys.argv[1]) as source, open(sys.argv[2], "wb") as out:
    for name in sorted(source["trials"]):
        trial = source["trials"][name]
        frames = np.zeros(
            len(trial["time"]),
            [("ns", "<i8"), ("pose", "<f8", 7), ("taxels", "<f4", 384)])
        frames["ns"] = np.round(trial["time"][()] * 1e9)
        frames["pose"] = trial["pose"]
        frames["taxels"] = trial["taxels"][()].reshape(len(frames), 384)
        out.write(np.int32(len(frames)).tobytes())
        out.write(frames.tobytes())
