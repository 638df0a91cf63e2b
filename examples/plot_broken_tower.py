#!/usr/bin/env python3
# SPDX-License-Identifier: MIT
"""Draws what broken_tower wrote.

    plot_broken_tower.py FOLDER

Makes frames.png, figures_9_10.png, energy.png, wave.png, spreading.png, collapse.gif and
comparison.md in FOLDER. Runs in the subfolders undamped (--alpha 0), symmetric (--offset 0),
frictionless (--friction-angle 0) and wave_* (of other stiffness, density or height) are compared
with it, where they are there.
"""

import json
import pathlib
import sys

import matplotlib

matplotlib.use("Agg")
import matplotlib.pyplot as plt
import numpy as np
from matplotlib.animation import FuncAnimation, PillowWriter
from matplotlib.colors import LinearSegmentedColormap

sys.path.insert(0, str(pathlib.Path(__file__).resolve().parent))
from support.frames import Series, draw, speed

GREY = "#8a9099"
RED = "#b3261e"


class Run:
    """One output folder."""

    def __init__(self, folder):
        self.summary = json.loads((folder / "summary.json").read_text())
        self.options = self.summary["options"]
        self.series = Series(folder / "frames.pvd")
        self.energy = np.genfromtxt(folder / "energy.csv", delimiter=",", names=True)
        self.floor = np.genfromtxt(folder / "floor.csv", delimiter=",", names=True)
        self.spreading = np.genfromtxt(folder / "spreading.csv", delimiter=",", names=True)
        self.name = folder.name

    @classmethod
    def there(cls, folder):
        return cls(folder) if (folder / "summary.json").exists() else None

    def frame(self, number):
        """Of spheres the ones behind come first, so that those in front are drawn over them."""
        frame = self.series[number]
        if self.options["dimension"] == 2:
            return frame
        order = np.argsort(frame["position"][:, 2], kind="stable")
        return {name: values[order] for name, values in frame.items()}

    @property
    def height(self):
        return 2 * self.options["radius"] * self.options["rows"]

    @property
    def damping(self):
        alpha = self.options["alpha"]
        return f"global damping α = {alpha:g} 1/s" if alpha else "no global damping"


def view(axes, run, half_width, height):
    """Floor, limits, no clutter."""
    axes.set_xlim(-half_width, half_width)
    axes.set_ylim(-0.05 * height, height)
    axes.axhspan(-height, 0, color="#e7e3dc", zorder=0)
    axes.axhline(0, color="#5b5348", linewidth=0.8)
    axes.set_xticks([])
    axes.set_yticks([])
    for side in axes.spines.values():
        side.set_visible(False)


def colours(run):
    """Sand at rest, hot when fast; up to the speed of a free fall from half the height."""
    top = run.height
    heat = LinearSegmentedColormap.from_list(
        "heat", ["#ddd6c8", "#f3cf6b", "#ee8434", "#c8313c", "#6a1247"])
    return {"cmap": heat, "norm": plt.Normalize(0, np.sqrt(9.81 * top))}


def thin(run, half, inches, most):
    """Width of a grain's outline [points] on a panel so wide: thinner where grains are small."""
    diameter = 72 * inches * 2 * run.options["radius"] / (2 * half)
    return min(most, 0.07 * diameter)


