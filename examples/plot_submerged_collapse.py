#!/usr/bin/env python3
# SPDX-License-Identifier: MIT
"""Draws the output of submerged_collapse.

    plot_submerged_collapse.py FOLDER

Writes frames.png, history.png and comparison.md to FOLDER.
"""

import pathlib
import sys

sys.path.insert(0, str(pathlib.Path(__file__).resolve().parent))
from support import plot_style as style
from support.grains_in_water import draw_run
from support.plot_style import plt


def title(run):
    o = run.options
    return (f"{'dense' if o['dense'] else 'loose'} column of beads of {1e3 * o['bead']:g} mm in a viscous liquid; "
            f"l0 = {1e3 * o['spacing']:g} mm, grains of {1e3 * o['diameter']:g} mm")


def draw_frames(run):
    end = run.record["t"][-1]
    return run.figure([0, 0.1 * end, 0.25 * end, 0.5 * end, end], title(run))


def draw_history(run):
    figure, (above, below) = plt.subplots(2, 1, sharex=True, figsize=(style.WIDE, 4.6))
    above.plot(run.record["t"], run.record["front"] - run.options["length"], label="run-out")
    above.plot(run.record["t"], run.record["height"], label="height at the wall")
    above.set_ylabel("[m]")
    above.set_ylim(bottom=0)
    above.legend(frameon=False)
    below.plot(run.record["t"], run.record["excess_pressure"], linewidth=0.7)
    below.axhline(0, color=style.DARK, linewidth=0.8)
    below.set_ylabel("excess pressure\nin the pores [Pa]")
    below.set_xlabel("time [s]")
    above.set_title(title(run))
    return figure


if __name__ == "__main__":
    draw_run(__doc__, "submerged_collapse", {"frames.png": draw_frames, "history.png": draw_history},
             lambda run: f"Submerged collapse: {title(run)}")
