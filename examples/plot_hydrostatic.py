#!/usr/bin/env python3
# SPDX-License-Identifier: MIT
"""Draws the output of hydrostatic.

    plot_hydrostatic.py FOLDER

Writes frames.png, pressure.png, profile.png and comparison.md to FOLDER.
"""

import pathlib
import sys

sys.path.insert(0, str(pathlib.Path(__file__).resolve().parent))
from support import plot_style as style
from support.plot_style import BLUE, DARK, DASHED, ORANGE, plt
from support.tanks import TanksWithFaces
from support.water import DENSITY, G, NAMES, Tank


def scheme(run):
    """Description of the scheme."""
    o = run.options
    if o["scheme"] == "recommended":
        return NAMES["recommended"]
    a, b = o["collision"]
    surface = {"both": "(13) and (17)"}.get(o["surface"], f"({o['surface']})")
    return (f"source ({o['source']}), kernel ({o['kernel']}), a = {a:g}, b = {b:g}, surface "
            f"{surface}, gradient ({o['gradient']})")


def draw_frames(run):
    o = run.options
    end = run.series.times[-1]
    tanks = TanksWithFaces(run, [0, end / 2, end], o["width"], 1.5 * o["depth"],
                           o["thickness"] / 2 if o["dimension"] == 3 else None)
    return tanks.figure(scheme(run))


def draw_pressure(run):
    """The gauges, each with its hydrostatic pressure."""
    figure, axes = plt.subplots(figsize=(style.WIDE, 3.8))
    highest = 0
    for number, name in enumerate(run.pressure.dtype.names[1:]):
        place = run.options["probes"][number]
        at = ", ".join(f"{x:g}" for x in place)
        curve, = axes.plot(run.pressure["t"], run.pressure[name] / 1e3, linewidth=0.7,
                           label=f"gauge at ({at}) m")
        still = DENSITY * G * (run.summary["still_depth"] - place[-1]) / 1e3
        axes.axhline(still, color=DARK if number == 0 else curve.get_color(), linewidth=1.2,
                     linestyle=DASHED, zorder=3,
                     label="ρ g h under the still surface" if number == 0 else None)
        highest = max(highest, still)
    title = scheme(run)
    if run.summary["rer"] is not None:
        title += (f"\nfirst gauge: mean {100 * run.summary['rer']:+.2f} % off (RER), standard "
                  f"deviation {100 * run.summary['std_over_mean']:.2f} % of the mean")
    axes.set_title(title)
    # During the initial settling, the pressure may be much higher.
    settled = run.pressure[run.pressure["t"] > 0.05 * run.end()]
    top = max([highest, *(settled[name].max() / 1e3 for name in settled.dtype.names[1:])])
    axes.set_ylim(0, 1.15 * top)
    axes.set_xlim(0, run.end())
    axes.set_xlabel("time [s]")
    axes.set_ylabel("pressure [kPa]")
    style.legend_above(figure, axes, 4)
    return figure


def draw_profile(run):
    figure, axes = plt.subplots(figsize=(style.NARROW, 5.2))
    profile = run.profile
    bottom = run.summary["still_depth"]
    axes.fill_betweenx(profile["depth"], (profile["p_mean"] - profile["p_std"]) / 1e3,
                       (profile["p_mean"] + profile["p_std"]) / 1e3, color=BLUE, alpha=0.25,
                       linewidth=0, label="± one standard deviation")
    axes.plot(profile["p_mean"] / 1e3, profile["depth"], "o-", color=BLUE, markersize=3,
              linewidth=1, label="fluid, mean of a layer")
    # In the paper's schemes, P = 0 holds at the centres of the surface particles.
    is_best = run.options["scheme"] == "recommended"
    surface = 0 if is_best else run.options["spacing"] / 2
    axes.plot([0, DENSITY * G * (bottom - surface) / 1e3], [surface, bottom], color=DARK,
              linewidth=1.2, linestyle=DASHED,
              label="ρ g z, exact" if is_best else "ρ g (z − l0/2), exact")
    gauge = run.options["probes"][0]
    axes.plot(run.summary["mean"] / 1e3, bottom - gauge[-1], "s", color=ORANGE,
              label="first gauge, mean")
    axes.set_ylim(1.02 * bottom, 0)
    axes.set_xlim(0, None)
    axes.set_xlabel("pressure [kPa]")
    axes.set_ylabel("depth z below the still surface [m]")
    axes.legend()
    axes.set_title(scheme(run))
    return figure


def compare(run, path):
    s = run.summary
    rows = [("relative error of the mean at the first gauge, RER (14)", f"{100 * s['rer']:+.3g} %"),
            ("its standard deviation over its mean", f"{100 * s['std_over_mean']:.3g} %"),
            ("level at the end over that at the beginning",
             f"{100 * (s['level'] / s['still_depth'] - 1):+.2f} %"),
            ("particles lost", s["particles_lost"])]
    if line := run.line():
        slope, zero, off = line
        rows += [("slope of the profile's straight line over ρ g", f"{slope:.4f}"),
                 ("depth at which that line is zero, in spacings",
                  f"{zero / run.options['spacing']:.2f}"),
                 ("largest distance of a layer from it, over ρ g h",
                  f"{100 * off / (DENSITY * G * s['still_depth']):.2f} %")]
    lines = ["# Still tank", "", f"After [HwangLeePark2010], Figs 4–9; {scheme(run)}; radii "
             f"{run.options['radius']:g} and {run.options['laplacian_radius']:g} l0; from "
             f"{run.options['statistics_from']:g} s to {s['time_simulated']:g} s.", "",
             "| | measured |", "|---|---|", *(f"| {what} | {value} |" for what, value in rows), "",
             f"{s['fluid_particles']} fluid, {s['wall_particles']} wall and "
             f"{s['dummy_particles']} dummy particles, {s['steps']} steps in "
             f"{s['seconds_total']:.1f} s of wall-clock time "
             f"({s['solver_iterations_mean']:.0f} iterations a step)."]
    path.write_text("\n".join(lines) + "\n", encoding="utf-8")


def main(arguments):
    if len(arguments) != 1:
        sys.exit(__doc__)
    folder = pathlib.Path(arguments[0])
    run = Tank.there(folder)
    if run is None:
        sys.exit(f"plot_hydrostatic.py: {folder} has no summary.json; run hydrostatic first")
    style.make(folder / "frames.png", draw_frames, run)
    style.make(folder / "pressure.png", draw_pressure, run)
    if run.summary["rer"] is None:
        print("plot_hydrostatic.py: the run was too short for a profile and a comparison")
        return
    style.make(folder / "profile.png", draw_profile, run)
    compare(run, folder / "comparison.md")


if __name__ == "__main__":
    main(sys.argv[1:])
