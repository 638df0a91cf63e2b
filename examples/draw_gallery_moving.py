#!/usr/bin/env python3
# SPDX-License-Identifier: MIT
"""Draws the films of the gallery in which walls or bodies move, or water enters and leaves, with
Matplotlib.

    draw_gallery_moving.py NAME FOLDER [--frames NUMBER]

Reads the output of the run of this item in FOLDER, and writes FOLDER/NAME.webp.
"""

import pathlib
import sys

sys.path.insert(0, str(pathlib.Path(__file__).resolve().parent))
from support.films import HEAT, WALL, WATER, Series, Sheet, draw_one_of, np, plt
from support.frames import draw, speed
from support.moving_tank import MovingTank

MOVING = "#d1495b"  # walls and bodies
OVERLAP = 1.4  # diameter of a drawn particle over the spacing, so that no gaps are seen


def kilopascals(frame):
    return frame["pressure"] / 1000


def film(folder, count, size, x, y, highest, length, until=np.inf, of_speed=False):
    """The water and its walls between these limits [m]; highest: end of the colours; length: of the bar
    that shows the scale [m]."""
    run, series = MovingTank(folder), Series(folder / "frames.pvd")
    norm, colours = plt.Normalize(0, highest), HEAT if of_speed else WATER
    sheet = Sheet(*size)
    high = 1 - 130 / size[1]  # the clock and the scale have the same size in all films
    axes = sheet.axes((0.02, 70 / size[1], 0.83, high), x, y)
    sheet.scale(axes, length, x[0], y[0])
    sheet.bar(norm, colours, "speed [m/s]" if of_speed else "pressure [kPa]",
              (0.875, 0.15, 0.016, 0.7), "max")
    shown = []

    def show(number):
        while shown:
            shown.pop().remove()
        frame = series[number]
        shown.append(draw(axes, frame, speed(frame) if of_speed else kilopascals(frame),
                          OVERLAP * run.options["spacing"] / 2, norm=norm, cmap=colours))
        for segment, group in zip(*run.walls(number)):
            shown.extend(axes.plot(*segment.T, color=MOVING if group > 0 else WALL, linewidth=4,
                                   solid_capstyle="round", zorder=3 if group > 0 else 0))
        return series.times[number]

    # The first frame has no pressure yet.
    return sheet.film(series.numbers(count + 1, until)[1:], show)


def wave_maker(folder, count):
    return film(folder, count, (840, 260), (-0.12, 2.02), (-0.05, 0.36), 2.2, 0.2)


def floating_body(folder, count):
    return film(folder, count, (720, 450), (-0.01, 1.21), (-0.04, 0.6), 4, 0.2)


def sloshing(folder, count):
    return film(folder, count, (560, 490), (-0.05, 0.47), (-0.03, 0.4), 2.5, 0.1)


def hydraulic_jump(folder, count):
    return film(folder, count, (840, 260), (-0.04, 3.05), (-0.08, 0.4), 2.2, 0.5, of_speed=True)


def weir(folder, count):
    return film(folder, count, (720, 450), (-0.04, 1.48), (-0.13, 0.36), 2, 0.2, of_speed=True)


FILMS = (wave_maker, floating_body, sloshing, hydraulic_jump, weir)

if __name__ == "__main__":
    draw_one_of(FILMS, "Draws a film of the gallery with walls that move or openings.", 60, {})
