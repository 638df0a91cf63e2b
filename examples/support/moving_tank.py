# SPDX-License-Identifier: MIT
"""Reads and draws the output of the examples with walls and bodies that move, or with openings:
floating_body, wave_maker, sloshing and channel.

    run = MovingTank("out/floating_body")
    run.record["y"], run.options["width"], run.findings
    run.figure([0, 1, 2], "title")      the water and the walls at some times
    draw_run(__doc__, "floating_body", {"motion.png": draw_motion}, title)
"""

import json
import pathlib
import sys

import numpy as np

from support.frames import Series
from support.water import draw_water, table


class MovingTank:
    def __init__(self, folder):
        self.folder = pathlib.Path(folder)
        self.summary = json.loads((self.folder / "summary.json").read_text())
        self.options = self.summary["options"]
        self.findings = self.summary["findings"]
        program = json.loads((self.folder / "arguments.json").read_text())["program"]
        self.record = np.atleast_1d(table(self.folder / f"{program}.csv"))
        self.middle = None
        if self.options["dimension"] == 3:  # that of a row of particles at the beginning
            spacing = self.options["spacing"]
            self.middle = (np.floor(self.options["thickness"] / 2 / spacing) + 0.5) * spacing

    @classmethod
    def there(cls, folder):
        """The output of a complete run; None if there is none."""
        return cls(folder) if (pathlib.Path(folder) / "summary.json").exists() else None

    def walls(self, number):
        """Ends of the segments of the walls in a frame, and their groups; of a 3D run where they
        cross the slice that is drawn. The groups are 0 for walls at rest."""
        frame = Series(self.folder / "walls.pvd")[number]
        groups = frame["group"]
        corners = frame["position"].reshape(len(groups), -1, 3)
        if self.middle is None:
            return corners[:, :, :2], groups
        segments, kept = [], []
        for triangle, group in zip(corners, groups):
            side = triangle[:, 1] - self.middle
            ends = [a + (b - a) * s / (s - r)
                    for a, b, s, r in zip(triangle, np.roll(triangle, -1, 0), side, np.roll(side, -1))
                    if s * r < 0]
            if len(ends) == 2:
                segments.append([end[[0, 2]] for end in ends])
                kept.append(group)
        return np.array(segments).reshape(-1, 2, 2), np.array(kept)

    def figure(self, times, title):
        """The tank at these times [s], coloured by pressure; a long one below another."""
        from support import plot_style as style

        series = Series(self.folder / "frames.pvd")
        numbers = sorted({series.nearest(time) for time in times})
        frames = [series[number] for number in numbers]
        spacing = self.options["spacing"]
        pressures = [frame["pressure"] / 1e3 for frame in frames]
        limits = style.range_of(pressures[1:] or pressures, 0)  # not yet computed in the first one
        walls = [self.walls(number) for number in numbers]
        points = np.concatenate([ends.reshape(-1, 2) for ends, _ in walls])
        across = np.concatenate([points[:, 0], *(frame["position"][:, 0] for frame in frames)])
        x = across.min() - 2 * spacing, across.max() + 2 * spacing
        up = 1 if self.middle is None else 2
        top = max(frame["position"][:, up].max() for frame in frames)
        moving = [ends[groups > 0].reshape(-1, 2)[:, 1] for ends, groups in walls]
        if self.options.get("height"):  # of a body
            top = max([top, *(heights.max() for heights in moving)])
        # Below a brink or a slot, as far as the water.
        y = min(frame["position"][:, up].min() for frame in frames) - 2.5 * spacing, top + 3 * spacing
        aspect = (y[1] - y[0]) / (x[1] - x[0])
        columns = 1 if aspect < 0.25 else 2 if aspect < 1.5 else len(numbers)
        rows = -(-len(numbers) // columns)
        tall = 0.35 + 6.8 / columns * aspect
        figure, panels = style.plt.subplots(rows, columns, squeeze=False, sharex=True, sharey=True,
                                            figsize=(style.WIDE, 0.8 + tall * rows))
        for axes in panels.flat[len(numbers):]:
            axes.remove()
        for axes, frame, number, (ends, groups) in zip(panels.flat, frames, numbers, walls):
            style.box(axes, x, y, ("x [m]", None))
            no_particles, circles = draw_water(axes, frame, spacing, limits, self.middle)
            no_particles.remove()
            for segment, group in zip(ends, groups):
                axes.plot(*segment.T, color=style.ORANGE if group > 0 else style.WALL, linewidth=1.8)
            known = frame["pressure"].any()
            axes.set_title(f"t = {series.times[number]:.2f} s"
                           + ("" if known else "; grey: pressure not yet computed"))
        figure.supylabel("height [m]", fontsize=10)
        figure.suptitle(title, x=0.01, ha="left")
        style.bar_of(figure, circles, panels.flat[:len(numbers)], "pressure [kPa]", pressures[1:] or pressures,
                     shrink=0.8, aspect=30)
        return figure

    def compare(self, path, title):
        """Writes the findings as a table."""
        lines = [f"# {title}", "", f"l0 = {self.options['spacing']:g} m; "
                 f"{self.summary['fluid_particles']} particles, {self.summary['steps']} steps in "
                 f"{self.summary['seconds_total']:.1f} s of wall-clock time.", "",
                 *findings_table(self.findings)]
        path.write_text("\n".join(lines) + "\n", encoding="utf-8")


def draw_run(doc, program, pictures, heading):
    """The main function of plot_PROGRAM.py: draws the pictures, functions of the run by name of file, to
    the folder of a run that the command line names, and writes its findings below heading(run). doc: of
    the script. Returns the run."""
    from support import plot_style as style

    if len(sys.argv) != 2:
        sys.exit(doc)
    run = MovingTank.there(sys.argv[1])
    if run is None:
        sys.exit(f"plot_{program}.py: {sys.argv[1]} has no summary.json; run {program} first")
    for name, draw in pictures.items():
        style.make(run.folder / name, draw, run)
    run.compare(run.folder / "comparison.md", heading(run))
    return run


def findings_table(findings):
    """Lines of a table of the findings of a run. Numbers that do not exist are None."""
    lines = ["| quantity | reference | measured | error | allowed | |", "|---|---|---|---|---|---|"]
    for each in findings:
        number = {key: "–" if each[key] is None else f"{each[key]:.5g}"
                  for key in ("reference", "measured")}
        error = "–" if each["error"] is None else f"{100 * each['error']:.2g} %"
        is_stated = each["allowed"] is None
        allowed = "stated" if is_stated else f"{100 * each['allowed']:.2g} %"
        verdict = "" if is_stated else "holds" if each["holds"] else "**no**"
        lines.append(f"| {each['quantity']} | {number['reference']} | {number['measured']} | {error} "
                     f"| {allowed} | {verdict} |")
    return lines
