#!/usr/bin/env python3
# SPDX-License-Identifier: MIT
"""Draws the output of landslide.

    plot_landslide.py FOLDER

Writes frames.png, levels.png and comparison.md to FOLDER.
"""

import pathlib
import sys

sys.path.insert(0, str(pathlib.Path(__file__).resolve().parent))
from support import plot_style as style
from support.grains_in_water import draw_run
from support.plot_style import DARK, DASHED, np, plt


def title(run):
    o = run.options
    return (f"slide of {o['slide_length']:g} m × {o['slide_thickness']:g} m at {o['angle']:g}° into "
            f"{o['depth']:g} m of water; l0 = {o['spacing']:g} m, grains of {1e3 * o['diameter']:g} mm")


def draw_frames(run):
    end = run.record["t"][-1]
    return run.figure([0, 0.2 * end, 0.35 * end, 0.5 * end, end], title(run))


def draw_levels(run):
    figure, axes = plt.subplots(figsize=(style.WIDE, 3.8))
    depth = run.options["depth"]
    colours = plt.get_cmap("viridis")(np.linspace(0, 0.85, len(run.options["gauges"])))
    for k, (distance, colour) in enumerate(zip(run.options["gauges"], colours)):
        axes.plot(run.record["t"], run.record[f"level_{k + 1}"] / depth - 1, color=colour,
                  label=f"{distance:g} h from the shore")
    for each in run.findings:
        if each["quantity"].startswith("amplitude"):
            axes.axhline(each["reference"], color=DARK, linewidth=1, linestyle=DASHED,
                         label="crest by Heller and Hager")
    axes.set_xlabel("time [s]")
    axes.set_ylabel("level over the still one, over h")
    style.legend_above(figure, axes, 3)
    axes.set_title(title(run))
    return figure


if __name__ == "__main__":
    draw_run(__doc__, "landslide", {"frames.png": draw_frames, "levels.png": draw_levels},
             lambda run: f"Landslide: {title(run)}")