def draw_frames(run, undamped, path):
    """Eight moments of the collapse; below them the end, with and without global damping."""
    top = run.height + run.options["drop_height"]
    fall = np.sqrt(2 * run.height / 9.81)
    times = [0, *(run.summary["landing_time"] + fall * (0.37 + 0.2 * np.arange(7)))]
    times = [t for t in times if t <= run.series.times[-1]]
    ends = [each for each in (run, undamped) if each]
    figure = plt.figure(figsize=(11, 5.9 + 0.85 * len(ends)))
    upper, lower = figure.subfigures(2, 1, height_ratios=[5.9, 0.85 * len(ends)])

    panels = upper.subplots(2, 4)
    upper.subplots_adjust(left=0.01, right=0.915, bottom=0.02, top=0.95, wspace=0.04, hspace=0.14)
    for axes in panels.flat:
        axes.set_axis_off()
    for axes, time in zip(panels.flat, times):
        axes.set_axis_on()
        frame = run.frame(run.series.nearest(time))
        view(axes, run, 0.64 * top, 1.06 * top)
        edge = thin(run, 0.64 * top, 2.4, 0.3)
        circles = draw(axes, frame, speed(frame), edge=edge, **colours(run))
        axes.set_title(f"t = {time:.1f} s", fontsize=11, loc="left")
    bar = upper.colorbar(circles, cax=upper.add_axes((0.93, 0.2, 0.013, 0.6)), extend="max")
    bar.set_label("speed [m/s]")
    bar.outline.set_visible(False)

    half = 1.03 * max(each.summary["farthest"] for each in ends)
    for each in ends:  # strips so long that the heap fits in
        heights = each.series[len(each.series) - 1]["position"][:, 1]
        half = max(half, (np.percentile(heights, 99.8) + 2 * each.options["radius"]) / 0.075)
    strips = np.atleast_1d(lower.subplots(len(ends), 1))
    lower.subplots_adjust(left=0.01, right=0.99, bottom=0.03, top=0.8, hspace=0.9)
    for axes, each in zip(strips, ends):
        frame = each.frame(len(each.series) - 1)
        view(axes, each, half, 0.075 * half)
        draw(axes, frame, speed(frame), edge=thin(run, half, 10.8, 0.15), **colours(run))
        limit = 2 * each.summary["pile_radius"]
        axes.vlines([-limit, limit], 0, 0.075 * half, color=RED, linewidth=1,
                    linestyle=(0, (4, 2)))
        x = frame["position"]
        gone = x[np.hypot(x[:, 0], x[:, 2]) > limit]
        axes.plot(gone[:, 0], gone[:, 1] + 0.025 * half, "v", color=RED, markersize=5)
        axes.set_title(f"t = {each.series.times[-1]:.1f} s, {each.damping}: "
                       f"{each.summary['escaped']} of {each.summary['particles']} grains have "
                       f"escaped beyond twice the radius that holds 95 % (dashed)",
                       fontsize=10, loc="left")
    figure.savefig(path, dpi=150)
    plt.close(figure)


def draw_figures(run, undamped, path):
    """The same moments of both runs beside one another, as the paper's Figs 9 and 10."""
    fall = np.sqrt(2 * run.height / 9.81)
    begin = run.summary["landing_time"]
    last = min(run.series.times[-1], undamped.series.times[-1])
    times = [t for t in begin + fall * np.array([0.4, 0.8, 1.2, 1.8, 2.8]) if t < last] + [last]
    half = max(0.7 * run.height,
               1.1 * max(each.spreading["half_width"].max() for each in (run, undamped)))
    rows = [[each.frame(each.series.nearest(t)) for each in (run, undamped)] for t in times]
    tops = [1.08 * max(np.percentile(frame["position"][:, 1], 99.8) for frame in row)
            + 2 * run.options["radius"] for row in rows]
    wide = 11
    tall = [wide / 2 * 1.05 * top / (2 * half) + 0.3 for top in tops]
    figure, panels = plt.subplots(len(times), 2, figsize=(wide, sum(tall) + 0.3),
                                  height_ratios=tall, layout="constrained")
    for row, top, time, pair in zip(rows, tops, times, panels):
        for frame, each, axes in zip(row, (run, undamped), pair):
            view(axes, each, half, top)
            draw(axes, frame, speed(frame), edge=thin(run, half, wide / 2, 0.2), **colours(run))
            axes.set_title(f"t = {time:.2f} s", fontsize=10, loc="left")
    for axes, each, number in zip(panels[0], (run, undamped), (9, 10)):
        axes.set_title(f"after Fig. {number}: {each.damping}", fontsize=11, loc="right")
    figure.savefig(path, dpi=150)
    plt.close(figure)


def tidy(axes):
    axes.grid(color="#eceef1", linewidth=0.8)
    axes.set_axisbelow(True)
    axes.spines[["top", "right"]].set_visible(False)


def describe(run):
    o = run.options
    return f"k = {o['normal_stiffness']:g} N/m, ρ = {o['density']:g} kg/m³, {o['rows']} layers"


