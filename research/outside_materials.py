"""Draws materials inside and outside of the range that the random world draws from.

    outside_materials.py FOLDER

Writes a table for `trainctl simulate --materials` for each group: inside.csv within
the range (core/sim/experiments/random_world.h), and others of which one property is
outside of it.
"""

import math
import pathlib
import random
import sys

SEED = 1
INSIDE, OUTSIDE = 60, 30
COLUMNS = [
    "name",
    "youngs_modulus_pa",
    "density_kg_m3",
    "wood_static",
    "wood_kinetic",
    "glass_static",
    "glass_kinetic",
    "poisson_ratio",
]
# What the materials of a group have instead of a drawn value.
GRIP = {"wood_static": 2, "wood_kinetic": 1.6, "glass_static": 3, "glass_kinetic": 2.5}
GROUPS = {
    "inside": {},
    "softer-3x": {"youngs_modulus_pa": 700},
    "softer-10x": {"youngs_modulus_pa": 200},
    "softer-30x": {"youngs_modulus_pa": 70},
    "lighter-10x": {"density_kg_m3": 3},
    "heavier-10x": {"density_kg_m3": 80000},
    "grippy": GRIP,
    "harder-16x": {"youngs_modulus_pa": 1e12},
}


def log_uniform(dice, low, high):
    return math.exp(dice.uniform(math.log(low), math.log(high)))


def draw(dice):
    """A material within the range."""
    material = {
        "youngs_modulus_pa": log_uniform(dice, 2e3, 6e10),
        "density_kg_m3": log_uniform(dice, 30, 8000),
        "poisson_ratio": dice.uniform(0.2, 0.49),
    }
    for ground in ("wood", "glass"):
        static = dice.uniform(0.12, 0.95)
        material[f"{ground}_static"] = static
        material[f"{ground}_kinetic"] = static * dice.uniform(0.6, 0.95)
    return material


def main(folder):
    dice = random.Random(SEED)
    for group, changed in GROUPS.items():
        lines = [",".join(COLUMNS)]
        for n in range(OUTSIDE if changed else INSIDE):
            material = {"name": f"{group}/{n}"} | draw(dice) | changed
            lines.append(",".join(str(material[column]) for column in COLUMNS))
        path = pathlib.Path(folder, f"{group}.csv")
        path.write_text("\n".join(lines) + "\n", encoding="utf-8")


if __name__ == "__main__":
    main(*sys.argv[1:])
