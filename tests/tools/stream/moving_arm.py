#!/usr/bin/env python3
"""Plays a robot's arm whose hand carries a skin, for arm_stream_check.sh.

    moving_arm.py HOST:PORT [SECONDS]

Prints the terminal on which the skin sends frames of 16 x 24 counts, 100 times
a second, as lines of text, and sends the values of scara.urdf's joints to
HOST:PORT by UDP. Every 4 s the hand is somewhere else, and something presses
the skin at its seam, row 8, column 23.7. For each contact a line says where:
"touch x y z". That is computed here from sines and cosines.
"""
import math
import os
import pty
import socket
import sys
import time
import tty

ROWS, COLUMNS = 16, 24
# Of the layout cody-forearm, in metres.
ROW_PITCH, RADIUS = 0.0108, 0.04604
CYCLE_S, TOUCH_S = 4.0, 2.0
PLACES = [(0.50, 0.30), (0.35, 0.45), (0.60, -0.20), (0.20, 0.40)]


def hand(k, t):
    """Values of lift, shoulder, elbow and wrist: where the arm moves."""
    x, y = PLACES[k % len(PLACES)]
    before = PLACES[max(k - 1, 0) % len(PLACES)]
    part = min(t / 1.0, 1)
    part = part * part * (3 - 2 * part)
    x, y = (b + (a - b) * part for a, b in zip((x, y), before))
    press = 0.004 * min(max(t - (CYCLE_S - TOUCH_S), 0), 1)
    x += press
    elbow = math.acos((x * x + y * y) / (2 * 0.4 * 0.4) - 1)
    shoulder = math.atan2(y, x) - math.atan2(math.sin(elbow),
                                             1 + math.cos(elbow))
    return 0.1, shoulder, elbow, -shoulder - elbow


def place(values):
    """Where row 8, column 23.7 of the skin is, for these joint values."""
    lift, a, b, c = values
    x = 0.4 * math.cos(a) + 0.4 * math.cos(a + b)
    y = 0.4 * math.sin(a) + 0.4 * math.sin(a + b)
    turn = a + b + c
    around = 2 * math.pi * 23.7 / COLUMNS
    u, v = 0.05 + RADIUS * math.cos(around), RADIUS * math.sin(around)
    return (x + u * math.cos(turn) - v * math.sin(turn),
            y + u * math.sin(turn) + v * math.cos(turn),
            lift + 0.02 + 8 * ROW_PITCH)


def counts(force):
    rows = []
    for row in range(ROWS):
        line = []
        for column in range(COLUMNS):
            across = abs(column - 23.7)
            across = min(across, COLUMNS - across)
            far = (across ** 2 + (row - 8) ** 2) / (2 * 1.2 ** 2)
            line.append(str(int(force * math.exp(-far))))
        rows.append(" ".join(line))
    return ("\n".join(rows) + "\n\n").encode()


def main():
    host, port = sys.argv[1].rsplit(":", 1)
    seconds = float(sys.argv[2]) if len(sys.argv) > 2 else 16
    udp = socket.socket(socket.AF_INET, socket.SOCK_DGRAM)
    master, slave = pty.openpty()
    tty.setraw(slave)
    os.set_blocking(master, False)
    print(os.ttyname(slave), flush=True)
    frames = [counts(force) for force in range(256)]
    begin = time.monotonic()
    for frame in range(int(seconds * 100)):
        time.sleep(max(0, begin + frame / 100 - time.monotonic()))
        k, t = divmod(frame / 100, CYCLE_S)
        values = hand(int(k), t)
        line = "%d %.9f %.9f %.9f %.9f" % (time.monotonic_ns(), *values)
        udp.sendto(line.encode(), (host, int(port)))
        touch = t - (CYCLE_S - TOUCH_S)
        if abs(touch) < 1e-9:
            print("touch %.4f %.4f %.4f" % place(values), flush=True)
        # Released for the last half second.
        force = 200 * min(touch / 0.5, 1) if 0 <= touch < 1.2 else 0
        try:
            os.write(master, frames[int(force)])
        except BlockingIOError:
            pass  # Nobody reads yet.


main()
