#!/usr/bin/env python3
# SPDX-License-Identifier: MIT
"""Draws the output of breakwater.

    plot_breakwater.py FOLDER

Writes frames.png, levels.png and comparison.md to FOLDER.
"""

import pathlib
import sys

sys.path.insert(0, str(pathlib.Path(__file__).resolve().parent))
from support import plot_style as style
from support.grains_in_water import draw_run
from support.plot_style import plt


def title(run):
    o = run.options
    return (f"{o['height']:g} m of stones in {o['depth']:g} m of water, waves of {o['period']:g} s by a "
            f"stroke of {1e3 * o['stroke']:g} mm; l0 = {o['spacing']:g} m, stones of "
            f"{1e3 * o['diameter']:g} mm")


def draw_frames(run):
    end = run.record["t"][-1]
    return run.figure([0, end / 3, 2 * end / 3, end], title(run))


def draw_levels(run):
    o, record = run.options, run.record
    figure, panels = plt.subplots(3, 1, figsize=(style.WIDE, 6.4), sharex=True)
    half = len(o["gauges"]) // 2
    for axes, numbers, where in ((panels[0], range(half), "before"),
                                 (panels[1], range(half, 2 * half), "behind")):
        for number in numbers:
            axes.plot(record["t"], 1e3 * (record[f"level_{number + 1}"] - o["depth"]),
                      label=f"at {o['gauges'][number]:.2f} m")
        axes.set_ylabel(f"level {where} the\nstones [mm]")
        style.legend_on_top(axes)
    panels[1].sharey(panels[0])
    panels[2].plot(record["t"], 1e3 * (record["crest"] - o["depth"]))
    panels[2].set_ylabel("crest over the\nstill water [mm]")
    panels[2].set_xlabel("time [s]")
    figure.suptitle(title(run), x=0.01, ha="left")
    return figure


if __name__ == "__main__":
    draw_run(__doc__, "breakwater", {"frames.png": draw_frames, "levels.png": draw_levels},
             lambda run: f"Breakwater: {title(run)}")
