#!/usr/bin/env python3
# SPDX-License-Identifier: MIT
"""Draws what dam_break wrote.

    plot_dam_break.py FOLDER

Makes frames.png, front.png, pressure.png, collapse.gif and comparison.md in FOLDER. Runs of the paper's
schemes in the subfolders case_10 (--case 10) and case_00 are compared with it, where they are there.
"""

import pathlib
import sys

import matplotlib

matplotlib.use("Agg")
import matplotlib.pyplot as plt
import numpy as np
from matplotlib.animation import FuncAnimation, PillowWriter

sys.path.insert(0, str(pathlib.Path(__file__).resolve().parent))
from support import water
from support.water import (BLUE, DARK, DENSITY, FRONT, G, HEIGHT, ORANGE, POTENTIAL_FLOW, REFERENCE,
                           DamBreak, table, tidy)

COLOURS = (BLUE, "#8a8f98", ORANGE)


def show(axes, run, frame, top):
    is_3d = run.options["dimension"] == 3
    return water.draw_water(axes, frame, run.options["spacing"], run.options["tank"][0], top,
                            DENSITY * G * run.height / 1e3,
                            run.options["depth"] / 2 if is_3d else None)


def draw_frames(run, path):
    end = run.series.times[-1]
    times = [t for t in (0.0, 0.1, 0.2, 0.3, 0.4, 0.5, 0.6, 0.8, 1.0) if t <= end + 1e-3]
    top = 1.35 * run.height
    water.draw_frames(run.series, times, lambda axes, frame: show(axes, run, frame, top),
                      top / run.options["tank"][0], path)


def draw_front(runs, path):
    figure, axes = plt.subplots(1, 2, figsize=(11, 4.6), layout="constrained")
    if runs[0].is_martin_moyce():
        experiment = table(REFERENCE / FRONT)
        axes[0].plot(experiment["T"], experiment["Z"], "o", color=DARK, markersize=5,
                     label="Martin & Moyce 1952, n² = 2")
        height = table(REFERENCE / HEIGHT)
        axes[1].plot(height["tau"], height["H"], "o", color=DARK, markersize=5,
                     label="Martin & Moyce 1952, n² = 2")
        exact = table(REFERENCE / POTENTIAL_FLOW)
        axes[0].plot(exact["T"], exact["Z"], color=DARK, linewidth=0.9, label="potential flow")
        axes[1].plot(exact["T"] / np.sqrt(2), exact["H"], color=DARK, linewidth=0.9,
                     label="potential flow")
    for run, colour in zip(runs, COLOURS):
        T, Z = run.dimensionless_front()
        shift = run.time_shift() or 0
        axes[0].plot(T + shift, Z, color=colour, linewidth=1.8,
                     label=f"{run.name}, shifted by {shift:.2f}")
        axes[0].plot(T, Z, color=colour, linewidth=0.9, linestyle=(0, (2, 2)),
                     label=f"{run.name} as computed")
        axes[1].plot(T / np.sqrt(2), run.dimensionless_height(), color=colour, linewidth=1.8,
                     label=f"{run.name} as computed")
    axes[0].set_xlim(0, 4.2)
    axes[0].set_ylim(0.9, 4.4)
    axes[0].set_xlabel("T = t √(2g/a)")
    axes[0].set_ylabel("Z = x/a")
    axes[0].set_title("leading edge", loc="left", fontsize=11)
    axes[1].set_xlim(0, 4.5)
    axes[1].set_ylim(0, 1.1)
    axes[1].set_xlabel("τ = t √(g/a)")
    axes[1].set_ylabel("H = height / 2a")
    axes[1].set_title("height at the back wall", loc="left", fontsize=11)
    for each in axes:
        each.legend(frameon=False, fontsize=9)
    tidy(axes)
    figure.savefig(path, dpi=130)
    plt.close(figure)


def draw_pressure(runs, path):
    figure, panels = plt.subplots(len(runs), 1, figsize=(10.5, 0.6 + 2.9 * len(runs)), sharex=True,
                                  layout="constrained", squeeze=False)
    panels = panels[:, 0]
    top = max(np.percentile(run.pressure["p_1"], 99.7) / 1e3 for run in runs)
    for axes, run, colour in zip(panels, runs, COLOURS):
        gauges = run.pressure.dtype.names[1:]
        for number, name in enumerate(gauges):
            at = ", ".join(f"{x:g}" for x in run.options["probes"][number])
            axes.plot(run.pressure["t"], run.pressure[name] / 1e3, linewidth=0.8,
                      color=colour if number == 0 else None, label=f"gauge at ({at}) m")
        title = run.name + {0: ", the original MPS", 10: ", PNU-MPS"}.get(run.options["case"], "")
        if (rough := run.roughness()) is not None:
            title += f": high-passed rms {rough / 1e3:.2f} kPa from 0.4 s on"
        axes.set_title(title, loc="left", fontsize=11)
        axes.set_ylabel("pressure [kPa]")
        axes.legend(frameon=False, fontsize=9, loc="upper left")
        axes.set_ylim(0, 1.05 * max(top, 1))
    panels[-1].set_xlabel("time [s]")
    panels[-1].set_xlim(0, runs[0].pressure["t"][-1])
    tidy(panels)
    figure.savefig(path, dpi=130)
    plt.close(figure)


