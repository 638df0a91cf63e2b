#!/usr/bin/env python3
# SPDX-License-Identifier: MIT
"""Draws the output of vibrating_floor and the kinetic theory of the same bed.

    plot_vibrating_floor.py FOLDER

If FOLDER contains one run, writes profile.png and comparison.md to it. If it contains the runs of a
study in subfolders, writes figures.png (Figs 5 to 8 of [SahChoi2004]), figures_2d.png, and
comparison.md with all relations that must hold; see study_vibrating_floor.py.
"""

import json
import pathlib
import sys

sys.path.insert(0, str(pathlib.Path(__file__).resolve().parent))
from support import plot_style as style
from support.plot_style import DASHED, GREY, np, plt

style.need("scipy")
from support.kinetic_theory import SteadyBed, contact_value

FIGURES = {
    "mean_temperature_over_gd": "T / g d",
    "centre_of_mass_over_d": "centre of mass / d",
    "solid_fraction_max": "largest solid fraction",
    "solid_fraction_peak_over_d": "at height / d",
    "floor_force_over_weight": "floor force / weight",
}


def table(path):
    return np.genfromtxt(path, delimiter=",", names=True)


class Measured:
    """A number with its standard error."""

    def __init__(self, value, error):
        self.value, self.error = float(value), float(error)

    def __sub__(self, other):
        return Measured(self.value - other.value, np.hypot(self.error, other.error))

    def over(self, other):
        """Their ratio."""
        ratio = self.value / other.value
        return Measured(ratio, abs(ratio) * np.hypot(self.error / self.value,
                                                     other.error / other.value))

    def __str__(self):
        # As many digits as are needed for two digits of the error.
        digits = 3
        if np.isfinite(self.error) and self.error > 0:
            digits = int(np.clip(1 - np.floor(np.log10(self.error)), 0, 6))
        return f"{self.value:.{digits}f} ± {self.error:.{digits}f}"


class Run:
    """One output folder."""

    def __init__(self, folder):
        self.summary = json.loads((folder / "summary.json").read_text())
        self.options = self.summary["options"]
        self.profile = table(folder / "profile.csv")
        self.errors = table(folder / "profile_errors.csv")
        self.y = self.profile["y_over_d"]

    def __getattr__(self, name):
        """Options by their names."""
        try:
            return self.options[name]
        except KeyError:
            raise AttributeError(name) from None

    def figure(self, name):
        return Measured(self.summary[name], self.summary["standard_errors"][name])

    def band(self, name, lower, upper):
        """Mean of a column between two heights [d]. Slices within one grain are correlated, so the
        error is that of one slice."""
        inside = (self.y > lower) & (self.y < upper) & np.isfinite(self.profile[name])
        weight = self.profile["solid_fraction"][inside]
        return Measured(np.average(self.profile[name][inside], weights=weight),
                        np.average(self.errors[name][inside], weights=weight))

    def weight_above(self, height):
        """Weight above a height, over rho_p g d; it must equal the pressure there."""
        slice_height = self.y[1] - self.y[0]
        above = np.cumsum((self.profile["solid_fraction"] * slice_height)[::-1])[::-1]
        return float(np.interp(height, self.y - slice_height / 2, above))

    def pressure(self, temperature, lower, upper):
        """Pressure of the equation of state between two heights [d], over rho_p g d, with the
        temperature of this column."""
        nu = self.band("solid_fraction", lower, upper).value
        T = self.band(temperature, lower, upper).value
        return nu * T * (1 + 2 * (1 + self.restitution) * nu * contact_value(nu))

    def theory(self):
        return SteadyBed(self.summary["mass_holdup"], self.boundary_velocity, self.restitution)

    @property
    def name(self):
        return f"m_t = {self.mass_holdup:g}, V_b = {self.boundary_velocity:g}"


def curve(axes, run, name, colour, label):
    """A profile over height, with two standard errors, up to the height where it is known, which is
    returned [d]."""
    values, errors = run.profile[name], run.errors[name]
    known = run.profile["solid_fraction"] > 2e-4
    if name != "solid_fraction":
        known = (run.profile["solid_fraction"] > 1e-3) & (errors < 0.1 * values) & (run.y > 0)
    values, errors, y = values[known], errors[known], run.y[known]
    axes.fill_betweenx(y, values - 2 * errors, values + 2 * errors, color=colour, alpha=0.25,
                       linewidth=0)
    axes.plot(values, y, color=colour, label=label)
    return y.max(initial=0)


def theory_curve(axes, theory, name, colour):
    values = {"solid_fraction": theory.solid_fraction, "temperature_over_gd": theory.temperature}
    known = theory.solid_fraction > 2e-4
    axes.plot(values[name][known], theory.y[known], color=colour, linewidth=1.1, linestyle=DASHED)
    return theory.y[known].max(initial=0)