def draw_wave(runs, path):
    """The force on the floor after the landing, and when the disturbance arrives there."""
    runs = [each for each in runs if each.summary["wave_arrival"]]
    if not runs:
        return
    figure, axes = plt.subplots(1, 3, figsize=(13, 4.2), layout="constrained")
    marks = ["#20242a", "#d9822b", "#2b6cb0", "#3a9d5d", "#8e5bb5", "#b3261e"]
    longest = 0
    for each, colour in zip(runs, marks):
        s, o = each.summary, each.options
        t = each.floor["t"]
        weight = s["grain_weight"] * (s["particles"] - 1)
        force = (each.floor["over_weight"] - 1) * weight / s["grain_weight"]
        axes[0].plot(1e3 * t, force, color=colour, linewidth=1, label=describe(each))
        axes[0].plot(1e3 * s["wave_arrival"], s["floor_peak_over_grain_weight"] / 2, "o",
                     color=colour)
        axes[1].plot(t / (o["rows"] * s["time_a_layer"]),
                     force / s["floor_peak_over_grain_weight"], color=colour, linewidth=1)
        layers = o["rows"] * s["time_a_layer"]
        longest = max(longest, layers)
        axes[2].plot(1e3 * layers, 1e3 * s["wave_arrival"], "o", color=colour, markersize=8)
    peak = max(each.summary["floor_peak_over_grain_weight"] for each in runs)
    axes[0].set_ylim(-0.35 * peak, 1.1 * peak)
    axes[0].set_xlabel("time since the landing [ms]")
    axes[0].set_ylabel("rise of the force on the floor / weight of a grain [-]")
    axes[0].legend(frameon=False, fontsize=8, loc="upper right")
    axes[0].set_title("the disturbance arrives (half its peak: dots)", loc="left", fontsize=11)
    axes[1].axvline(1, color=GREY, linewidth=0.8)
    axes[1].set_xlim(0, 2)
    axes[1].set_ylim(-0.35, 1.1)
    axes[1].set_xlabel("time / (layers · √(m/k)) [-]")
    axes[1].set_ylabel("rise / peak [-]")
    axes[1].set_title("in times of a chain of masses and springs", loc="left", fontsize=11)
    axes[2].plot([0, 1.1e3 * longest], [0, 1.1e3 * longest], color=GREY, linewidth=1,
                 label="layers · √(m/k)")
    axes[2].set_xlabel("layers · √(m/k) [ms]")
    axes[2].set_ylabel("arrival [ms]")
    axes[2].legend(frameon=False, fontsize=9)
    axes[2].set_title("arrival at the floor", loc="left", fontsize=11)
    for each in axes:
        tidy(each)
    figure.savefig(path, dpi=150)
    plt.close(figure)


def draw_spreading(run, undamped, path):
    """How the lowest layer and the heap spread along the floor."""
    figure, axes = plt.subplots(1, 3, figsize=(13, 4), layout="constrained")
    for each, colour in ((run, "#d9822b"), (undamped, "#2b6cb0")):
        if not each:
            continue
        rows = each.spreading
        for panel, name in zip(axes, ("basal_front", "half_width", "basal_moved")):
            panel.plot(rows["t"], rows[name], color=colour, linewidth=1.5, label=each.damping)
    begin = run.summary["landing_time"]
    start = run.spreading["basal_front"][0]
    speed_of_fall = np.sqrt(2 * 9.81 * run.height)
    t = np.linspace(begin, run.spreading["t"][-1])
    top = 1.05 * axes[0].get_ylim()[1]
    axes[0].plot(t, start + speed_of_fall * (t - begin), color=GREY, linewidth=1,
                 linestyle=(0, (4, 2)), label="√(2 g h₀)")
    axes[0].set_ylim(0, top)
    axes[0].set_ylabel("outermost grain of the lowest layer [m]")
    axes[1].set_ylabel("half width of the heap, 95 % of the grains [m]")
    axes[1].set_ylim(0)
    axes[2].set_ylabel("share of the lowest layer that moved by R [-]")
    for panel in axes:
        panel.set_xlabel("time [s]")
        panel.legend(frameon=False, fontsize=9)
        tidy(panel)
    figure.savefig(path, dpi=150)
    plt.close(figure)


