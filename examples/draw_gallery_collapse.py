#!/usr/bin/env python3
# SPDX-License-Identifier: MIT
"""Draws the film of the gallery with a column of beads that collapses in a liquid, with Matplotlib.

    draw_gallery_collapse.py NAME FOLDER [--frames NUMBER]

Reads the output of the run of this item in FOLDER, and writes FOLDER/NAME.webp.
"""

import pathlib
import sys

sys.path.insert(0, str(pathlib.Path(__file__).resolve().parent))
from draw_gallery_grains import film
from support.films import draw_one_of
from support.grains_in_water import GrainsInWater


def submerged_collapse(folder, count):
    run = GrainsInWater(folder)
    length = run.options["tank"]
    walls = [(0, 0.1), (0, 0), (length, 0), (length, 0.1)]
    return film(run, count, (840, 330), (-0.004, length + 0.004), (-0.006, 0.1), 0.1, 0.02, walls)


FILMS = (submerged_collapse,)

if __name__ == "__main__":
    draw_one_of(FILMS, "Draws the film of the gallery with a column that collapses.", 60, {})
