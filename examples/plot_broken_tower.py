#!/usr/bin/env python3
# SPDX-License-Identifier: MIT
"""Draws the output of broken_tower.

    plot_broken_tower.py FOLDER

Writes frames.png, figures_9_10.png, energy.png, wave.png, spreading.png, collapse.gif and
comparison.md to FOLDER. The comparison includes runs in the subfolders undamped (--alpha 0),
symmetric (--offset 0), frictionless (--friction-angle 0) and wave_* (other stiffness, density or
height), if they exist.
"""

import json
import pathlib
import sys

sys.path.insert(0, str(pathlib.Path(__file__).resolve().parent))
from support import plot_style as style
from support.frames import Series, draw, extent, speed
from support.plot_style import BLUE, DARK, DASHED, GREY, ORANGE, np, plt


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
        """Orders spheres from back to front, so that those in front are drawn last."""
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
        return f"global damping α = {alpha:g} s⁻¹" if alpha else "no global damping"

    @property
    def grains(self):
        return "discs" if self.options["dimension"] == 2 else "spheres"


def ground(axes, bottom):
    """The floor, drawn down to the lower limit of the axes [m]."""
    axes.axhspan(bottom, 0, color=style.FLOOR, zorder=0)
    axes.axhline(0, color="#5b5348", linewidth=0.8)


def colours(run):
    """Colour scale up to the speed of a free fall from half the height."""
    return {"cmap": style.SPEED, "norm": plt.Normalize(0, np.sqrt(9.81 * run.height))}


def outline(run, width, inches, most):
    """Width of a grain's outline [points], thinner for small grains. width, inches: width of the
    panel in metres and in inches."""
    return min(most, 0.07 * 72 * inches * 2 * run.options["radius"] / width)


def collapse_of(run):
    """Six times of the collapse: numbers of the frames, the frames, their half width and height."""
    top = run.height + run.options["drop_height"]
    fall = np.sqrt(2 * run.height / 9.81)
    # Rounded to a tenth of a second, as in the titles.
    times = [0, *(run.summary["landing_time"] + fall * np.array([0.37, 0.6, 0.85, 1.1, 1.35]))]
    numbers = sorted({run.series.nearest(round(t, 1)) for t in times})
    frames = [run.frame(number) for number in numbers]
    left, right = extent(frames, 0, 2 * run.options["radius"])
    highest = extent(frames, 1, 2 * run.options["radius"])[1]
    return numbers, frames, max(-left, right, 0.4 * top), max(1.06 * top, highest)


def draw_collapse(figure, run):
    numbers, frames, half, top = collapse_of(run)
    bottom = -0.05 * top
    panels = figure.subplots(2, 3, sharex=True, sharey=True)
    for axes in panels.flat[len(frames):]:
        axes.remove()
    for axes, frame, number in zip(panels.flat, frames, numbers):
        style.box(axes, (-half, half), (bottom, top), ("x [m]", "height [m]"))
        ground(axes, bottom)
        circles = draw(axes, frame, speed(frame), edge=outline(run, 2 * half, 1.7, 0.3),
                       **colours(run))
        axes.set_title(f"t = {run.series.times[number]:.1f} s")
    style.bar_of(figure, circles, panels.flat[:len(frames)], "speed [m/s]", map(speed, frames),
                 shrink=0.8, aspect=30)
    figure.suptitle(f"Collapse of a tower of {run.grains} with {run.damping}", x=0.01, ha="left")