def draw_energy(run, undamped, path):
    figure, axes = plt.subplots(2, 2, figsize=(10.5, 6.6), layout="constrained", sharex="col")
    energy = run.energy
    t = energy["t"]
    weight = run.summary["particles"] * run.summary["grain_weight"]

    parts = {"potential": "#2b6cb0", "kinetic": "#d9822b", "rotational": "#3a9d5d",
             "elastic": "#8e5bb5"}
    total = sum(energy[part] for part in parts)
    axes[0, 0].plot(t, total / 1e3, color="#20242a", linewidth=1.6, label="sum")
    for part, colour in parts.items():
        axes[0, 0].plot(t, energy[part] / 1e3, color=colour, linewidth=1.3, label=part)
    axes[0, 0].set_ylabel("energy [kJ]")
    axes[0, 0].legend(frameon=False, fontsize=9)
    axes[0, 0].set_title("where the energy is", loc="left", fontsize=11)

    for each, colour in ((run, "#d9822b"), (undamped, "#2b6cb0")):
        if each:
            moving = each.energy["kinetic"] + each.energy["rotational"]
            axes[0, 1].semilogy(each.energy["t"], np.maximum(moving, 1e-3), color=colour,
                                label=f"α = {each.options['alpha']:g} 1/s")
    axes[0, 1].set_ylim(1e-2)
    axes[0, 1].set_ylabel("kinetic + rotational [J]")
    axes[0, 1].legend(frameon=False, fontsize=9)
    axes[0, 1].set_title("energy of motion", loc="left", fontsize=11)

    axes[1, 0].plot(t, energy["momentum_x"], color="#d9822b", label="along the floor")
    axes[1, 0].plot(t, energy["momentum_y"], color="#2b6cb0", label="upwards")
    axes[1, 0].set_ylabel("momentum [kg m/s]")
    axes[1, 0].legend(frameon=False, fontsize=9)
    axes[1, 0].set_title("momentum", loc="left", fontsize=11)

    axes[1, 1].axhline(1, color=GREY, linewidth=0.8)
    axes[1, 1].plot(t, energy["floor_y"] / weight, color="#20242a", linewidth=0.9)
    axes[1, 1].set_ylabel("force on the floor / weight [-]")
    axes[1, 1].set_title("load on the floor", loc="left", fontsize=11)

    for each in axes.flat:
        tidy(each)
        each.set_xlim(0, t[-1])
    for each in axes[1]:
        each.set_xlabel("time [s]")
    figure.savefig(path, dpi=150)
    plt.close(figure)


def animate(run, path):
    """Up to 1.5 s of the run at half its speed."""
    top = run.height + run.options["drop_height"]
    end = min(1.5, run.series.times[-1])
    numbers = [run.series.nearest(t) for t in np.arange(0, end, 0.025)]
    figure = plt.figure(figsize=(5.2, 4.1), dpi=80)
    axes = figure.add_axes((0, 0, 1, 1))

    def show(number):
        axes.clear()
        frame = run.frame(number)
        view(axes, run, 0.74 * top, 1.12 * top)
        draw(axes, frame, speed(frame), edge=thin(run, 0.74 * top, 5.2, 0.2), **colours(run))
        axes.text(0.03, 0.93, f"t = {run.series.times[number]:.2f} s", fontsize=11,
                  transform=axes.transAxes)

    FuncAnimation(figure, show, frames=numbers).save(path, writer=PillowWriter(fps=20))
    plt.close(figure)


def asymmetry(run, until):
    """Largest distance of a disc from the mirror image of its partner up to a time [m]."""
    columns, rows = run.options["columns"], run.options["rows"]
    ids = np.arange(columns * rows).reshape(rows, columns)
    mirror = np.append(ids[:, ::-1].ravel(), columns * rows)
    worst = 0
    for number in np.flatnonzero(run.series.times <= until):
        frame = run.series[number]
        x = np.empty((len(frame["id"]), 2))
        x[frame["id"]] = frame["position"][:, :2]
        worst = max(worst, np.abs(x - x[mirror] * [-1, 1]).max())
    return worst


def farther_than(run, heap):
    """Grains that ended farther from the axis than twice the radius of another run's heap."""
    x = run.series[len(run.series) - 1]["position"]
    return int(np.sum(np.hypot(x[:, 0], x[:, 2]) > 2 * heap.summary["pile_radius"]))