def finish(axes, name, top):
    if name == "solid_fraction":
        axes.set_xlabel("solid fraction ν [-]")
        axes.set_xlim(0)
    else:
        axes.set_xlabel("fluctuation energy T / (g d) [-]")
        axes.set_xscale("log")
    axes.set_ylabel("height y / d [-]")
    axes.set_ylim(0, 1.03 * top or None)


def draw_figures(rows, title, theories):
    """rows: (captions of the two panels, [(run, label)])."""
    figure, panels = plt.subplots(2, 2, figsize=(style.WIDE, 8.2))
    for axes, (captions, runs) in zip(panels, rows):
        for each, name, caption in zip(axes, ("temperature_over_gd", "solid_fraction"), captions):
            top = 0
            for (run, label), colour in zip(runs, style.CURVES):
                top = max(top, curve(each, run, name, colour, label))
                if run in theories:
                    top = max(top, theory_curve(each, theories[run], name, colour))
            if theories:
                each.plot([], [], color=GREY, linewidth=1.1, linestyle=DASHED,
                          label="kinetic theory")
            finish(each, name, top)
            style.legend_on_top(each, 2, caption)
    figure.suptitle(title, x=0.01, ha="left")
    return figure


class Check:
    """Lines of a table: quantity, measured, expected, whether it holds."""

    def __init__(self):
        self.lines = []
        self.verdicts = []

    def add(self, what, measured, wanted, holds, undecided=False):
        verdict = "yes" if holds else "undecided" if undecided else "**no**"
        self.verdicts.append(verdict)
        self.lines.append(f"| {what} | {measured} | {wanted} | {verdict} |")

    def rises(self, what, before, after):
        """Beyond two standard errors."""
        rise = after - before
        self.add(f"{what} rises", f"{before} → {after}", "beyond 2 standard errors",
                 rise.value > 2 * rise.error)

    def falls(self, what, before, after):
        fall = before - after
        self.add(f"{what} falls", f"{before} → {after}", "beyond 2 standard errors",
                 fall.value > 2 * fall.error)

    def unchanged(self, what, measured, reference, limit):
        """Their ratio is 1 within the limit; undecided if it exceeds the limit by less than two
        standard errors."""
        ratio = measured.over(reference)
        off = abs(ratio.value - 1)
        self.add(what, f"{100 * (ratio.value - 1):+.2f} ± {100 * ratio.error:.2f} %",
                 f"within {100 * limit:g} %", off < limit, off < limit + 2 * ratio.error)

    def text(self):
        return ["| | measured | must be | |", "|---|---|---|---|"] + self.lines


def figure_table(runs, theories):
    """All figures of the runs, each with the result of kinetic theory below."""
    lines = ["| run | grains | " + " | ".join(FIGURES.values()) + " |",
             "|---|---|" + "---|" * len(FIGURES)]
    for run in runs:
        numbers = " | ".join(str(run.figure(name)) for name in FIGURES)
        lines.append(f"| {run.name} | {run.summary['grains']} | {numbers} |")
        if theory := theories.get(run):
            lines.append(f"| … kinetic theory | | {theory.mean_temperature:.4f} | "
                         f"{theory.centre_of_mass:.2f} | {theory.solid_fraction_max:.3f} | "
                         f"{theory.solid_fraction_peak:.2f} | 1 |")
    return lines


def check_one(check, run):
    force = run.figure("floor_force_over_weight")
    off = abs(force.value - 1)
    check.add(f"{run.name}: floor force / weight", force, "1 ± 0.01", off <= 0.01,
              off <= 0.01 + 2 * force.error)
    kept = run.summary["mass_holdup_of_profile"] / run.summary["mass_holdup"]
    check.add(f"{run.name}: integral of the solid fraction / m_t d", f"{kept:.6f}", "1 ± 1e-6",
              abs(kept - 1) <= 1e-6)


def check_cooling(check, run):
    """The energy decreases over four bands between floor and centre of mass."""
    edges = np.linspace(0.5, run.figure("centre_of_mass_over_d").value, 5)
    bands = [run.band("temperature_over_gd", low, high) for low, high in zip(edges, edges[1:])]
    fall = bands[0] - bands[-1]
    rises = [above - below for below, above in zip(bands, bands[1:])]
    check.add(f"{run.name}: energy falls with height, in quarters up to {edges[-1]:.1f} d",
              " → ".join(str(band) for band in bands),
              "beyond 2 standard errors in all, and nowhere a rise beyond them",
              fall.value > 2 * fall.error
              and all(rise.value < 2 * rise.error for rise in rises))