def draw_ends(figure, ends):
    """The final heaps and the grains that have escaped from them."""
    half = 1.05 * max(max(each.summary["farthest"], 2 * each.summary["pile_radius"])
                      for each in ends)
    frames = [each.frame(len(each.series) - 1) for each in ends]
    top = 1.2 * extent(frames, 1, ends[0].options["radius"])[1]
    # A wide and low heap would be a line in true proportions.
    stretch = max(1, round(0.085 * 2 * half / top))
    strips = figure.subplots(len(ends), 1, squeeze=False, sharex=True)[:, 0]
    for axes, each, frame in zip(strips, ends, frames):
        axes.set(xlim=(-half, half), ylim=(0, top), aspect=stretch)
        axes.set_yticks([0, float(f"{0.7 * top:.1g}")])
        axes.grid(False)
        x = frame["position"]
        limit = 2 * each.summary["pile_radius"]
        gone = np.hypot(x[:, 0], x[:, 2]) > limit
        draw(axes, {name: values[~gone] for name, values in frame.items()}, speed(frame)[~gone],
             edge=0.2, **colours(each))
        axes.vlines([-limit, limit], 0, top, color=GREY, linewidth=1.2, linestyle=DASHED)
        axes.vlines(x[gone, 0], 0, 0.4 * top, color=BLUE, linewidth=1)
        for side, place, align in ((-1, 0.01, "left"), (1, 0.99, "right")):
            if number := np.sum(gone & (side * x[:, 0] > 0)):
                axes.text(place, 0.55, f"{number} escaped", color=BLUE, fontsize=9,
                          ha=align, transform=axes.transAxes)
        axes.set_title(f"{each.damping}, t = {each.series.times[-1]:.1f} s: "
                       f"{each.summary['escaped']} of {each.summary['particles']} {each.grains} "
                       "have escaped")
    strips[-1].set_xlabel("x [m]")
    figure.supylabel("height [m]", fontsize=10, y=0.62)
    notes = ["blue: those that have escaped beyond it"
             ] if any(each.summary["escaped"] for each in ends) else []
    notes += [f"heights stretched {stretch} times"] if stretch > 1 else []
    figure.supxlabel(f"dashed: twice the radius that contains 95 % of the {ends[0].grains}\n"
                     + "; ".join(notes), fontsize=9)


def draw_frames(run, undamped):
    """Six times of the collapse; below them the final states with and without global damping."""
    ends = [each for each in (run, undamped) if each]
    _, frames, half, top = collapse_of(run)
    rows = int(np.ceil(len(frames) / 3))
    heights = [0.9 + rows * (0.35 + 1.6 * top / (2 * half)), 0.6 + 0.9 * len(ends)]
    figure = plt.figure(figsize=(style.NARROW, sum(heights)))
    upper, lower = figure.subfigures(2, 1, height_ratios=heights)
    draw_collapse(upper, run)
    draw_ends(lower, ends)
    return figure


def draw_figures(run, undamped):
    """Both runs at the same times, side by side, as Figs 9 and 10 of the paper."""
    fall = np.sqrt(2 * run.height / 9.81)
    begin = run.summary["landing_time"]
    last = min(run.series.times[-1], undamped.series.times[-1])
    times = [t for t in begin + fall * np.array([0.4, 0.8, 1.2, 1.8, 2.8]) if t < last] + [last]
    rows = [[each.frame(each.series.nearest(t)) for each in (run, undamped)] for t in times]
    margin = 2 * run.options["radius"]
    tops = [extent(row, 1, margin)[1] for row in rows]
    halves = [max(*np.abs(extent(row, 0, margin)), 1.3 * top) for row, top in zip(rows, tops)]
    panel = style.WIDE / 2 - 0.6
    tall = [panel * top / (2 * half) + 0.5 for top, half in zip(tops, halves)]
    figure = plt.figure(figsize=(style.WIDE, sum(tall) + 1.6))
    halves_of_page = figure.subfigures(1, 2)
    for k, (half_page, each, number) in enumerate(zip(halves_of_page, (run, undamped), (9, 10))):
        panels = half_page.subplots(len(times), 1, height_ratios=tall, squeeze=False)[:, 0]
        for axes, row, top, half, time in zip(panels, rows, tops, halves, times):
            axes.set(xlim=(-half, half), ylim=(0, top), aspect="equal", title=f"t = {time:.2f} s")
            axes.set_yticks([float(f"{0.8 * top:.1g}")])
            axes.grid(False)
            circles = draw(axes, row[k], speed(row[k]), edge=outline(run, 2 * half, panel, 0.2),
                           **colours(run))
        panels[-1].set_xlabel("x [m]")
        half_page.supylabel("height [m]", fontsize=10)
        half_page.suptitle(f"After Fig. {number} of Sah and Choi (2004):\n{each.damping}", x=0.1,
                           ha="left")
        style.bar_of(half_page, circles, panels, "speed [m/s]", map(speed, sum(rows, [])),
                     location="bottom", shrink=0.8, aspect=40)
    return figure


