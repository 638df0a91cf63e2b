#!/usr/bin/env python3
# SPDX-License-Identifier: MIT
"""Draws the output of dam_break.

    plot_dam_break.py FOLDER

Writes frames.png, front.png, pressure.png, collapse.gif and comparison.md to FOLDER. The comparison
includes runs with the paper's schemes in the subfolders case_10 (--case 10) and case_00, if they
exist.
"""

import pathlib
import sys

sys.path.insert(0, str(pathlib.Path(__file__).resolve().parent))
from support import plot_style as style
from support.plot_style import BLUE, DARK, DASHED, GREEN, ORANGE, np, plt
from support.tanks import TanksWithFaces
from support.water import DENSITY, FRONT, G, HEIGHT, POTENTIAL_FLOW, REFERENCE, DamBreak, table

DASH_DOTTED = (0, (6, 2, 1, 2))
COLOURS = (BLUE, GREEN, ORANGE)
EXPERIMENT = "Martin & Moyce (1952), experiment"


def tanks(run, times):
    is_3d = run.options["dimension"] == 3
    return TanksWithFaces(run, times, *run.options["tank"],
                          run.options["depth"] / 2 if is_3d else None)


def draw_frames(run):
    times = [t for t in (0.1, 0.2, 0.3, 0.4, 0.5, 0.6) if t <= run.series.times[-1] + 1e-3]
    return tanks(run, times or [run.series.times[-1]]).figure(run.name)


def draw_front(runs):
    figure, axes = plt.subplots(1, 2, figsize=(style.WIDE, 4.6))
    if runs[0].is_martin_moyce():
        experiment, height = table(REFERENCE / FRONT), table(REFERENCE / HEIGHT)
        axes[0].plot(experiment["T"], experiment["Z"], "o", color=DARK, markersize=5,
                     label=EXPERIMENT)
        axes[1].plot(height["tau"], height["H"], "o", color=DARK, markersize=5)
        exact = table(REFERENCE / POTENTIAL_FLOW)
        of_exact = {"color": DARK, "linewidth": 1, "linestyle": DASHED, "zorder": 3}
        axes[0].plot(exact["T"], exact["Z"], label="potential flow, exact", **of_exact)
        axes[1].plot(exact["T"] / np.sqrt(2), exact["H"], **of_exact)
    for run, colour in zip(runs, COLOURS):
        T, Z = run.dimensionless_front()
        axes[1].plot(T / np.sqrt(2), run.dimensionless_height(), color=colour, linewidth=1.8)
        # The edge ends at the wall.
        T, Z = T[run.before_the_wall()], Z[run.before_the_wall()]
        axes[0].plot(T, Z, color=colour, linewidth=1.8, label=f"{run.name}, as computed")
        if shift := run.time_shift():
            axes[0].plot(T + shift, Z, color=colour, linewidth=1.4, linestyle=DASH_DOTTED,
                         label=f"{run.name}, shifted by {shift:.2f} in T")
    axes[0].set_xlim(0)
    axes[0].set_xlabel("T = t √(2g/a) [-]")
    axes[0].set_ylabel("Z = x/a [-]")
    axes[0].set_title("leading edge x; a: width of the column")
    axes[1].set_xlim(0)
    axes[1].set_ylim(0)
    axes[1].set_xlabel("τ = t √(g/a) [-]")
    axes[1].set_ylabel("H = height / initial height [-]")
    axes[1].set_title("height at the back wall, as computed")
    style.legend_above(figure, axes[0], 2)
    return figure


def draw_pressure(runs):
    figure, panels = plt.subplots(len(runs), 1, figsize=(style.WIDE, 0.6 + 2.6 * len(runs)),
                                  sharex=True, squeeze=False)
    panels = panels[:, 0]
    for axes, run, colour in zip(panels, runs, COLOURS):
        still = run.width * run.height / run.options["tank"][0]  # depth of the whole water at rest
        for number, name in enumerate(run.pressure.dtype.names[1:]):
            place = run.options["probes"][number]
            at = ", ".join(f"{x:g}" for x in place)
            curve, = axes.plot(run.pressure["t"], run.pressure[name] / 1e3, linewidth=0.7,
                               color=colour if number == 0 else None, label=f"gauge at ({at}) m")
            if still > place[-1]:
                axes.axhline(DENSITY * G * (still - place[-1]) / 1e3, linestyle=DASHED,
                             color=DARK if number == 0 else curve.get_color(), zorder=3,
                             label="the same under water at rest, ρ g h")
        title = run.name
        if (rough := run.roughness()) is not None:
            title += (f": rms deviation from the 0.02 s moving average {rough / 1e3:.2f} kPa "
                      "(t ≥ 0.4 s)")
        axes.set_ylabel("pressure [kPa]")
        axes.set_ylim(min(0, run.pressure["p_1"].min() / 1e3))
        style.legend_on_top(axes, title=title)
    panels[-1].set_xlabel("time [s]")
    panels[-1].set_xlim(0, runs[0].pressure["t"][-1])
    return figure


def animate(run, path):
    """The whole run, at most 60 frames."""
    tanks(run, np.linspace(0, run.series.times[-1], 60)).film(path, run.name, rate=15)


def of_front(run):
    """Rows that compare a run's leading edge and height with experiment and exact solution."""
    if not run.is_martin_moyce() or run.front_error() is None:
        return
    is_best = run.options["case"] == "recommended"
    yield (f"{run.name}: leading edge, rms deviation from Martin & Moyce (1952), T = 1.19–3.3, "
           f"shifted by {run.time_shift():.2f} in T", f"{100 * run.front_error():.1f} %",
           "≤ 3 %" if is_best else "≤ 6 %", run.front_error() <= (0.03 if is_best else 0.06))
    yield (f"{run.name}: the edge's speed dZ/dT over T = 1.5–2.9 after that shift, measured 1.28",
           f"{run.front_speed():.3f}", "1.28 ± 3 %" if is_best else "",
           abs(run.front_speed() / 1.28 - 1) <= 0.03 if is_best else None)
    yield (f"{run.name}: height at the back wall, rms deviation from Martin & Moyce, τ ≤ 2.5, as "
           "computed", f"{100 * run.height_error():.1f} %", "≤ 3 %" if is_best else "",
           run.height_error() <= 0.03 if is_best else None)
    edge, height = run.errors_of_potential_flow()
    yield (f"{run.name}: edge and height, rms deviation from the potential flow, T = 0.5–2.75, as "
           "computed", f"{100 * edge:.2f} %, {100 * height:.2f} %", "≤ 1 %" if is_best else "",
           max(edge, height) <= 0.01 if is_best else None)


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
    style.make(folder / "frames.png", draw_frames, run)
    style.make(folder / "front.png", draw_front, runs)
    style.make(folder / "pressure.png", draw_pressure, runs)
    animate(run, folder / "collapse.gif")
    compare(run, others, folder / "comparison.md")


if __name__ == "__main__":
    main(sys.argv[1:])
