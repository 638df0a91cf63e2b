#!/usr/bin/env python3
# SPDX-License-Identifier: MIT
"""Draws the output of sloshing.

    plot_sloshing.py FOLDER

Writes frames.png, centre.png and comparison.md to FOLDER. If there is a run with --frame tank in
FOLDER/tank, it is compared with it.
"""

import pathlib
import sys

sys.path.insert(0, str(pathlib.Path(__file__).resolve().parent))
from support import plot_style as style
from support.moving_tank import MovingTank, draw_run
from support.plot_style import BLUE, DARK, DASHED, GREY, ORANGE, np, plt


def title(run):
    o = run.options
    return (f"tank of {o['length']:g} m with {o['depth']:g} m of water, swayed {o['periods']} times by "
            f"{2e3 * o['amplitude']:g} mm in {o['period']:.3g} s; l0 = {o['spacing']:g} m")


def draw_frames(run):
    o = run.options
    end = o["periods"] * o["period"]
    return run.figure([0, end, end + 0.25 * o["period"], end + 0.5 * o["period"]], title(run))


def difference(run, other, until):
    """Largest one of the centres until a time [s], [m]."""
    wanted = run.record["t"] <= until
    theirs = np.interp(run.record["t"], other.record["t"], other.record["centre"])
    return np.abs(run.record["centre"] - theirs)[wanted].max()


def in_its_frame(run):
    """The same with a body force; None if there is none."""
    return MovingTank.there(run.folder / "tank")


def draw_centre(run):
    other = in_its_frame(run)
    figure, axes = plt.subplots(figsize=(style.WIDE, 3.8))
    t = run.record["t"]
    axes.plot(t, 1e3 * run.record["centre"], color=BLUE, label="computed")
    if other:
        axes.plot(other.record["t"], 1e3 * other.record["centre"], color=ORANGE, linewidth=1,
                  label="the same with a body force")
    axes.plot(t, 1e3 * run.record["centre_theory"], color=DARK, linewidth=1, linestyle=DASHED,
              label="linear theory")
    axes.plot(t, 1e3 * run.record["displacement"], color=GREY, linewidth=1,
              label="displacement of the tank")
    axes.set_xlabel("time [s]")
    axes.set_ylabel("centre of the water\nin the tank [mm]")
    style.legend_above(figure, axes, 4)
    axes.set_title(title(run))
    return figure


def compare_frames(run, other):
    largest = np.abs(other.record["centre"]).max()
    sway, whole = (difference(run, other, end) / largest for end in
                   (run.options["periods"] * run.options["period"], np.inf))
    with (run.folder / "comparison.md").open("a", encoding="utf-8") as file:
        file.write(f"\nThe same with a body force in the frame of the tank: over the largest "
                   f"displacement of the centre, {1e3 * largest:.3g} mm, it differs by at most "
                   f"{100 * sway:.2g} % while the tank is swayed, and {100 * whole:.2g} % in the whole "
                   "run, in which both tanks are at rest from then on.\n")


def main():
    run = draw_run(__doc__, "sloshing", {"frames.png": draw_frames, "centre.png": draw_centre},
                   lambda run: f"Sloshing: {title(run)}")
    if other := in_its_frame(run):
        compare_frames(run, other)


if __name__ == "__main__":
    main()
