#!/usr/bin/env python3
# SPDX-License-Identifier: MIT
"""Draws the output of settling.

    plot_settling.py FOLDER

Writes frames.png, speed.png and comparison.md to FOLDER.
"""

import pathlib
import sys

sys.path.insert(0, str(pathlib.Path(__file__).resolve().parent))
from support import plot_style as style
from support.grains_in_water import draw_run
from support.plot_style import BLUE, DARK, DASHED, plt


def title(run):
    o = run.options
    what = f"{100 * o['fraction']:g} % of spheres" if o["fraction"] else "a single sphere"
    return f"{what} of {1e3 * o['diameter']:g} mm in water; l0 = {o['spacing']:g} m"


def draw_frames(run):
    end = run.record["t"][-1]
    return run.figure([0, end / 2, end], title(run), columns=3)


def draw_speed(run):
    figure, axes = plt.subplots(figsize=(style.WIDE, 3.8))
    axes.plot(run.record["t"], 1e3 * run.record["speed"], color=BLUE, label="computed")
    speed = next(each for each in run.findings if each["quantity"].startswith("speed"))
    axes.axhline(1e3 * speed["reference"], color=DARK, linewidth=1, linestyle=DASHED,
                 label="Richardson and Zaki" if run.options["fraction"] else "drag law")
    axes.set_xlabel("time [s]")
    axes.set_ylabel("speed, downwards [mm/s]")
    style.legend_above(figure, axes, 2)
    axes.set_title(title(run))
    return figure


if __name__ == "__main__":
    draw_run(__doc__, "settling", {"frames.png": draw_frames, "speed.png": draw_speed},
             lambda run: f"Settling: {title(run)}")
