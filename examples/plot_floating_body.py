#!/usr/bin/env python3
# SPDX-License-Identifier: MIT
"""Draws the output of floating_body.

    plot_floating_body.py FOLDER

Writes frames.png, motion.png and comparison.md to FOLDER.
"""

import pathlib
import sys

sys.path.insert(0, str(pathlib.Path(__file__).resolve().parent))
from support import plot_style as style
from support.moving_tank import draw_run
from support.plot_style import DARK, DASHED, np, plt
from support.water import DENSITY, G, REFERENCE, table


def title(run):
    o = run.options
    size = f"{o['width']:g} m × {o['height']:g} m"
    if run.middle is not None:
        size = f"{o['width']:g} m × {o['breadth']:g} m × {o['height']:g} m"
    return (f"box of {size}, {o['density_ratio']:g} of the density of water, released "
            f"{1e3 * o['offset']:g} mm above its draught, at {o['tilt']:g}°; l0 = {o['spacing']:g} m")


def draw_frames(run):
    end = run.record["t"][-1]
    return run.figure([0, end / 4, end], title(run))


def draw_motion(run):
    o, record = run.options, run.record
    flat = run.middle is None
    t = record["t"]
    rest = o["depth"] + (0.5 - o["density_ratio"]) * o["height"]  # in the undisturbed surface
    heave = 1e3 * (record["y" if flat else "z"] - rest)
    turn = np.degrees(record["turn"] if flat else -record["turn_y"])
    weight = (o["density_ratio"] * DENSITY * G * o["width"] * o["height"]
              * (1 if flat else o["breadth"]))
    turns = o["hold"] in ("none", "sway")
    figure, axes = plt.subplots(3 if turns else 2, 1, figsize=(style.WIDE, 6.4 if turns else 4.6),
                                sharex=True)
    last = axes[-1]
    axes[0].plot(t, heave, label="computed")
    if any(each["reference"] for each in run.findings if each["quantity"].startswith("zero")):
        theory = table(REFERENCE / "heave_of_a_box.csv")
        scale = np.sqrt(o["width"] / 0.4)
        wanted = theory["t"] * scale <= t[-1]
        axes[0].plot(theory["t"][wanted] * scale, heave[0] * theory["heave"][wanted],
                     color=DARK, linewidth=1, linestyle=DASHED, label="linear potential theory")
    axes[0].set_ylabel("heave [mm]")
    style.legend_on_top(axes[0], 2)
    if turns:
        axes[1].plot(t, turn)
        axes[1].set_ylabel("tilt [°]")
    # Forces act in steps of different length, and are noisy: means over 20 ms.
    for name, label in (("force_y" if flat else "force_z", "upwards"), ("force_x", "along x")):
        begin, end = np.searchsorted(t, t - 0.01), np.searchsorted(t, t + 0.01, side="right")
        total = np.concatenate([[0], np.cumsum(record[name])])
        last.plot(t[1:], ((total[end] - total[begin]) / (end - begin) / weight)[1:], label=label)
    last.set_ylabel("force of the water\n/ weight [-]")
    last.set_xlabel("time [s]")
    style.legend_on_top(last, 2)
    figure.suptitle(title(run), x=0.01, ha="left")
    return figure


if __name__ == "__main__":
    draw_run(__doc__, "floating_body", {"frames.png": draw_frames, "motion.png": draw_motion},
             lambda run: f"Floating {title(run)}")
