#!/usr/bin/env python3
# SPDX-License-Identifier: MIT
"""Draws the output of hopper.

    plot_hopper.py FOLDER

Writes frames.png, discharge.png, discharge.gif and comparison.md to FOLDER.
"""

import json
import pathlib
import sys

sys.path.insert(0, str(pathlib.Path(__file__).resolve().parent))
from support import plot_style as style
from support.frames import Series
from support.plot_style import DARK, DASHED, ORANGE, np, plt

LAYERS = ["#123b5d", "#e0a458", "#7fb2b8", "#b5523b"]
STEEL = "#4d535b"
REMOVED_BELOW = 6  # diameters below the opening, as in hopper.cpp
REMOVED = "dashed: grains are removed below this height"


class Run:
    """One output folder."""

    def __init__(self, folder):
        self.summary = json.loads((folder / "summary.json").read_text())
        self.options = self.summary["options"]
        self.series = Series(folder / "frames.pvd")
        self.discharge = np.genfromtxt(folder / "discharge.csv", delimiter=",", names=True)
        self.d = self.options["diameter"]
        self.dimension = self.options["dimension"]
        self.opening = self.summary["rates"][-1]["opening_over_d"] * self.d
        first = self.series[0]
        height = first["position"][:, self.dimension - 1]
        # Layer of each grain in the bed at rest, by its id.
        self.layer = np.empty(int(first["id"].max()) + 1, dtype=int)
        thickness = 3 * self.d
        self.layer[first["id"]] = (height / thickness).astype(int) % len(LAYERS)

    @property
    def name(self):
        what = "slice through the axis" if self.dimension == 3 else "discs in a slot"
        return (f"Discharge through an opening of {self.opening / self.d:g} d, "
                f"d = {1e3 * self.d:g} mm ({what})")


def draw_bin(axes, run):
    """The walls, with axes in metres."""
    half, gap = run.options["width"] * run.d / 2, run.opening / 2
    angle = np.radians(run.options["half_angle"])
    corner = 0 if run.options["half_angle"] == 90 else (half - gap) / np.tan(angle)
    top = corner + (run.options["fill_height"] + 3) * run.d
    for side in (-1, 1):
        axes.plot([side * half, side * half, side * gap], [top, corner, 0], color=STEEL,
                  linewidth=2, solid_capstyle="butt", solid_joinstyle="miter", zorder=3)
    axes.axhline(-REMOVED_BELOW * run.d, color=DARK, linewidth=0.8, linestyle=DASHED)
    style.box(axes, (-half - run.d, half + run.d), (-8 * run.d, top), ("x [m]", "height [m]"))


def draw_grains(axes, run, frame):
    """In 3D the cross-sections of the grains with the central plane."""
    from matplotlib.collections import EllipseCollection

    x, radius = frame["position"], frame["radius"]
    shown = np.ones(len(x), dtype=bool)
    if run.dimension == 3:
        cut = radius**2 - x[:, 1]**2
        shown = cut > 0
        radius = np.sqrt(np.maximum(cut, 0))
    colours = np.array(LAYERS)[run.layer[frame["id"][shown]]]
    size = 2 * radius[shown]
    return axes.add_collection(EllipseCollection(
        size, size, np.zeros(len(size)), units="xy", facecolors=colours, edgecolors="white",
        linewidths=0.2, offsets=x[shown][:, [0, run.dimension - 1]],
        offset_transform=axes.transData))


def draw_frames(run):
    numbers = np.linspace(0, len(run.series) - 1, 4).round().astype(int)
    figure, panels = plt.subplots(1, 4, figsize=(style.WIDE, 4.4), sharex=True, sharey=True)
    for axes, number in zip(panels, numbers):
        draw_bin(axes, run)
        draw_grains(axes, run, run.series[number])
        axes.set_title(f"t = {run.series.times[number]:.2f} s")
    figure.suptitle(f"{run.name};\ncolours: layers of the bed at rest, 3 d thick; {REMOVED}",
                    x=0.01, ha="left")
    return figure