def describe(run):
    o = run.options
    return (f"k = {o['normal_stiffness'] / 1e3:g} kN/m, ρ = {o['density']:g} kg/m³, "
            f"{o['rows']} layers")


def draw_wave(runs):
    """The force on the floor after the landing, and the arrival of the disturbance."""
    runs = [each for each in runs if each.summary["wave_arrival"]]
    if not runs:
        return None
    figure, axes = plt.subplots(1, 3, figsize=(style.WIDE, 3.9))
    longest = 0
    for each, colour in zip(runs, [DARK, *style.CURVES]):
        s, o = each.summary, each.options
        layers = o["rows"] * s["time_a_layer"]
        # Later the tower has collapsed.
        t = each.floor["t"][each.floor["t"] <= 2 * layers]
        weight = s["grain_weight"] * (s["particles"] - 1)
        force = (each.floor["over_weight"][:len(t)] - 1) * weight / s["grain_weight"]
        axes[0].plot(1e3 * t, force, color=colour, linewidth=1, label=describe(each))
        axes[0].plot(1e3 * s["wave_arrival"], s["floor_peak_over_grain_weight"] / 2, "o",
                     color=colour)
        axes[1].plot(t / layers, force / s["floor_peak_over_grain_weight"], color=colour,
                     linewidth=1)
        longest = max(longest, layers)
        axes[2].plot(1e3 * layers, 1e3 * s["wave_arrival"], "o", color=colour, markersize=7)
    axes[0].set_xlabel("time t since the landing [ms]")
    axes[0].set_ylabel("rise of the force on the floor\n/ weight of a grain [-]")
    axes[0].set_title("arrival (dots: half the peak)")
    axes[1].axvline(1, color=GREY, linewidth=0.8)
    axes[1].set_xlim(0, 2)
    axes[1].set_xlabel("t / (layers · √(m/k)) [-]")
    axes[1].set_ylabel("rise / its peak [-]")
    axes[1].set_title("scaled by a chain of springs")
    axes[2].plot([0, 1.1e3 * longest], [0, 1.1e3 * longest], color=GREY, linewidth=1,
                 label="layers · √(m/k)")
    axes[2].set_xlabel("layers · √(m/k) [ms]")
    axes[2].set_ylabel("arrival [ms]")
    axes[2].legend(loc="upper left")
    axes[2].set_title("arrival at the floor")
    style.legend_above(figure, axes[0], 2)
    return figure


def draw_spreading(run, undamped):
    """Spreading of the lowest layer and of the heap along the floor."""
    figure, axes = plt.subplots(1, 3, figsize=(style.WIDE, 3.6))
    for each, colour in ((run, ORANGE), (undamped, BLUE)):
        if not each:
            continue
        rows = each.spreading
        for panel, name in zip(axes, ("basal_front", "half_width", "basal_moved")):
            panel.plot(rows["t"], rows[name], color=colour, label=each.damping)
    begin = run.summary["landing_time"]
    start = run.spreading["basal_front"][0]
    fall_speed = np.sqrt(2 * 9.81 * run.height)
    highest = 1.05 * axes[0].get_ylim()[1]
    t = np.array([begin, min(begin + (highest - start) / fall_speed, run.spreading["t"][-1])])
    axes[0].plot(t, start + fall_speed * (t - begin), color=GREY, linewidth=1.2, linestyle=DASHED,
                 label="speed of free fall from the top, √(2 g h₀)")
    axes[0].set_ylabel("outermost grain of the\nlowest layer [m]")
    axes[1].set_ylabel("half width of the heap,\n95 % of the grains [m]")
    axes[2].set_ylabel("share of the lowest layer that\nhas moved by a radius [-]")
    for panel in axes:
        panel.set_xlabel("time [s]")
        panel.set_ylim(0)
    style.legend_above(figure, axes[0], 3)
    return figure


