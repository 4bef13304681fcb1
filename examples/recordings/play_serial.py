#!/usr/bin/python3
"""Plays the recordings vitac384 as a skin on a serial line, for a rehearsal.

    /usr/bin/python3 play_serial.py SOURCE LINK

SOURCE holds index.csv and trials/NNNN.npy. LINK becomes a link to a
pseudo-terminal, which sends 30 frames a second as lines of numbers. The skin
has what real ones have: offsets, noise, a dead taxel (200) and a stuck one
(100). Nothing touches it until a line comes on standard input. Then the
contacts follow each other, 2 s apart, and what comes next is printed. After
them, the skin is idle until standard input ends.
"""

import csv
import os
import pathlib
import select
import sys
import time
import tty

import numpy

RATE_HZ = 30
PAUSE_S = 2
DEAD, STUCK = 200, 100


class Skin:
    """The pseudo-terminal; frames leave at the rate of the skin."""

    def __init__(self, link):
        self.master, self.slave = os.openpty()
        tty.setraw(self.slave)
        os.set_blocking(self.master, False)
        link.unlink(missing_ok=True)
        link.symlink_to(os.ttyname(self.slave))
        self.random = numpy.random.default_rng(1)
        self.offset = 12 + numpy.arange(384) % 5
        self.due = time.monotonic()

    def send(self, load):
        frame = self.offset + load + self.random.integers(-2, 3, 384)
        frame[DEAD] = self.offset[DEAD]
        frame[STUCK] = 240
        rows = numpy.clip(frame, 0, 255).reshape(12, 32)
        text = "".join(" ".join(map(str, row)) + "\n" for row in rows)
        self.due += 1 / RATE_HZ
        time.sleep(max(0, self.due - time.monotonic()))
        try:
            os.write(self.master, text.encode() + b"\n")
        except BlockingIOError:
            pass  # Nobody listens.

    def rest(self, seconds):
        for _ in range(round(seconds * RATE_HZ)):
            self.send(0)


def line_came():
    return bool(select.select([sys.stdin], [], [], 0)[0])


def main(source, link):
    source = pathlib.Path(source)
    skin = Skin(pathlib.Path(link))
    print("idle; press Enter to play the contacts", flush=True)
    while not line_came():
        skin.rest(0.1)
    sys.stdin.readline()
    with open(source / "index.csv") as index:
        for row in csv.DictReader(index):
            label = row["hardness"][0].upper() + row["motion"][0].upper()
            print("next:", label, flush=True)
            skin.rest(PAUSE_S)
            frames = numpy.load(source / "trials" / (row["trial"] + ".npy"))
            # Logged at 100 Hz, with twice the counts.
            last = int((len(frames) - 1) * RATE_HZ / 100)
            for t in range(last):
                skin.send(frames[round(t * 100 / RATE_HZ)] // 2)
    print("the end", flush=True)
    while not line_came() or sys.stdin.readline():
        skin.rest(0.1)


if __name__ == "__main__":
    main(*sys.argv[1:])