def check_pressure(check, run):
    """The pressure of the equation of state equals the weight above; if the energy differs among
    the axes, with that of the vertical motion."""
    heights = np.arange(2.5, run.figure("solid_fraction_peak_over_d").value, 1)
    for column, name, wanted in (("temperature_vertical", "vertical", True),
                                 ("temperature_over_gd", "mean", False)):
        ratios = [run.pressure(column, y - 0.5, y + 0.5) / run.weight_above(y) for y in heights]
        text = f"{min(ratios):.3f} to {max(ratios):.3f}"
        what = f"{run.name}: pressure by the {name} energy over the weight above"
        if wanted:
            check.add(what, text, "within 5 % of 1",
                      max(abs(ratio - 1) for ratio in ratios) <= 0.05)
        else:
            check.lines.append(f"| {what} | {text} | | |")


def check_orders(check, by_holdup, by_velocity):
    """The relations between the runs shown by the paper's figures."""
    T, peak, at = (lambda run: run.figure("mean_temperature_over_gd"),
                   lambda run: run.figure("solid_fraction_max"),
                   lambda run: run.figure("solid_fraction_peak_over_d"))
    for less, more in zip(by_holdup, by_holdup[1:]):
        pair = f"V_b = 2, m_t {less.mass_holdup:g} → {more.mass_holdup:g}"
        check.falls(f"{pair}: mean energy", T(less), T(more))
        check.rises(f"{pair}: largest solid fraction", peak(less), peak(more))
        # The density of the thinnest bed is nearly uniform, so the position of its peak is random.
        if less is not by_holdup[0]:
            check.rises(f"{pair}: height of the largest solid fraction", at(less), at(more))
    for less, more in zip(by_velocity, by_velocity[1:]):
        pair = f"m_t = 5, V_b {less.boundary_velocity:g} → {more.boundary_velocity:g}"
        check.rises(f"{pair}: mean energy", T(less), T(more))
        check.rises(f"{pair}: height of the largest solid fraction", at(less), at(more))
    for run in dict.fromkeys(by_holdup + by_velocity):
        check_cooling(check, run)
        check.falls(f"{run.name}: energy at 0.5 d to 1.5 d, from vertical to horizontal,",
                    run.band("temperature_vertical", 0.5, 1.5),
                    run.band("temperature_horizontal", 0.5, 1.5))
    # No centre is below d/2, so spheres fill slices completely only above a height of d.
    thin = by_holdup[0]
    near = thin.band("solid_fraction", 1, 2).over(peak(thin))
    check.add(f"{thin.name}: solid fraction at d to 2 d over its maximum", near, "≥ 0.8",
              near.value >= 0.8)
    for run in by_holdup[1:]:
        check.rises(f"{run.name}: solid fraction from d to 2 d up to its maximum",
                    run.band("solid_fraction", 1, 2), peak(run))


class Study:
    """The runs below a folder, identified by their options."""

    def __init__(self, folder):
        self.runs = [Run(path.parent) for path in sorted(folder.glob("*/summary.json"))]

    def find(self, **options):
        """The run with these options, and those of the paper otherwise; None if there is none."""
        wanted = {"dimension": 3, "mass_holdup": 2.5, "boundary_velocity": 2, "frequency": 50,
                  "restitution": 0.9, **options}
        wanted.setdefault("cell_width", 8 if wanted["dimension"] == 3 else 40)
        wanted.setdefault("loading_stiffness", 2.7e8 if wanted["dimension"] == 3 else 2.7e7)
        for run in self.runs:
            if all(run.options[name] == value for name, value in wanted.items()):
                return run
        return None

    def series(self, dimension):
        """The existing runs by mass hold-up and by boundary velocity."""
        by_holdup = [self.find(dimension=dimension, mass_holdup=m) for m in (1, 2.5, 5)]
        by_velocity = [self.find(dimension=dimension, mass_holdup=5, boundary_velocity=v)
                       for v in (0.25, 2, 5)]
        return ([run for run in by_holdup if run], [run for run in by_velocity if run])


def rows_of(by_holdup, by_velocity, names):
    speed, layers = "floor velocity V$_b$", "mass hold-up m$_t$"
    return [([f"{names[0]}: energy, {speed} = 2", f"{names[1]}: solid fraction, {speed} = 2"],
             [(run, f"m$_t$ = {run.mass_holdup:g}") for run in by_holdup]),
            ([f"{names[2]}: energy, {layers} = 5", f"{names[3]}: solid fraction, {layers} = 5"],
             [(run, f"V$_b$ = {run.boundary_velocity:g}") for run in by_velocity])]