def draw_energy(run, undamped):
    figure, axes = plt.subplots(2, 2, figsize=(style.WIDE, 5.6), sharex=True)
    energy = run.energy
    t = energy["t"]
    weight = run.summary["particles"] * run.summary["grain_weight"]

    kinds = ("potential", "kinetic", "rotational", "elastic")
    axes[0, 0].plot(t, sum(energy[kind] for kind in kinds) / 1e3, color=DARK, label="sum")
    for kind in kinds:
        axes[0, 0].plot(t, energy[kind] / 1e3, label=kind)
    axes[0, 0].set_ylabel("energy [kJ]")
    axes[0, 0].legend()
    axes[0, 0].set_title(f"energy, {run.damping}")

    for each, colour in ((run, ORANGE), (undamped, BLUE)):
        if each:
            moving = each.energy["kinetic"] + each.energy["rotational"]
            axes[0, 1].semilogy(each.energy["t"], np.where(moving > 0, moving, np.nan),
                                color=colour, linewidth=1.2, label=each.damping)
    axes[0, 1].set_ylabel("kinetic and rotational energy [J]")
    axes[0, 1].legend()
    axes[0, 1].set_title("energy of motion")

    axes[1, 0].plot(t, energy["momentum_x"], color=ORANGE, label="along the floor")
    axes[1, 0].plot(t, energy["momentum_y"], color=BLUE, label="upwards")
    axes[1, 0].set_ylabel("momentum [kg m/s]")
    axes[1, 0].legend()
    axes[1, 0].set_title(f"momentum, {run.damping}")

    axes[1, 1].axhline(1, color=GREY, linewidth=0.8)
    axes[1, 1].plot(t, energy["floor_y"] / weight, color=DARK, linewidth=0.9)
    axes[1, 1].set_ylabel("force on the floor / weight [-]")
    axes[1, 1].set_title(f"load on the floor, {run.damping}")

    for each in axes[1]:
        each.set_xlim(0, t[-1])
        each.set_xlabel("time [s]")
    return figure


def animate(run, path):
    """Up to 1.5 s of the run at half its speed."""
    end = min(1.5, run.series.times[-1])
    numbers = [run.series.nearest(t) for t in np.arange(0, end, 0.025)]
    frames = {number: run.frame(number) for number in numbers}
    margin = 2 * run.options["radius"]
    half = max(np.abs(extent(frames.values(), 0, margin)))
    top = extent(frames.values(), 1, margin)[1]
    bottom = -0.04 * top
    figure, axes = plt.subplots(figsize=(8, 1.2 + 6.4 * (top - bottom) / (2 * half)))
    style.box(axes, (-half, half), (bottom, top), ("x [m]", "height [m]"))
    ground(axes, bottom)

    def show(number):
        frame = frames[number]
        axes.set_title(f"t = {run.series.times[number]:.2f} s, {run.damping}")
        return [draw(axes, frame, speed(frame), edge=outline(run, 2 * half, 6.4, 0.3),
                     **colours(run))]

    bar = plt.cm.ScalarMappable(**colours(run))
    style.bar_of(figure, bar, axes, "speed [m/s]", map(speed, frames.values()), shrink=0.8)
    style.film(path, figure, numbers, show, rate=20)


def asymmetry(run, until):
    """Maximum distance of a disc from the mirror image of its partner up to a time [m]."""
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
    """Number of grains finally beyond twice the radius of another run's heap."""
    x = run.series[len(run.series) - 1]["position"]
    return int(np.sum(np.hypot(x[:, 0], x[:, 2]) > 2 * heap.summary["pile_radius"]))


def compare(run, others, path):
    """Table of checks."""
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
        # Spheres do not stop rolling, so that without damping the whole heap spreads far.
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
    undamped = others["undamped"]
    style.make(folder / "frames.png", draw_frames, run, undamped)
    if undamped:
        style.make(folder / "figures_9_10.png", draw_figures, run, undamped)
    style.make(folder / "energy.png", draw_energy, run, undamped)
    style.make(folder / "wave.png", draw_wave, [run, *others["waves"]])
    style.make(folder / "spreading.png", draw_spreading, run, undamped)
    animate(run, folder / "collapse.gif")
    compare(run, others, folder / "comparison.md")


if __name__ == "__main__":
    main(sys.argv[1:])
