#!/usr/bin/env python3
# SPDX-License-Identifier: MIT
"""Draws four frames of grains in water that silt::VtkSeries wrote, viewed along y.

    draw_both.py SERIES.pvd PICTURE.png

Needs Matplotlib (Debian: python3-matplotlib).
"""

import pathlib
import sys

sys.path.insert(0, str(pathlib.Path(__file__).resolve().parents[1]))
from support import plot_style as style  # before matplotlib.pyplot

import matplotlib.pyplot as plt
import numpy as np

from support.frames import draw, extent, speed
from support.grains_in_water import GRAINS, WATER, Part

GRAIN_COLOUR = "#b08a5a"


def from_the_side(frame):
    """Particles from back to front, as (x, height)."""
    order = np.argsort(-frame["position"][:, 1], kind="stable")
    frame = {name: values[order] for name, values in frame.items() if len(values) == len(order)}
    return frame | {"position": frame["position"][:, [0, 2]]}


def draw_frames(path):
    grains, water = Part(path, GRAINS), Part(path, WATER)
    numbers = np.unique(np.linspace(0, len(water) - 1, 4).round().astype(int))
    wet = [from_the_side(water[number]) for number in numbers]
    dry = [from_the_side(grains[number]) for number in numbers]
    spacing = np.linalg.norm(water[0]["position"][1:] - water[0]["position"][0], axis=1).min()
    speeds = [speed(frame) for frame in wet]
    norm = plt.Normalize(*style.range_of(speeds, 0))
    x, z = (extent(wet + dry, axis, spacing) for axis in (0, 1))
    figure, panels = plt.subplots(2, 2, squeeze=False, figsize=(style.WIDE, 6.2))
    for k, axes in enumerate(panels.flat):
        circles = draw(axes, wet[k], speeds[k], 0.6 * spacing, norm=norm, cmap=style.PRESSURE)
        draw(axes, dry[k], np.zeros(len(dry[k]["position"])), edge=0.2).set(
            array=None, facecolor=GRAIN_COLOUR, zorder=2)
        axes.set_title(f"t = {water.times[numbers[k]]:.2g} s")
        axes.locator_params(nbins=5)
        style.box(axes, x, z, ("x [m]", "height [m]"))
    style.bar_of(figure, circles, panels, "speed of the water [m/s]", speeds, aspect=30, pad=0.02)
    return figure


def main(arguments):
    if len(arguments) != 2:
        sys.exit(__doc__)
    style.make(arguments[1], draw_frames, arguments[0])


if __name__ == "__main__":
    main(sys.argv[1:])
