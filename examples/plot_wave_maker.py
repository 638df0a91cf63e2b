#!/usr/bin/env python3
# SPDX-License-Identifier: MIT
"""Draws the output of wave_maker.

    plot_wave_maker.py FOLDER

Writes frames.png, levels.png and comparison.md to FOLDER.
"""

import pathlib
import sys

sys.path.insert(0, str(pathlib.Path(__file__).resolve().parent))
from support import plot_style as style
from support.moving_tank import draw_run
from support.plot_style import DARK, DASHED, plt


def title(run):
    o = run.options
    end = "a wall" if o["far_end"] == "wall" else f"a {o['far_end']} of {o['far_length']:g} m"
    return (f"{o['type']} with a stroke of {1e3 * o['stroke']:g} mm and a period of {o['period']:g} s, "
            f"{o['depth']:g} m of water, {end} at the far end; l0 = {o['spacing']:g} m")


def draw_frames(run):
    end = run.record["t"][-1]
    return run.figure([0, end / 3, 2 * end / 3, end], title(run))


def draw_levels(run):
    o, record = run.options, run.record
    figure, axes = plt.subplots(len(o["gauges"]), 1, figsize=(style.WIDE, 6.8), sharex=True,
                                sharey=True)
    half = 1e3 * run.findings[0]["reference"] * o["stroke"] / 2
    for number, (panel, place) in enumerate(zip(axes, o["gauges"]), start=1):
        panel.plot(record["t"], 1e3 * (record[f"level_{number}"] - o["depth"]))
        for sign in (-1, 1):
            panel.axhline(sign * half, color=DARK, linewidth=1, linestyle=DASHED,
                          label="Biésel's height" if sign > 0 and number == 1 else None)
        panel.set_ylabel(f"level at\n{place:.2f} m [mm]")
    axes[-1].set_xlabel("time [s]")
    style.legend_on_top(axes[0], 2)
    figure.suptitle(title(run), x=0.01, ha="left")
    return figure


if __name__ == "__main__":
    draw_run(__doc__, "wave_maker", {"frames.png": draw_frames, "levels.png": draw_levels},
             lambda run: f"Wave maker: {title(run)}")
