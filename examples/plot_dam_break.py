#!/usr/bin/env python3
# SPDX-License-Identifier: MIT
"""Draws what dam_break wrote.

    plot_dam_break.py FOLDER

Makes frames.png, front.png, pressure.png, collapse.gif and comparison.md in FOLDER. A run of the
original scheme in the subfolder case_00 (--case 00) is compared with it, where it is there.
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

HERE = pathlib.Path(__file__).resolve().parent
sys.path.insert(0, str(HERE))
from support.frames import Series, draw

REFERENCE = HERE.parent / "tests" / "reference"
FRONT = "martin_moyce_1952_n2eq2_front_table2.csv"
HEIGHT = "martin_moyce_1952_n2eq2_height_table6.csv"

G = 9.81
DENSITY = 1000.0
BLUE = "#1f6fb4"
ORANGE = "#d9822b"
DARK = "#20242a"
WATER = LinearSegmentedColormap.from_list(
    "water", ["#bfe0f2", "#5aa9d6", "#1f6fb4", "#2b3f8f", "#8b2f7a", "#e0534a", "#f6b84b"])


def table(path):
    # NumPy would take the first comment for the column names.
    lines = [line for line in path.read_text().splitlines() if not line.startswith("#")]
    return np.genfromtxt(lines, delimiter=",", names=True)


class Run:
    """One output folder."""

    def __init__(self, folder):
        self.summary = json.loads((folder / "summary.json").read_text())
        self.options = self.summary["options"]
        self.series = Series(folder / "frames.pvd")
        self.front = table(folder / "front.csv")
        self.pressure = table(folder / "pressure.csv")
        self.name = f"case {self.options['case']:02d}"
        self.width, self.height = self.options["column"]

    @classmethod
    def there(cls, folder):
        return cls(folder) if (folder / "summary.json").exists() else None

    def dimensionless_front(self):
        """T = t √(2g/a) and Z = x/a."""
        return self.front["t"] * np.sqrt(2 * G / self.width), self.front["x_front"] / self.width

    def time_shift(self, at=(1.19, 1.44)):
        """The experiment cannot see the release: T is shifted so that Z = 1.44 falls on T = 1.19."""
        T, Z = self.dimensionless_front()
        if Z.max() < at[1]:
            return None
        after = int(np.argmax(Z >= at[1]))
        return at[0] - np.interp(at[1], Z[after - 1:after + 1], T[after - 1:after + 1])

    def front_error(self):
        """Relative rms of Z against Martin & Moyce for T in 1.19–3.3, after the one shift."""
        shift = self.time_shift()
        if shift is None:
            return None
        experiment = table(REFERENCE / FRONT)
        T, Z = self.dimensionless_front()
        wanted = (experiment["T"] >= 1.19) & (experiment["T"] <= 3.3)
        wanted &= experiment["Z"] < 0.999 * self.options["tank"][0] / self.width
        wanted &= experiment["T"] <= T[-1] + shift
        if wanted.sum() < 3:
            return None
        ours = np.interp(experiment["T"][wanted], T + shift, Z)
        return float(np.sqrt(np.mean((ours / experiment["Z"][wanted] - 1) ** 2)))

    def is_martin_moyce(self):
        return abs(self.height / self.width - 2) < 1e-9

    def roughness(self, begin=0.4, window=0.02):
        """Rms [Pa] of the first gauge minus its moving average over 0.02 s, from 0.4 s on."""
        t, p = self.pressure["t"], self.pressure["p_1"]
        total = np.concatenate([[0], np.cumsum(p)])
        low = np.searchsorted(t, t - window / 2)
        high = np.searchsorted(t, t + window / 2, side="right")
        rough = p - (total[high] - total[low]) / (high - low)
        return float(np.sqrt(np.mean(rough[t >= begin] ** 2))) if (t >= begin).any() else None


def slice_of(run, frame):
    """Fluid and walls in the plane; of a 3D run, the middle slice."""
    keep = frame["kind"] < 2
    at = frame["position"]
    if run.options["dimension"] == 3:
        middle = run.options["depth"] / 2
        keep &= np.abs(at[:, 1] - middle) <= 0.51 * run.options["spacing"]
        at = at[:, [0, 2, 1]]
    return {name: (at if name == "position" else values)[keep] for name, values in frame.items()}


def show(axes, run, frame, top):
    frame = slice_of(run, frame)
    l0 = run.options["spacing"]
    is_wall = frame["kind"] == 1
    walls = {"position": frame["position"][is_wall]}
    water = {"position": frame["position"][~is_wall]}
    draw(axes, walls, np.zeros(is_wall.sum()), radius=0.5 * l0, cmap=LinearSegmentedColormap.from_list(
        "wall", ["#9a948a", "#9a948a"]))
    circles = draw(axes, water, frame["pressure"][~is_wall] / 1e3, radius=0.6 * l0, cmap=WATER,
                   norm=plt.Normalize(0, DENSITY * G * run.height / 1e3))
    axes.set_xlim(-2 * l0, run.options["tank"][0] + 2 * l0)
    axes.set_ylim(-2 * l0, top)
    axes.set_xticks([])
    axes.set_yticks([])
    for side in axes.spines.values():
        side.set_visible(False)
    return circles


def draw_frames(run, path):
    end = run.series.times[-1]
    times = [t for t in (0.0, 0.1, 0.2, 0.3, 0.4, 0.5, 0.6, 0.8, 1.0) if t <= end + 1e-3]
    top = 1.35 * run.height
    rows = int(np.ceil(len(times) / 3))
    aspect = top / run.options["tank"][0]
    figure, panels = plt.subplots(rows, 3, figsize=(11.5, 11.5 / 3.3 * aspect * rows + 0.5),
                                  squeeze=False)
    figure.subplots_adjust(left=0.01, right=0.91, bottom=0.01, top=0.95, wspace=0.05, hspace=0.1)
    for axes in panels.flat:
        axes.set_axis_off()
    for axes, time in zip(panels.flat, times):
        axes.set_axis_on()
        circles = show(axes, run, run.series[run.series.nearest(time)], top)
        axes.set_title(f"t = {time:.1f} s", fontsize=11, loc="left")
    bar = figure.colorbar(circles, cax=figure.add_axes((0.93, 0.2, 0.012, 0.6)), extend="max")
    bar.set_label("pressure [kPa]")
    bar.outline.set_visible(False)
    figure.savefig(path, dpi=130)
    plt.close(figure)


def tidy(axes):
    for each in axes:
        each.grid(color="#eceef1", linewidth=0.8)
        each.set_axisbelow(True)
        each.spines[["top", "right"]].set_visible(False)


def draw_front(runs, path):
    figure, axes = plt.subplots(1, 2, figsize=(11, 4.6), layout="constrained")
    if runs[0].is_martin_moyce():
        experiment = table(REFERENCE / FRONT)
        axes[0].plot(experiment["T"], experiment["Z"], "o", color=DARK, markersize=5,
                     label="Martin & Moyce 1952, n² = 2")
        height = table(REFERENCE / HEIGHT)
        axes[1].plot(height["tau"], height["H"], "o", color=DARK, markersize=5,
                     label="Martin & Moyce 1952, n² = 2")
    for run, colour in zip(runs, (BLUE, ORANGE)):
        T, Z = run.dimensionless_front()
        shift = run.time_shift() or 0
        axes[0].plot(T + shift, Z, color=colour, linewidth=1.8,
                     label=f"{run.name}, shifted by {shift:.2f}")
        axes[0].plot(T, Z, color=colour, linewidth=0.9, linestyle=(0, (2, 2)),
                     label=f"{run.name} as computed")
        axes[1].plot((T + shift) / np.sqrt(2), run.front["height"] / run.height, color=colour,
                     linewidth=1.8, label=f"{run.name}, same shift")
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
    for axes, run, colour in zip(panels, runs, (BLUE, ORANGE)):
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
    top = 1.35 * run.height
    width = run.options["tank"][0]
    figure = plt.figure(figsize=(5.6, 5.6 * (top + 0.03) / (width + 0.04)), dpi=80)
    axes = figure.add_axes((0, 0, 1, 1))

    def show_number(number):
        axes.clear()
        show(axes, run, run.series[number], top)
        axes.text(0.97, 0.93, f"t = {run.series.times[number]:.2f} s", fontsize=12, ha="right",
                  transform=axes.transAxes)

    FuncAnimation(figure, show_number, frames=numbers).save(path, writer=PillowWriter(fps=15))
    plt.close(figure)


def compare(run, original, path):
    rows = []
    if run.is_martin_moyce() and run.front_error() is not None:
        rows.append(("leading edge, rms deviation from Martin & Moyce (1952), T = 1.19–3.3, time "
                     f"shifted by {run.time_shift():.2f}", f"{100 * run.front_error():.1f} %",
                     "≤ 6 %", run.front_error() <= 0.06))
    lost = run.summary["particles_lost"]
    rows.append(("particles lost", lost, "0", lost == 0))
    if original:
        if original.is_martin_moyce() and original.front_error() is not None:
            rows.append((f"the same for {original.name}", f"{100 * original.front_error():.1f} %", "",
                         None))
            until = min(1.6 / run.width, run.options["tank"][0] / run.width) * 0.95
            T, Z = run.dimensionless_front()
            To, Zo = original.dimensionless_front()
            levels = np.arange(1.5, until, 0.25)
            lead = np.mean([np.interp(z, Z, T) - np.interp(z, Zo, To) for z in levels])
            rows.append((f"{original.name} is ahead of {run.name} by, in T", f"{lead:.3f}", "> 0",
                         lead > 0))
        rows.append((f"particles lost by {original.name}", original.summary["particles_lost"], "",
                     None))
        if run.roughness() and original.roughness():
            ratio = original.roughness() / run.roughness()
            rows.append((f"high-passed rms at the first gauge from 0.4 s on: {original.name} over "
                         f"{run.name}", f"{ratio:.1f}", "≥ 3", ratio >= 3))
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
    run = Run(folder)
    original = Run.there(folder / "case_00")
    runs = [run] + ([original] if original else [])
    draw_frames(run, folder / "frames.png")
    draw_front(runs, folder / "front.png")
    draw_pressure(runs, folder / "pressure.png")
    animate(run, folder / "collapse.gif")
    compare(run, original, folder / "comparison.md")


if __name__ == "__main__":
    main(sys.argv[1:])
