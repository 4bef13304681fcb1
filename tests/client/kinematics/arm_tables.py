#!/usr/bin/env python3
"""Writes tests/golden/kinematics/*.csv: poses of two arms, for arm_model_test.

    /usr/bin/python3 tests/client/kinematics/arm_tables.py

Independent of urdfdom and KDL, with numpy alone. The Panda's poses come from
the Denavit-Hartenberg table in its maker's documentation (Craig's convention)
and not from panda.urdf. Those of odd_arm.urdf are products of 4 x 4 matrices
written out by hand from the numbers in that file. Rows: joint values, x y z in
metres, and the rotation matrix row by row.
"""
import os

import numpy as np

FOLDER = os.path.join(os.path.dirname(__file__), "../../golden/kinematics")
ROWS = 40


def rot_x(a):
    c, s = np.cos(a), np.sin(a)
    return np.array([[1, 0, 0, 0], [0, c, -s, 0], [0, s, c, 0], [0, 0, 0, 1]])


def rot_y(a):
    c, s = np.cos(a), np.sin(a)
    return np.array([[c, 0, s, 0], [0, 1, 0, 0], [-s, 0, c, 0], [0, 0, 0, 1]])


def rot_z(a):
    c, s = np.cos(a), np.sin(a)
    return np.array([[c, -s, 0, 0], [s, c, 0, 0], [0, 0, 1, 0], [0, 0, 0, 1]])


def move(x, y, z):
    m = np.eye(4)
    m[:3, 3] = [x, y, z]
    return m


def turn(axis, angle):
    """Rotation about any axis: the matrix exponential, by its series."""
    x, y, z = np.array(axis, float) / np.linalg.norm(axis)
    k = angle * np.array([[0, -z, y], [z, 0, -x], [-y, x, 0]])
    term = total = np.eye(3)
    for n in range(1, 60):
        term = term @ k / n
        total = total + term
    m = np.eye(4)
    m[:3, :3] = total
    return m


def rpy(r, p, y):
    """Roll, pitch and yaw about fixed axes."""
    return rot_z(y) @ rot_y(p) @ rot_x(r)


def panda(q):
    """a, d, alpha, theta: Craig's convention, then the flange."""
    h = np.pi / 2
    table = [(0, 0.333, 0), (0, 0, -h), (0, 0.316, h), (0.0825, 0, h),
             (-0.0825, 0.384, -h), (0, 0, h), (0.088, 0, h)]
    m = np.eye(4)
    for (a, d, alpha), theta in zip(table, q):
        m = m @ rot_x(alpha) @ move(a, 0, 0) @ rot_z(theta) @ move(0, 0, d)
    return m @ move(0, 0, 0.107)


def odd_arm(q):
    slide, angle, elbow, roll = q
    m = move(0.2, -0.4, 0.75) @ rpy(0.1, -0.2, 0.9)
    m = m @ move(0.05, 0, 0.1) @ rpy(0, 0.3, 0)
    m = m @ move(0.6 * slide, 0.8 * slide, 0)
    m = m @ move(0, 0.02, 0.3) @ rpy(-0.4, 0.2, 1.1) @ rot_z(angle)
    m = m @ move(0.31, 0.01, -0.02) @ rpy(1.2, 0.7, -0.5)
    m = m @ turn([1, -2, 0.5], elbow)
    m = m @ move(0.1, 0, 0.04) @ rpy(0, 0, 0.25) @ rot_y(0.2 - 0.5 * elbow)
    m = m @ move(0.15, 0, 0) @ rot_x(roll)
    return m @ move(-0.08, 0.005, 0) @ rpy(0, np.pi / 2, 0.3)


def write(name, lower, upper, pose):
    random = np.random.RandomState(14)
    with open(os.path.join(FOLDER, name), "w") as out:
        for row in range(ROWS):
            q = random.uniform(lower, upper)
            if row == 0:
                q = np.clip(np.zeros(len(lower)), lower, upper)
            m = pose(q)
            numbers = [*q, *m[:3, 3], *m[:3, :3].ravel()]
            out.write(",".join("%.17g" % n for n in numbers) + "\n")


write("panda.csv",
      [-2.8973, -1.7628, -2.8973, -3.0718, -2.8973, -0.0175, -2.8973],
      [2.8973, 1.7628, 2.8973, -0.0698, 2.8973, 3.7525, 2.8973], panda)
write("odd_arm.csv", [-0.5, -9, -2.5, -1.5], [1.5, 9, 2.5, 1.5], odd_arm)