def compare_study(study, folder):
    by_holdup, by_velocity = study.series(3)
    runs = list(dict.fromkeys(by_holdup + by_velocity))
    theories = {run: run.theory() for run in runs}
    style.make(folder / "figures.png", draw_figures,
               rows_of(by_holdup, by_velocity, ("Fig. 5", "Fig. 6", "Fig. 7", "Fig. 8")),
               "Spheres of diameter d on a vibrating floor, after Figs 5–8 of Sah and Choi (2004).\n"
               "m$_t$: mass hold-up, V$_b$: floor velocity; bands: ± two standard errors", theories)
    check = Check()
    for run in runs:
        check_one(check, run)
    check_orders(check, by_holdup, by_velocity)
    both = ("mean_temperature_over_gd", "centre_of_mass_over_d")
    for holdup in (1, 2.5, 5):
        hard, soft = study.find(mass_holdup=holdup), study.find(mass_holdup=holdup,
                                                                 loading_stiffness=2.7e7)
        for name in both if hard and soft else ():
            check.unchanged(f"{hard.name}: {FIGURES[name]} with a tenth of K_1",
                            soft.figure(name), hard.figure(name), 0.02)
    for holdup in (1, 2.5):
        narrow = study.find(mass_holdup=holdup, loading_stiffness=2.7e7)
        wide = study.find(mass_holdup=holdup, loading_stiffness=2.7e7, cell_width=16)
        for name in both if narrow and wide else ():
            check.unchanged(f"{wide.name}: {FIGURES[name]} with the cell twice as wide",
                            wide.figure(name), narrow.figure(name), 0.03)
    for run in runs:
        if run.mass_holdup in (2.5, 5) and run.boundary_velocity == 2:
            theory = Measured(theories[run].mean_temperature, 0)
            check.unchanged(f"{run.name}: mean energy against kinetic theory",
                            run.figure("mean_temperature_over_gd"), theory, 0.1)
    for run in by_holdup:
        check_pressure(check, run)

    lines = ["# Vibrating floor", "", "Spheres, 3D:", ""] + figure_table(runs, theories)
    lines += [""] + check.text()

    flat = list(dict.fromkeys(sum(study.series(2), [])))
    if flat:
        names = ("As Fig. 5", "As Fig. 6", "As Fig. 7", "As Fig. 8")
        style.make(folder / "figures_2d.png", draw_figures, rows_of(*study.series(2), names),
                   "Discs on a vibrating floor: trends as in Figs 5–8 of Sah and Choi (2004), not "
                   "the same numbers.\nm$_t$: mass hold-up, V$_b$: floor velocity; bands: ± two "
                   "standard errors", {})
        trends = Check()
        check_orders(trends, *study.series(2))
        lines += ["", "Discs, 2D, for the trends:", ""] + figure_table(flat, {})
        lines += [""] + trends.text()
        check.verdicts += trends.verdicts
    count = {verdict: check.verdicts.count(verdict) for verdict in dict.fromkeys(check.verdicts)}
    lines += ["", f"{len(study.runs)} runs; " +
              ", ".join(f"{verdict.strip('*')}: {n}" for verdict, n in count.items())]
    (folder / "comparison.md").write_text("\n".join(lines) + "\n", encoding="utf-8")


def draw_profile(run, theory):
    figure, panels = plt.subplots(1, 2, figsize=(style.WIDE, 4.4))
    for axes, name in zip(panels, ("temperature_over_gd", "solid_fraction")):
        top = curve(axes, run, name, style.BLUE, "measured, ± two standard errors")
        if theory:
            top = max(top, theory_curve(axes, theory, name, style.BLUE))
            axes.plot([], [], color=style.BLUE, linestyle=DASHED, label="kinetic theory")
        finish(axes, name, top)
        style.legend_on_top(axes, 2)
    figure.suptitle(f"Mass hold-up m$_t$ = {run.mass_holdup:g}, floor velocity V$_b$ = "
                    f"{run.boundary_velocity:g}", x=0.01, ha="left")
    return figure


def compare_one(run, folder):
    theories = {run: run.theory()} if run.dimension == 3 else {}
    style.make(folder / "profile.png", draw_profile, run, theories.get(run))
    check = Check()
    check_one(check, run)
    lines = ["# Vibrating floor", ""] + figure_table([run], theories) + [""] + check.text()
    (folder / "comparison.md").write_text("\n".join(lines) + "\n", encoding="utf-8")


def main(arguments):
    if len(arguments) != 1:
        sys.exit(__doc__)
    folder = pathlib.Path(arguments[0])
    if (folder / "summary.json").exists():
        return compare_one(Run(folder), folder)
    study = Study(folder)
    if not study.runs:
        sys.exit(f"plot_vibrating_floor.py: {folder} has no summary.json, nor have its subfolders; "
                 "run vibrating_floor first")
    compare_study(study, folder)


if __name__ == "__main__":
    main(sys.argv[1:])
