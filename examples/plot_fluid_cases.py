#!/usr/bin/env python3
# SPDX-License-Identifier: MIT
"""Draws what fluid_cases wrote.

    plot_fluid_cases.py FOLDER

Makes frames.png and history.png in FOLDER, and comparison.md, the findings as a table.
"""

import json
import pathlib
import sys

import matplotlib

matplotlib.use("Agg")
import matplotlib.pyplot as plt
import numpy as np

HERE = pathlib.Path(__file__).resolve().parent
sys.path.insert(0, str(HERE))
from support.frames import Series, draw, speed

DENSITY = 1000.0
BLUE = "#1f6fb4"
ORANGE = "#d9822b"
DARK = "#20242a"

# Per case: the title; panels of the history, each a label and its curves, (column, what it is), of
# which the exact ones are dashed; what colours the frames.
CASES = {
    "taylor_green": ("Taylor–Green vortices, Re = 100", [
        ("rms velocity / that at first", [("speed", "computed"), ("speed_exact", "exact")]),
        ("largest empty circle [l0]", [("gap", "computed")]),
    ], "speed"),
    "standing_wave": ("standing wave", [
        ("elevation of the crest [m]", [("elevation", "computed"), ("elevation_exact", "exact")]),
    ], "pressure"),
    "oscillating_drop": ("oscillating drop", [
        ("semi-axes [m]", [("a", "along x"), ("b", "along y"), ("a_exact", "exact"),
                           ("b_exact", "exact")]),
        ("A [1/s]", [("rate", "computed"), ("rate_exact", "exact")]),
    ], "pressure"),
    "rotating_square": ("rotating square", [
        ("over that at first", [("angular_momentum", "angular momentum"),
                                ("energy", "kinetic energy"), ("whole", "largest body")]),
        ("pressure at the centre [ρ ω² L²]", [("pressure_centre", "computed")]),
    ], "pressure"),
    "falling_block": ("falling block", [
        ("fall [m]", [("fall", "computed"), ("fall_exact", "exact")]),
    ], "pressure"),
}


def draw_history(run, path):
    title, panels, _ = CASES[run["case"]]
    history = np.genfromtxt(run["folder"] / "history.csv", delimiter=",", names=True)
    figure, axes = plt.subplots(1, len(panels), figsize=(5.6 * len(panels), 3.6),
                                layout="constrained", squeeze=False)
    for each, (label, curves) in zip(axes[0], panels):
        colours = iter((BLUE, ORANGE, "#4b9b5f"))
        labelled = set()
        for column, name in curves:
            exact = column.endswith("_exact")
            each.plot(history["t"], history[column], label=None if name in labelled else name,
                      color=DARK if exact else next(colours), linewidth=1.0 if exact else 1.8,
                      linestyle=(0, (4, 2)) if exact else "-", zorder=3 if exact else 2)
            labelled.add(name)
        each.set_xlabel("time [s]")
        each.set_ylabel(label)
        each.legend(frameon=False, fontsize=9)
        each.grid(color="#eceef1", linewidth=0.8)
        each.spines[["top", "right"]].set_visible(False)
    figure.suptitle(f"{title}, {run['scheme']}, l0 = {run['spacing']:g} m", x=0.01, ha="left",
                    fontsize=11)
    figure.savefig(path, dpi=110)
    plt.close(figure)


def draw_frames(run, path):
    series = Series(run["folder"] / "frames.pvd")
    numbers = np.unique(np.linspace(0, len(series) - 1, 4).round().astype(int))
    frames = [series[number] for number in numbers]
    figure, axes = plt.subplots(1, len(frames), figsize=(3.4 * len(frames), 3.8),
                                layout="constrained", squeeze=False)
    by_speed = CASES[run["case"]][2] == "speed"
    values = [speed(frame) if by_speed else frame["pressure"] / 1e3 for frame in frames]
    # Behind the first step: before it there is no pressure yet.
    low, high = np.percentile(np.concatenate(values[1:] or values), [1, 99])
    for each, frame, colours, number in zip(axes[0], frames, values, numbers):
        circles = draw(each, frame, colours, radius=run["spacing"] / 2, cmap="viridis",
                       norm=plt.Normalize(low, max(high, low + 1e-12)))
        lower, upper = frame["position"].min(axis=0), frame["position"].max(axis=0)
        half = 0.53 * (upper - lower).max()
        middle = (lower + upper) / 2
        each.set_xlim(middle[0] - half, middle[0] + half)
        each.set_ylim(middle[1] - half, middle[1] + half)
        each.set_title(f"t = {series.times[number]:.2f} s", loc="left", fontsize=10)
        each.tick_params(labelsize=8)
    figure.colorbar(circles, ax=axes[0].tolist(), shrink=0.8,
                    label="speed [m/s]" if by_speed else "pressure [kPa]")
    figure.savefig(path, dpi=75)
    plt.close(figure)


def compare(run, path):
    lines = [f"# {CASES[run['case']][0]}, {run['scheme']}, l0 = {run['spacing']:g} m", "",
             "| quantity | reference | measured | error | allowed | |", "|---|---|---|---|---|---|"]
    for each in run["findings"]:
        limit = each["allowed"]
        allowed = "stated" if limit is None else f"{100 * limit:.2g} %"
        lines.append(f"| {each['quantity']} | {each['reference']:.5g} | {each['measured']:.5g} | "
                     f"{100 * each['error']:.2g} % | {allowed} | "
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
    draw_history(run, folder / "history.png")
    draw_frames(run, folder / "frames.png")
    compare(run, folder / "comparison.md")


if __name__ == "__main__":
    main(sys.argv[1:])
