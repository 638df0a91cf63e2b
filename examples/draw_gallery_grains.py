#!/usr/bin/env python3
# SPDX-License-Identifier: MIT
"""Draws the films of the gallery with grains in water, with Matplotlib.

    draw_gallery_grains.py NAME FOLDER [--frames NUMBER]

Reads the output of the run of this item in FOLDER, and writes FOLDER/NAME.webp.
"""

import pathlib
import sys

sys.path.insert(0, str(pathlib.Path(__file__).resolve().parent))
from support.films import WALL, WATER, Series, Sheet, draw_one_of, np, plt
from support.grains_in_water import GRAINS, WATER as FLUID, GrainsInWater, Part


class FilmPart(Part, Series):
    """Read by VTK."""


def film(run, count, size, x, y, fastest, length, walls):
    """Grains and water between these limits [m]; fastest: end of the colours [m/s]; length: of the bar that
    shows the scale [m]; walls: points of a line [m]."""
    folder = run.folder
    parts = [FilmPart(folder / "frames.pvd", part) for part in (GRAINS, FLUID)]
    norm = plt.Normalize(0, fastest)
    sheet = Sheet(*size)
    right = 1 - 105 / size[0]  # where the colour bar begins
    axes = sheet.axes((0.02, 70 / size[1], right - 0.045, 1 - 130 / size[1]), x, y)
    axes.plot(*np.transpose(walls), color=WALL, linewidth=3, solid_capstyle="round", zorder=0)
    sheet.scale(axes, length, x[0], y[0])
    sheet.bar(norm, WATER, "speed of the water [m/s]", (right, 0.15, 13 / size[0], 0.7), "max")

    def show(number):
        for collection in list(axes.collections):
            collection.remove()
        run.draw(axes, parts[0][number], parts[1][number], norm, WATER)
        return parts[0].times[number]

    return sheet.film(parts[0].numbers(count), show)


def landslide(folder, count):
    run = GrainsInWater(folder)
    slope = np.tan(np.radians(run.options["angle"]))
    walls = [(-0.78, 0.78 * slope), (0, 0), (1.62, 0)]
    return film(run, count, (840, 330), (-0.75, 1.6), (-0.04, 0.8), 1.5, 0.2, walls)


def fluidised_bed(folder, count):
    run = GrainsInWater(folder)
    width = run.options["width"]
    walls = [(0, 0.62), (0, 0), (width, 0), (width, 0.62)]
    return film(run, count, (420, 720), (-0.02, width + 0.02), (-0.02, 0.64), 0.3, 0.05, walls)


FILMS = (landslide, fluidised_bed)

if __name__ == "__main__":
    draw_one_of(FILMS, "Draws a film of the gallery with grains in water.", 60, {})
