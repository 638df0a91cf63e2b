#!/usr/bin/env python3
# SPDX-License-Identifier: MIT
"""Draws the output of fluidised_bed.

    plot_fluidised_bed.py FOLDER

Writes frames.png, drop.png and comparison.md to FOLDER.
"""

import pathlib
import sys

sys.path.insert(0, str(pathlib.Path(__file__).resolve().parent))
from support import plot_style as style
from support.grains_in_water import draw_run
from support.plot_style import BLUE, DARK, DASHED, GREY, np, plt

WATER = 1000.0  # density [kg/m³]


def title(run):
    o = run.options
    return (f"spheres of {1e3 * o['diameter']:g} mm in water that rises faster and faster; "
            f"l0 = {o['spacing']:g} m")


def draw_frames(run):
    end = run.record["t"][-1]
    return run.figure([0, 0.6 * end, 0.8 * end, end], title(run), columns=4)


def ergun(run, speed, porosity):
    """Pressure drop over the length of the bed [Pa/m]."""
    d, mu = run.options["diameter"], WATER * run.options["viscosity"]
    solid = 1 - porosity
    return (150 * solid**2 * mu * speed / (porosity**3 * d**2)
            + 1.75 * solid * WATER * speed**2 / (porosity**3 * d))


def draw_drop(run):
    figure, axes = plt.subplots(figsize=(style.WIDE, 3.8))
    speed = run.record["velocity"]
    axes.plot(1e3 * speed, run.record["drop"] / 1e3, color=BLUE, linewidth=1, label="computed")
    packed = next(each["measured"] for each in run.findings
                  if each["quantity"].startswith("fluid fraction"))
    height = run.options["weight_per_area"] / ((1 - packed) * (run.options["density"] - WATER) * 9.81)
    line = np.linspace(0, speed.max(), 100)
    drop = ergun(run, line, packed) * height / 1e3
    weight = run.options["weight_per_area"] / 1e3
    axes.plot(1e3 * line[drop < 1.2 * weight], drop[drop < 1.2 * weight], color=DARK, linewidth=1,
              linestyle=DASHED, label=f"Ergun, porosity {packed:.3f}")
    axes.axhline(weight, color=GREY, linewidth=1, label="buoyant weight of the bed")
    axes.set_xlabel("superficial velocity [mm/s]")
    axes.set_ylabel("pressure drop over the bed [kPa]")
    style.legend_above(figure, axes, 3)
    axes.set_title(title(run))
    return figure


if __name__ == "__main__":
    draw_run(__doc__, "fluidised_bed", {"frames.png": draw_frames, "drop.png": draw_drop},
             lambda run: f"Fluidised bed: {title(run)}")
