#!/usr/bin/env python3
# SPDX-License-Identifier: MIT
"""Draws the output of fluid_cases.

    plot_fluid_cases.py FOLDER

Writes frames.png, history.png and comparison.md, the findings as a table, to FOLDER.
"""

import json
import pathlib
import sys

sys.path.insert(0, str(pathlib.Path(__file__).resolve().parent))
from support import plot_style as style
from support.frames import Series, draw, speed
from support.plot_style import DARK, DASHED, np, plt

SCHEMES = {"recommended": "Silt, recommended scheme",
           "wall_particles": "Silt, scheme for wall particles", "case10": "Case 10 (PNU-MPS)"}

# Per case: the title; panels of the history, each with a label and curves (column, caption), of
# which the exact ones are dashed; the quantity that colours the frames.
CASES = {
    "taylor_green": ("Taylor–Green vortices, Re = 100", [
        ("rms velocity / initial value [-]", [("speed", "computed"), ("speed_exact", "exact")]),
        ("radius of the largest\nempty circle / spacing [-]", [("gap", "computed")]),
    ], "speed"),
    "standing_wave": ("Standing wave", [
        ("elevation of the crest [m]", [("elevation", "computed"), ("elevation_exact", "exact")]),
    ], "pressure"),
    "oscillating_drop": ("Oscillating drop", [
        ("semi-axes [m]", [("a", "along x"), ("b", "along y"), ("a_exact", "exact"),
                           ("b_exact", "exact")]),
        ("strain rate A [s⁻¹]", [("rate", "computed"), ("rate_exact", "exact")]),
    ], "pressure"),
    "rotating_square": ("Rotating square", [
        ("ratio to the initial value [-]", [("angular_momentum", "angular momentum"),
                                ("energy", "kinetic energy"), ("whole", "fluid in one body")]),
        ("pressure at the centre / ρ ω² L² [-]", [("pressure_centre", "computed")]),
    ], "pressure"),
    "falling_block": ("Falling block", [
        ("fall [m]", [("fall", "computed"), ("fall_exact", "exact")]),
    ], "pressure"),
}


def name_of(run):
    return f"{CASES[run['case']][0]} ({SCHEMES[run['scheme']]}, spacing {run['spacing']:g} m)"


def draw_history(run):
    _, panels, _ = CASES[run["case"]]
    history = np.genfromtxt(run["folder"] / "history.csv", delimiter=",", names=True)
    figure, axes = plt.subplots(1, len(panels), figsize=(style.WIDE, 3.6), squeeze=False)
    for each, (label, curves) in zip(axes[0], panels):
        colours = iter(style.CURVES)
        labelled = set()
        for column, name in curves:
            exact = column.endswith("_exact")
            each.plot(history["t"], history[column], label=None if name in labelled else name,
                      color=DARK if exact else next(colours), linewidth=1.0 if exact else 1.6,
                      linestyle=DASHED if exact else "-", zorder=3 if exact else 2)
            labelled.add(name)
        each.set_xlabel("time [s]")
        each.set_ylabel(label)
        style.legend_on_top(each, 2)
    figure.suptitle(name_of(run), x=0.01, ha="left")
    return figure


def draw_frames(run):
    series = Series(run["folder"] / "frames.pvd")
    numbers = np.unique(np.linspace(0, len(series) - 1, 4).round().astype(int))
    frames = [series[number] for number in numbers]
    figure, panels = plt.subplots(2, 2, figsize=(style.WIDE, 7.6), squeeze=False)
    by_speed = CASES[run["case"]][2] == "speed"
    values = [speed(frame) if by_speed else frame["pressure"] for frame in frames]
    # The pressure of the first frame is not yet computed.
    coloured = values if by_speed else values[1:] or values
    limits = style.range_of(coloured, *([0] if by_speed else []))
    widths = [1.06 * np.ptp(frame["position"], axis=0).max() for frame in frames]
    notes = []
    if scales_differ := max(widths) > 2 * min(widths):
        notes.append("the scales of the panels differ")
    else:
        widths = [max(widths)] * len(widths)
    for axes, frame, colours, number, width in zip(panels.flat, frames, values, numbers, widths):
        lower, upper = frame["position"].min(axis=0), frame["position"].max(axis=0)
        half = width / 2
        x, y = ((middle - half, middle + half) for middle in ((lower + upper) / 2)[:2])
        # Large enough to be visible if the fluid has spread far.
        circles = draw(axes, frame, colours, radius=max(run["spacing"] / 2, 0.007 * half),
                       cmap=style.SPEED if by_speed else style.PRESSURE,
                       norm=plt.Normalize(*limits))
        title = f"t = {series.times[number]:.2f} s"
        if scales_differ:
            title += f", panel {width:#.2g} m wide"
        if number == 0 and not by_speed:
            circles.set(array=None, facecolor=style.GREY)
            notes.append("grey: pressure not yet computed")
        axes.set(xlim=x, ylim=y, aspect="equal", title=title, xlabel="x [m]", ylabel="y [m]")
        axes.grid(False)
    for axes in panels.flat[len(frames):]:
        axes.remove()
    figure.suptitle(name_of(run) + ("\n" + "; ".join(notes) if notes else ""), x=0.01, ha="left")
    style.bar_of(figure, circles, panels.flat[:len(frames)],
                 "speed [m/s]" if by_speed else "pressure [Pa]", values[1:] or values, shrink=0.7,
                 aspect=35)
    return figure


def compare(run, path):
    lines = [f"# {CASES[run['case']][0]}, {run['scheme']}, l0 = {run['spacing']:g} m", "",
             "| quantity | reference | measured | error | allowed | |", "|---|---|---|---|---|---|"]
    for each in run["findings"]:
        measured, error = "–", "–"
        if each["measured"] is not None:  # as it is if, for example, there are too few periods
            measured, error = f"{each['measured']:.5g}", f"{100 * each['error']:.2g} %"
        limit = each["allowed"]
        allowed = "stated" if limit is None else f"{100 * limit:.2g} %"
        lines.append(f"| {each['quantity']} | {each['reference']:.5g} | {measured} | "
                     f"{error} | {allowed} | "
                     f"{'' if allowed == 'stated' else 'holds' if each['holds'] else '**no**'} |")
    path.write_text("\n".join(lines) + "\n", encoding="utf-8")


def main(arguments):
    if len(arguments) != 1:
        sys.exit(__doc__)
    folder = pathlib.Path(arguments[0])
    if not (folder / "summary.json").exists():
        sys.exit(f"plot_fluid_cases.py: {folder} has no summary.json; run fluid_cases first")
    summary = json.loads((folder / "summary.json").read_text())
    run = summary["options"] | {"folder": folder, "findings": summary["findings"]}
    style.make(folder / "history.png", draw_history, run)
    style.make(folder / "frames.png", draw_frames, run)
    compare(run, folder / "comparison.md")


if __name__ == "__main__":
    main(sys.argv[1:])