def animate(run, path):
    """The whole run, at most 60 frames."""
    numbers = np.unique(np.linspace(0, len(run.series) - 1, 60).round().astype(int))
    series = run.series
    top = 1.35 * run.height
    width = run.options["tank"][0]
    figure = plt.figure(figsize=(5.6, 5.6 * (top + 0.03) / (width + 0.04)), dpi=80)
    axes = figure.add_axes((0, 0, 1, 1))

    def show_number(number):
        axes.clear()
        show(axes, run, series[number], top)
        axes.text(0.97, 0.93, f"t = {series.times[number]:.2f} s", fontsize=12, ha="right",
                  transform=axes.transAxes)

    FuncAnimation(figure, show_number, frames=numbers).save(path, writer=PillowWriter(fps=15))
    plt.close(figure)


def of_front(run):
    """Rows that hold a run's leading edge and height against experiment and exact solution."""
    if not run.is_martin_moyce() or run.front_error() is None:
        return
    is_best = run.name == "recommended"
    yield (f"{run.name}: leading edge, rms deviation from Martin & Moyce (1952), T = 1.19–3.3, time "
           f"shifted by {run.time_shift():.2f}", f"{100 * run.front_error():.1f} %",
           "≤ 2 %" if is_best else "≤ 6 %", run.front_error() <= (0.02 if is_best else 0.06))
    yield (f"{run.name}: the edge's speed dZ/dT over T = 1.5–2.9 of that time, measured 1.28",
           f"{run.front_speed():.3f}", "1.28 ± 3 %" if is_best else "",
           abs(run.front_speed() / 1.28 - 1) <= 0.03 if is_best else None)
    yield (f"{run.name}: height at the back wall, rms deviation from Martin & Moyce, τ ≤ 2.5, as "
           "computed", f"{100 * run.height_error():.1f} %", "≤ 2 %" if is_best else "",
           run.height_error() <= 0.02 if is_best else None)
    edge, height = run.errors_of_potential_flow()
    yield (f"{run.name}: edge and height, rms deviation from the potential flow, T = 0.5–2.75, as "
           "computed", f"{100 * edge:.2f} %, {100 * height:.2f} %", "≤ 1.5 %" if is_best else "",
           max(edge, height) <= 0.015 if is_best else None)


def compare(run, others, path):
    rows = list(of_front(run))
    lost = run.summary["particles_lost"]
    rows.append((f"{run.name}: particles lost", lost, "0", lost == 0))
    for other in others:
        rows += of_front(other)
        rows.append((f"{other.name}: particles lost", other.summary["particles_lost"], "", None))
        end = min(run.end(), other.end())
        if run.roughness(end=end) and other.roughness(end=end):
            rows.append((f"high-passed rms at the first gauge from 0.4 s to {end:.2f} s: {run.name}, "
                         f"{other.name}", f"{run.roughness(end=end) / 1e3:.2f}, "
                         f"{other.roughness(end=end) / 1e3:.2f} kPa", "", None))
    if len(others) == 2 and all(other.front_error() is not None for other in others):
        lead = others[0].behind(others[1])
        rows.append((f"{others[1].name} is ahead of {others[0].name} by, in T", f"{lead:.3f}", "> 0",
                     lead > 0))
    s = run.summary
    lines = [f"# Dam break, {run.name}", "",
             "After [HwangLeePark2010], Figs 12–14; radii "
             f"{run.options['radius']:g} and {run.options['laplacian_radius']:g} l0.", "",
             "| | measured | must be | |", "|---|---|---|---|"]
    lines += [f"| {what} | {value} | {wanted} | "
              f"{'' if good is None else 'yes' if good else '**no**'} |"
              for what, value, wanted, good in rows]
    lines += ["", f"{s['fluid_particles']} fluid, {s['wall_particles']} wall and {s['dummy_particles']} "
              "dummy particles, "
              f"{s['steps']} steps to {s['time_simulated']:.2f} s in {s['seconds_total']:.1f} s: "
              f"{s['seconds_search']:.1f} s for the search, {s['seconds_pressure']:.1f} s for the "
              f"pressure ({s['solver_iterations_mean']:.0f} iterations a step)."]
    path.write_text("\n".join(lines) + "\n", encoding="utf-8")


def main(arguments):
    if len(arguments) != 1:
        sys.exit(__doc__)
    folder = pathlib.Path(arguments[0])
    if not (folder / "summary.json").exists():
        sys.exit(f"plot_dam_break.py: {folder} has no summary.json; run dam_break first")
    run = DamBreak(folder)
    others = [other for name in ("case_10", "case_00") if (other := DamBreak.there(folder / name))]
    runs = [run, *others]
    draw_frames(run, folder / "frames.png")
    draw_front(runs, folder / "front.png")
    draw_pressure(runs, folder / "pressure.png")
    animate(run, folder / "collapse.gif")
    compare(run, others, folder / "comparison.md")


if __name__ == "__main__":
    main(sys.argv[1:])
