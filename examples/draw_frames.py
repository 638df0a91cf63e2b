#!/usr/bin/env python3
# SPDX-License-Identifier: MIT
"""Draws frames written by silt::VtkSeries, as a substitute for ParaView.

    draw_frames.py SERIES.pvd PICTURE.png            four frames, from the first to the last
    draw_frames.py SERIES.pvd FILM.gif               all frames
    draw_frames.py SERIES.pvd PICTURE.png --field pressure

Particles are circles of their true size, coloured by a field: "speed" (the default, |velocity|) or
any array of the frames with one number per particle. Wall particles of a tank are grey, dummy
particles are omitted. Particles in 3D are viewed along y. Needs Matplotlib (Debian:
python3-matplotlib).
"""

import argparse
import math
import pathlib
import sys

sys.path.insert(0, str(pathlib.Path(__file__).resolve().parent))
from support.modules import need

need("numpy", "matplotlib")
from support import plot_style as style  # before matplotlib.pyplot

import matplotlib.pyplot as plt
import numpy as np
from matplotlib.animation import FuncAnimation, PillowWriter
from matplotlib.colors import ListedColormap

from support.frames import Series, draw, speed

WALL = 1  # of mps::Kind
WALL_COLOUR = "#c8ccd0"
UNKNOWN_COLOUR = "#8a9099"
COLOURS = {"speed": style.SPEED, "pressure": style.PRESSURE}
UNITS = {"speed": "m/s", "pressure": "Pa", "radius": "m", "mass": "kg"}


def values_of(frame, field):
    """One number per particle."""
    if field == "speed":
        return speed(frame)
    if field not in frame or frame[field].ndim != 1:
        names = ", ".join(["speed", *(name for name in frame if frame[name].ndim == 1)])
        sys.exit(f"draw_frames.py: no field {field} with one number per particle; there are {names}")
    return frame[field]


def some(frame, which):
    """The frame with some of its particles, in this order."""
    count = len(frame["position"])
    return {name: values[which] for name, values in frame.items() if len(values) == count}


def seen_from_the_side(frame):
    """The frame without dummy particles and with the vertical axis second; particles in 3D are
    ordered from back to front."""
    if "kind" in frame:
        frame = some(frame, frame["kind"] <= WALL)
    if not frame["position"][:, 2].any():
        return frame
    frame = some(frame, np.argsort(-frame["position"][:, 1], kind="stable"))
    frame["position"] = frame["position"][:, [0, 2, 1]]
    return frame


def is_wall(frame):
    return frame["kind"] == WALL if "kind" in frame else np.zeros(len(frame["position"]), bool)


def particle_radius(frame):
    """None if the frame has radii; otherwise half the distance from one particle to the nearest."""
    if "radius" in frame:
        return None
    x = frame["position"]
    return np.linalg.norm(x[1:] - x[0], axis=1).min() / 2 if len(x) > 1 else 0.01


def edges_of(frame, radius):
    """Corners of the squares around the circles, as points (x, height)."""
    x, R = frame["position"][:, :2], np.broadcast_to(
        frame["radius"] if radius is None else radius, len(frame["position"]))
    return np.concatenate([x - R[:, None], x + R[:, None]])


def columns_for(count, ratio):
    """Of axes with this ratio of width to height, so that the figure is about twice as wide as high."""
    full = [columns for columns in range(1, count + 1) if count % columns == 0]
    return min(full, key=lambda columns: abs(math.log(columns**2 * ratio / count / 2)))


def main():
    parser = argparse.ArgumentParser(description="Draws frames written by silt::VtkSeries.")
    parser.add_argument("series", help="the .pvd file")
    parser.add_argument("picture", help="the .png or .gif file to write")
    parser.add_argument("--field", default="speed", help="speed, or an array of the frames")
    options = parser.parse_args()

    series = Series(options.series)
    is_film = options.picture.endswith(".gif")
    numbers = np.arange(len(series)) if is_film else np.unique(
        np.linspace(0, len(series) - 1, 4).round().astype(int))
    frames = [seen_from_the_side(series[number]) for number in numbers]
    radius = particle_radius(series[0])
    walls = [some(frame, is_wall(frame)) for frame in frames]
    frames = [some(frame, ~is_wall(frame)) for frame in frames]
    values = [values_of(frame, options.field) for frame in frames]
    # No pressure is computed before the first step.
    waits = options.field == "pressure" and numbers[0] == 0 and not values[0].any()
    norm = plt.Normalize(*style.range_of(values[1:] if waits and len(values) > 1 else values))
    edges = np.concatenate([edges_of(frame, radius) for frame in frames + walls])
    low, high = edges.min(axis=0), edges.max(axis=0)
    margin = 0.05 * (high - low).max()
    low, high = low - margin, high + margin
    ratio = (high[0] - low[0]) / (high[1] - low[1])

    def show(axes, k):
        axes.clear()
        if len(walls[k]["position"]):
            draw(axes, walls[k], np.zeros(len(walls[k]["position"])), radius,
                 cmap=ListedColormap([WALL_COLOUR]))
        circles = draw(axes, frames[k], values[k], radius, norm=norm,
                       cmap=COLOURS.get(options.field, "viridis"))
        title = f"t = {series.times[numbers[k]]:.3g} s"
        if k == 0 and waits:
            circles.set(array=None, facecolor=UNKNOWN_COLOUR)
            title += ",\nnot yet computed"
        axes.set_title(title)
        axes.locator_params(nbins=5)
        style.box(axes, (low[0], high[0]), (low[1], high[1]), ("x [m]", "height [m]"))
        return circles

    count = 1 if is_film else len(frames)
    columns = columns_for(count, ratio)
    rows = count // columns
    width = 6.5 if is_film else (style.WIDE - 1) / columns
    height = min(max(width / ratio, 0.8), 8)
    figure, all_axes = plt.subplots(rows, columns, squeeze=False,
                                    figsize=(width * columns + 1, (height + 0.35) * rows + 0.4))
    all_axes = list(all_axes.ravel())
    circles = [show(axes, k) for k, axes in enumerate(all_axes)]
    unit = UNITS.get(options.field)
    style.bar_of(figure, circles[-1], all_axes, options.field + (f" [{unit}]" if unit else ""),
                 values, aspect=15 * rows, pad=0.02)
    if is_film:
        film = FuncAnimation(figure, lambda k: [show(all_axes[0], k)], len(frames))
        film.save(options.picture, PillowWriter(fps=15), dpi=100)
    else:
        style.make(options.picture, lambda: figure)


if __name__ == "__main__":
    main()