def animate(run, path):
    figure, axes = plt.subplots(figsize=(8, 8))
    draw_bin(axes, run)
    figure.suptitle(f"{run.name};\n{REMOVED}", x=0.01, ha="left")

    def show(number):
        axes.set_title(f"t = {run.series.times[number]:.2f} s")
        return [draw_grains(axes, run, run.series[number])]

    step = max(1, len(run.series) // 60)
    style.film(path, figure, range(0, len(run.series), step), show, rate=12)


def reduced_rates(run):
    """D/d and W / (ρ_b √g d^n)."""
    rates = run.summary["rates"]
    W = np.array([rate["rate"] / rate["solid_fraction"] for rate in rates])
    unit = run.options["density"] * np.sqrt(9.81) * run.d ** run.summary["exponent_of_the_law"]
    return np.array([rate["opening_over_d"] for rate in rates]), W / unit


def coefficient(run, k):
    """C of the law for this k."""
    D, W = reduced_rates(run)
    return np.mean(W / (D - k) ** run.summary["exponent_of_the_law"])


def draw_discharge(run):
    s = run.summary
    figure, axes = plt.subplots(1, 3, figsize=(style.WIDE, 3.9))
    unit = np.sqrt(run.d / 9.81)
    rates = s["rates"]
    colours = plt.cm.viridis(np.linspace(0.05, 0.85, len(rates)))
    for rate, colour in zip(rates, colours):
        own = run.discharge[run.discharge["opening_over_d"] == rate["opening_over_d"]]
        axes[0].plot(own["t"] / unit, own["mass"], color=colour,
                     label=f"opening D = {rate['opening_over_d']:g} d")
    axes[0].set_xlabel("t / √(d/g) [-]")
    axes[0].set_ylabel("mass let out [kg]" if run.dimension == 3 else "mass let out [kg/m]")
    axes[0].set_title("discharge")

    D, W = reduced_rates(run)
    k, own_k = s["k"], s["k_for_the_exponent_of_the_law"]
    law = s["exponent_of_the_law"]
    if len(rates) > 1:
        line = np.linspace((D - k).min() * 0.9, (D - k).max() * 1.1)
        axes[1].loglog(line, coefficient(run, own_k) * (line + k - own_k) ** law, color=ORANGE,
                       label=f"{coefficient(run, own_k):.2f} (D/d − {own_k:.2f})$^{{{law:g}}}$")
    slope = f", slope {s['exponent']:.2f}" if len(rates) > 1 else ""
    axes[1].loglog(D - k, W, "o", color=DARK, label="measured" + slope)
    axes[1].set_xlabel(f"D/d − {k:g} [-]")
    axes[1].set_ylabel("W / (ρ$_b$ √g d$^{%g}$) [-]" % law)
    axes[1].set_xticks(D - k, [f"{each:.3g}" for each in D - k])
    axes[1].set_yticks(W, [f"{each:.3g}" for each in W])
    axes[1].minorticks_off()
    style.legend_on_top(axes[1], 1, "rate W and Beverloo's law")

    for rate, colour in zip(rates, colours):
        heights = [rate["height_over_D_first_half"], rate["height_over_D_second_half"]]
        values = np.array([rate["rate_first_half"], rate["rate_second_half"]]) / rate["rate"]
        axes[2].plot(heights, values, "o-", color=colour)
    axes[2].axhspan(0.95, 1.05, color="#eceef1", zorder=0)
    lowest, highest = axes[2].get_ylim()
    axes[2].set_ylim(min(lowest, 0.85), max(highest, 1.15))
    axes[2].set_xlabel("height of the bed / D [-]")
    axes[2].set_ylabel("rate / its mean [-]")
    axes[2].set_title("rate under a falling bed")
    style.legend_above(figure, axes[0], 3)
    return figure


def compare(run, path):
    s = run.summary
    law = s["exponent_of_the_law"]
    openings = [rate["opening_over_d"] for rate in s["rates"]]
    rows = []
    if len(openings) > 1:
        own_k = s["k_for_the_exponent_of_the_law"]
        if run.dimension == 2:
            rows.append((f"exponent of the rate over D − {s['k']:g} d, D/d = {min(openings):g} to "
                         f"{max(openings):g}", f"{s['exponent']:.3f}", f"{law:g} ± 0.15",
                         abs(s["exponent"] - law) <= 0.15))
        rows.append((f"k with which the exponent is {law:g}, D/d = {min(openings):g} to "
                     f"{max(openings):g}", f"{own_k:.2f}", "1 to 2", 1 <= own_k <= 2))
        if run.dimension == 3:
            C = coefficient(run, own_k)
            rows.append(("coefficient C with this k", f"{C:.3f}", "0.55 to 0.65",
                         0.55 <= C <= 0.65))
    rows.append(("change of the rate from the first to the second half of the flow",
                 f"{100 * s['largest_change_with_height']:.1f} %", "below 10 %",
                 s["largest_change_with_height"] < 0.1))
    lines = ["# Hopper", "", "After Beverloo, Leniger and van de Velde (1961): "
             "W = C ρ_b √g (D − k d)^n.", "", "| | measured | should be | |", "|---|---|---|---|"]
    lines += [f"| {what} | {value} | {wanted} | {'yes' if good else '**no**'} |"
              for what, value, wanted, good in rows]
    if run.dimension == 3 and len(openings) > 1:
        lines += ["", f"With k = {s['k']:g} the exponent is {s['exponent']:.3f}: openings of so few "
                  "diameters cannot tell k and the exponent apart."]
    lines += ["", f"{s['grains']} grains, {s['steps']} steps of discharge, "
              f"{s['wall_seconds']:.0f} s in all."]
    path.write_text("\n".join(lines) + "\n", encoding="utf-8")


def main(arguments):
    if len(arguments) != 1:
        sys.exit(__doc__)
    folder = pathlib.Path(arguments[0])
    if not (folder / "summary.json").exists():
        sys.exit(f"plot_hopper.py: {folder} has no summary.json; run hopper first")
    run = Run(folder)
    style.make(folder / "frames.png", draw_frames, run)
    style.make(folder / "discharge.png", draw_discharge, run)
    animate(run, folder / "discharge.gif")
    compare(run, folder / "comparison.md")


if __name__ == "__main__":
    main(sys.argv[1:])