def compare(run, others, path):
    """Checks against what must hold, as a table."""
    s = run.summary
    rows = [
        ("floor load / weight before the disc lands", f"{s['floor_load_over_weight']:.4f}",
         "1 ± 0.01", abs(s["floor_load_over_weight"] - 1) <= 0.01),
        ("largest deviation of a contact force from i m g", f"{100 * s['layer_load_error']:.2g} %",
         "≤ 1 %", s["layer_load_error"] <= 0.01),
        (f"escaped at t = {run.options['until']:g} s, α = {run.options['alpha']:g} 1/s",
         s["escaped"], "0", s["escaped"] == 0),
    ]
    undamped = others["undamped"]
    if undamped:
        until = undamped.options["until"]
        # Spheres roll on for ever, so that without damping the whole heap goes far.
        if run.options["dimension"] == 2:
            escaped = undamped.summary["escaped"]
            rows.append((f"escaped at t = {until:g} s, α = 0", escaped, "> 0", escaped > 0))
        few, many = farther_than(run, run), farther_than(undamped, run)
        rows.append((f"farther than twice the damped heap's radius at t = {until:g} s, α = 0",
                     many, f"> {few}, those of α = {run.options['alpha']:g} 1/s", many > few))
        energy = undamped.energy
        total = sum(energy[part] for part in ("kinetic", "rotational", "potential", "elastic"))
        growth = np.diff(total).max() / total[0]
        rows.append(("largest growth of the energy between outputs, α = 0", f"{growth:.1e} of it",
                     "≤ 1e-3", growth <= 1e-3))
    if symmetric := others["symmetric"]:
        worst = asymmetry(symmetric, 0.2) / symmetric.options["radius"]
        rows.append(("asymmetry up to t = 0.2 s, offset 0", f"{worst:.1e} R", "≤ 1e-6 R",
                     worst <= 1e-6))
    if frictionless := others["frictionless"]:
        energy = frictionless.energy
        worst = np.abs(energy["momentum_x"]).max() / np.abs(energy["momentum_y"]).max()
        rows.append(("momentum along a floor without friction / falling momentum", f"{worst:.1e}",
                     "≤ 1e-10", worst <= 1e-10))
    bound = 1.0
    for each in [run, *([undamped] if undamped else [])]:
        share = each.summary["front_speed_over_fall"]
        rows.append((f"speed along the floor of the lowest layer / √(2 g h₀), {each.damping}",
                     f"{share:.2f}", f"≤ {bound:g}", share <= bound))
    waves = [each for each in [run, *others["waves"]] if each.summary["wave_arrival"]]
    for each in waves:
        passed = each.summary["wave_arrival_a_layer"]
        rows.append((f"arrival at the floor / (layers · √(m/k)), {describe(each)}",
                     f"{passed:.3f}", "0.95 to 1.25", 0.95 <= passed <= 1.25))
    if waves and run.summary["wave_arrival"]:
        base = run.summary["wave_arrival_a_layer"]
        like = [each for each in waves if each.options["rows"] == run.options["rows"]]
        worst = max(abs(each.summary["wave_arrival_a_layer"] / base - 1) for each in like)
        if len(like) > 1:
            rows.append(("the same for other k and m: largest deviation", f"{100 * worst:.2g} %",
                         "≤ 2 %", worst <= 0.02))
    lines = ["# Broken tower", "",
             "After [SahChoi2004], Figs 9 and 10: with global damping no grain is thrown off, "
             "without it some are.", "", "| | measured | must be | |", "|---|---|---|---|"]
    lines += [f"| {what} | {value} | {wanted} | {'yes' if good else '**no**'} |"
              for what, value, wanted, good in rows]
    lines += ["", f"{s['particles']} grains, {s['steps']} steps of {s['time_step']:.3g} s in "
              f"{s['wall_seconds']:.1f} s: {s['seconds_search']:.1f} s for the search, "
              f"{s['seconds_contacts']:.1f} s for the contacts."]
    path.write_text("\n".join(lines) + "\n", encoding="utf-8")


def main(arguments):
    if len(arguments) != 1:
        sys.exit(__doc__)
    folder = pathlib.Path(arguments[0])
    if not (folder / "summary.json").exists():
        sys.exit(f"plot_broken_tower.py: {folder} has no summary.json; run broken_tower first")
    run = Run(folder)
    others = {name: Run.there(folder / name) for name in ("undamped", "symmetric", "frictionless")}
    others["waves"] = [Run(each.parent) for each in sorted(folder.glob("wave_*/summary.json"))]
    draw_frames(run, others["undamped"], folder / "frames.png")
    if others["undamped"]:
        draw_figures(run, others["undamped"], folder / "figures_9_10.png")
    draw_energy(run, others["undamped"], folder / "energy.png")
    draw_wave([run, *others["waves"]], folder / "wave.png")
    draw_spreading(run, others["undamped"], folder / "spreading.png")
    animate(run, folder / "collapse.gif")
    compare(run, others, folder / "comparison.md")


if __name__ == "__main__":
    main(sys.argv[1:])
