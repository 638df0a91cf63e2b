# SPDX-License-Identifier: MIT
"""Reads and draws the output of the examples of grains in water that does not resolve them: settling,
fluidised_bed, landslide and breakwater.

    run = GrainsInWater("out/landslide")
    run.figure([0, 0.5, 1], "title")      water and grains at some times
"""

import sys
import xml.etree.ElementTree as xml

import numpy as np

from support.frames import Series, draw
from support.moving_tank import MovingTank

GRAINS, WATER = "0", "1"  # parts of the frames


class Part(Series):
    """One part of the frames of several, listed in a .pvd file."""

    def __init__(self, path, part):
        super().__init__(path)
        sets = list(xml.parse(path).getroot().iter("DataSet"))
        of_part = [number for number, each in enumerate(sets) if each.get("part") == part]
        self.times = self.times[of_part]
        self.files = [self.files[number] for number in of_part]


class GrainsInWater(MovingTank):
    def slice(self, frame, depth):
        """What of a frame is within a depth of the middle [m], as (x, height); of a 2D run all."""
        at = frame["position"]
        keep = np.ones(len(at), bool)
        if self.middle is not None:
            keep = np.abs(at[:, 1] - self.middle) <= depth
            at = at[:, [0, 2, 1]]
        return {name: (at if name == "position" else values)[keep] for name, values in frame.items()
                if len(values) == len(keep)}

    def draw(self, axes, grains, water, norm, cmap):
        """A frame: water coloured by its speed [m/s], grains in front of it. Returns the water."""
        spacing, diameter = self.options["spacing"], self.options["diameter"]
        wet = self.slice(water, 0.51 * spacing)
        circles = draw(axes, wet, np.linalg.norm(wet["velocity"], axis=1), radius=0.6 * spacing,
                       norm=norm, cmap=cmap)
        dry = self.slice(grains, 0.51 * diameter)
        edge = 0.3 if len(dry["position"]) > 0 and diameter > 0.01 * np.ptp(wet["position"][:, 0]) else 0
        stones = draw(axes, dry, np.zeros(len(dry["position"])), radius=diameter / 2, edge=edge)
        stones.set(array=None, facecolor="#b08a5a", zorder=2)
        return circles

    def limits(self, frames, margin):
        """Of x and height over grains and water in these frames, pairs [m]."""
        up = 1 if self.middle is None else 2
        points = np.concatenate([part["position"][:, [0, up]] for frame in frames for part in frame])
        return [(points[:, k].min() - margin, points[:, k].max() + margin) for k in range(2)]

    def figure(self, times, title, columns=1):
        """Water and grains at these times [s]."""
        from support import plot_style as style

        parts = [Part(self.folder / "frames.pvd", part) for part in (GRAINS, WATER)]
        numbers = sorted({parts[0].nearest(time) for time in times})
        frames = [[series[number] for series in parts] for number in numbers]
        x, y = self.limits(frames, 2 * self.options["spacing"])
        speeds = [np.linalg.norm(water["velocity"], axis=1) for _, water in frames]
        norm = style.plt.Normalize(*style.range_of(speeds, 0))
        rows = -(-len(frames) // columns)
        tall = 6.8 / columns * (y[1] - y[0]) / (x[1] - x[0]) + 0.35
        figure, panels = style.plt.subplots(rows, columns, squeeze=False, sharex=True, sharey=True,
                                            figsize=(style.WIDE, 0.8 + tall * rows))
        for axes, frame, number in zip(panels.flat, frames, numbers):
            style.box(axes, x, y, ("x [m]", None))
            circles = self.draw(axes, *frame, norm, style.PRESSURE)
            axes.set_title(f"t = {parts[0].times[number]:.2f} s")
        for axes in panels.flat[len(frames):]:
            axes.remove()
        figure.supylabel("height [m]", fontsize=10)
        figure.suptitle(title, x=0.01, ha="left")
        style.bar_of(figure, circles, panels.flat[:len(frames)], "speed of the water [m/s]", speeds,
                     shrink=0.8, aspect=30)
        return figure


def draw_run(doc, program, pictures, heading):
    """As that of moving_tank, for a run of GrainsInWater."""
    from support import plot_style as style

    if len(sys.argv) != 2:
        sys.exit(doc)
    run = GrainsInWater.there(sys.argv[1])
    if run is None:
        sys.exit(f"plot_{program}.py: {sys.argv[1]} has no summary.json; run {program} first")
    for name, draw_picture in pictures.items():
        style.make(run.folder / name, draw_picture, run)
    run.compare(run.folder / "comparison.md", heading(run))
