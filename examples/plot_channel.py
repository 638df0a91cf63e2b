#!/usr/bin/env python3
# SPDX-License-Identifier: MIT
"""Draws the output of channel.

    plot_channel.py FOLDER

Writes frames.png, theory.png and comparison.md to FOLDER.
"""

import pathlib
import sys

sys.path.insert(0, str(pathlib.Path(__file__).resolve().parent))
from support import plot_style as style
from support.moving_tank import draw_run
from support.plot_style import BLUE, DARK, DASHED, ORANGE, np, plt
from support.water import G


def title(run):
    o = run.options
    flow = {"jump": f"hydraulic jump at Fr = {o['froude']:g}, water of {o['depth']:g} m before it",
            "weir": f"broad-crested weir, discharge {o['flow']:.3g} m²/s",
            "slot": f"slot of {o['slot']:g} m in a floor, half of it, discharge "
                    f"{2 * o['flow']:.3g} m²/s"}[o["case"]]
    return f"{flow}; l0 = {o['spacing']:g} m"


def draw_frames(run):
    end = run.record["t"][-1]
    times = [0, end / 2, end] if run.options["case"] == "slot" else [0, end / 3, 2 * end / 3, end]
    return run.figure(times, title(run))


def settled(run):
    """Of the record: the second half of the time, of which the findings are means."""
    return run.record["t"] >= run.record["t"][-1] / 2


def mean(run, name):
    t = run.record["t"]
    duration = np.diff(t, prepend=t[0])[settled(run)]
    return np.average(run.record[name][settled(run)], weights=duration)


def draw_surface(axes, run):
    """Along the channel: mean and range of the level, and theory."""
    o = run.options
    x = np.array(o["gauges"])
    levels = np.array([run.record[f"level_{k + 1}"][settled(run)] for k in range(len(x))])
    axes.fill_between(x, *np.quantile(levels, [0.05, 0.95], axis=1), color=BLUE, alpha=0.25,
                      linewidth=0, label="9 tenths of the time")
    axes.plot(x, [mean(run, f"level_{k + 1}") for k in range(len(x))], color=BLUE, label="mean")
    for segment, group in zip(*run.walls(0)):
        if group == 0:
            axes.plot(*segment.T, color=style.WALL, linewidth=1.8)
    if o["case"] == "jump":
        axes.plot([x[0], x[-1]], [o["depth"]] * 2, color=DARK, linewidth=1, linestyle=":",
                  label="depth that enters")
        axes.plot([x[0], x[-1]], [o["depth_after"]] * 2, color=DARK, linewidth=1, linestyle=DASHED,
                  label="depth after the jump by Bélanger")
    else:
        critical = np.cbrt(o["flow"]**2 / G)
        crest = max(o["floor"])
        axes.plot([x[np.array(o["floor"]) == crest][0], x[-1]], [crest + critical] * 2, color=DARK,
                  linewidth=1, linestyle=DASHED, label="critical depth on the crest")
    axes.set_ylim(-0.02 * levels.max())
    axes.set_xlabel("x [m]")
    axes.set_ylabel("level [m]")
    style.legend_on_top(axes, 4)


def draw_jet(axes, run):
    """Below the slot: half of its width, and that of a free jet which falls."""
    o = run.options
    b = o["slot"]
    level = np.mean([mean(run, f"level_{k + 1}") for k, x in enumerate(o["gauges"]) if x > b])
    below = b * (np.arange(o["slices"]) + 1.5) / 2
    width = [mean(run, f"width_{k + 1}") for k in range(o["slices"])]
    speed = [mean(run, f"speed_{k + 1}") for k in range(o["slices"])]
    depth = np.linspace(0.25 * b, below[-1] + 0.25 * b, 50)
    axes.plot(below / b, np.array(width) / b, "o", color=BLUE, label="width over that of the slot")
    axes.plot(depth / b, np.pi / (np.pi + 2) * np.sqrt(level / (level + depth)), color=BLUE, linewidth=1,
              linestyle=DASHED, label="by Kirchhoff, falling freely")
    exact = np.sqrt(2 * G * (level + below))
    axes.plot(below / b, np.array(speed) / exact, "s", color=ORANGE, label="speed over Torricelli's")
    axes.axhline(1, color=ORANGE, linewidth=1, linestyle=DASHED)
    axes.set_ylim(0, 1.1)
    axes.set_xlabel("depth below the floor / width of the slot")
    axes.set_ylabel("width, speed [-]")
    style.legend_on_top(axes, 3)


def draw_volumes(axes, run):
    """The discharge in every twentieth of the run, over that given. That which enters comes in layers,
    which would be seen more than the discharge."""
    o, t = run.options, run.record["t"]
    every = np.linspace(0, t[-1], 21)
    for name, label, colour in (("passed", "through a section", BLUE), ("out", "leaves", ORANGE)):
        volume = np.interp(every, t, run.record[f"volume_{name}"])
        axes.plot((every[1:] + every[:-1]) / 2, np.diff(volume) / np.diff(every) / o["flow"],
                  color=colour, label=label)
    axes.axhline(1, color=DARK, linewidth=1, linestyle=DASHED, label="given")
    axes.set_ylim(0)
    axes.set_xlabel("time [s]")
    axes.set_ylabel("discharge / that given")
    style.legend_on_top(axes, 3)


def draw_theory(run):
    figure, axes = plt.subplots(2, 1, figsize=(style.WIDE, 6))
    (draw_jet if run.options["case"] == "slot" else draw_surface)(axes[0], run)
    draw_volumes(axes[1], run)
    figure.suptitle(title(run), x=0.01, ha="left")
    return figure


if __name__ == "__main__":
    draw_run(__doc__, "channel", {"frames.png": draw_frames, "theory.png": draw_theory},
             lambda run: f"Channel: {title(run)}")
