#!/usr/bin/env python3
# SPDX-License-Identifier: MIT
"""Draws the two-dimensional films and pictures of the gallery with Matplotlib.

    draw_gallery_2d.py NAME FOLDER [--frames NUMBER]

Reads the output of the run of this item in FOLDER, and writes FOLDER/NAME.webp.
"""

import json
import pathlib
import sys

sys.path.insert(0, str(pathlib.Path(__file__).resolve().parent))
from support.films import (BANDS, GRAINS, HEAT, INK, WALL, WATER, ListedColormap, Series, Sheet,
                           draw_one_of, np, plt)
from support.frames import draw, speed

FLUID = 0  # of mps::Kind
OVERLAP = 1.4  # diameter of a drawn particle of fluid over the spacing, so that no gaps are seen


def fluid_of(frame):
    """The frame without wall and dummy particles."""
    is_fluid = frame["kind"] == FLUID
    return {name: values[is_fluid] for name, values in frame.items()}


class Layer:
    """Particles that are drawn in the same axes at each frame."""

    def __init__(self, axes, values_of, norm, colours, radius=None, edge=0.35):
        self.axes, self.values_of, self.radius = axes, values_of, radius
        self.edge = 0 if radius else edge
        self.style = {"norm": norm, "cmap": colours}
        self.circles = None

    def show(self, frame):
        if self.circles:
            self.circles.remove()
        self.circles = draw(self.axes, frame, self.values_of(frame), self.radius,
                            self.edge, **self.style)


def film(sheet, series, numbers, layer, change=lambda frame: frame):
    def show(number):
        layer.show(change(series[number]))
        return series.times[number]

    return sheet.film(numbers, show)


def walls(axes, x, y, line=4):
    """A straight line through these points, outside of the particles."""
    axes.plot(x, y, color=WALL, linewidth=line, solid_joinstyle="miter", zorder=0)


def kilopascals(frame):
    return frame["pressure"] / 1000


def tower(series, until, count, half_width, height):
    first = series[0]
    initial = np.empty(int(first["id"].max()) + 1)
    initial[first["id"]] = first["position"][:, 1]
    norm = plt.Normalize(0, initial.max())
    sheet = Sheet(720, 400)
    axes = sheet.axes((0.03, 0.14, 0.81, 0.75), (-half_width, half_width), (-0.03, height))
    walls(axes, (-half_width, half_width), (-0.012, -0.012))
    sheet.scale(axes, 0.2, -half_width, -0.05)
    sheet.bar(norm, GRAINS, "initial height [m]")
    layer = Layer(axes, lambda frame: initial[frame["id"]], norm, GRAINS)
    return film(sheet, series, series.numbers(count, until), layer)


def quickstart_tower(folder, count):
    return tower(Series(folder / "tower.pvd"), 1.2, min(count, 31), 0.9, 0.92)


def broken_tower_2d(folder, count):
    return tower(Series(folder / "frames.pvd"), 2.0, count, 1.6, 1.4)


def dam(series, count, until, length, height, spacing, highest):
    norm = plt.Normalize(0, highest)
    sheet = Sheet(720, 450)
    axes = sheet.axes((0.03, 0.12, 0.81, 0.77), (-0.02, length + 0.02), (-0.02, height))
    walls(axes, (0, 0, length, length), (height, 0, 0, height), 5)
    sheet.scale(axes, 0.2, 0, -0.03)
    sheet.bar(norm, WATER, "pressure [kPa]", extend="max")
    layer = Layer(axes, kilopascals, norm, WATER, OVERLAP * spacing / 2)
    # The first frame has no pressure yet.
    return film(sheet, series, series.numbers(count + 1, until)[1:], layer, fluid_of)


def quickstart_dam(folder, count):
    return dam(Series(folder / "dam.pvd"), count, 1.0, 1.6, 1.0, 0.02, 8)


def dam_break_2d(folder, count):
    return dam(Series(folder / "frames.pvd"), count, 1.2, 1.6, 1.0, 0.01, 8)


def hopper_2d(folder, count):
    """Bands of the bed at rest, whose shape shows the flow."""
    series = Series(folder / "frames.pvd")
    summary = json.loads((folder / "summary.json").read_text(encoding="utf-8"))
    options = summary["options"]
    d = options["diameter"]
    half, slot = options["width"] * d / 2, summary["rates"][-1]["opening_over_d"] * d / 2
    corner = (half - slot) / np.tan(np.radians(options["half_angle"]))
    first = series[0]
    band = np.empty(int(first["id"].max()) + 1)
    band[first["id"]] = (first["position"][:, 1] / (4 * d)).astype(int) % len(BANDS)
    top = first["position"][:, 1].max() + 3 * d
    sheet = Sheet(420, 490)
    axes = sheet.axes((0.04, 0.08, 0.92, 0.8), (-half - d, half + d), (-6 * d, top))
    for side in (-1, 1):
        walls(axes, (side * half, side * half, side * slot), (top, corner, 0))
    sheet.scale(axes, 0.1, -half, -4 * d)
    layer = Layer(axes, lambda frame: band[frame["id"]], plt.Normalize(0, len(BANDS) - 1), ListedColormap(BANDS),
                  edge=0)
    return film(sheet, series, series.numbers(min(count, 21)), layer)


def fluid(folder, count, colours, label, values_of, limits, half_width, extend="neither",
          until=np.inf):
    """A flow of fluid_cases, in a square about the middle of the first frame."""
    series = Series(folder / "frames.pvd")
    summary = json.loads((folder / "summary.json").read_text(encoding="utf-8"))
    x = series[0]["position"]
    centre = (x.min(axis=0) + x.max(axis=0)) / 2
    norm = plt.Normalize(*limits)
    sheet = Sheet(600, 500)
    axes = sheet.axes((0.02, 0.1, 0.8, 0.8), centre[0] + np.array((-half_width, half_width)),
                      centre[1] + np.array((-half_width, half_width)))
    sheet.scale(axes, 0.5, centre[0] - half_width, centre[1] - 1.03 * half_width)
    sheet.bar(norm, colours, label, (0.84, 0.2, 0.02, 0.6), extend)
    layer = Layer(axes, values_of, norm, colours, OVERLAP * summary["options"]["spacing"] / 2)
    return film(sheet, series, series.numbers(count + 1, until)[1:], layer, fluid_of)


def rotating_square(folder, count):
    return fluid(folder, count, WATER.reversed(), "pressure [kPa]", kilopascals, (-0.15, 0), 1.9,
                 "both", 3.7)


def oscillating_drop(folder, count):
    return fluid(folder, count, WATER, "pressure [kPa]", kilopascals, (0, 0.75), 1.75)


def taylor_green(folder, count):
    return fluid(folder, min(count, 30), HEAT, "speed [m/s]", speed, (0, 1), 0.52)


def own_field(folder, count):
    """Grains on a slope and water in a tank, between which the field is conducted in the same way."""
    grains, water = Series(folder / "warm_grains.pvd"), Series(folder / "warm_water.pvd")
    norm = plt.Normalize(300, 400)
    sheet = Sheet(840, 420)
    left = sheet.axes((0.02, 0.1, 0.38, 0.78), (-0.26, 0.56), (-0.02, 0.42))
    right = sheet.axes((0.43, 0.1, 0.42, 0.78), (-0.01, 0.81), (-0.02, 0.5))
    walls(left, (-0.26, 0.56), (-0.005, -0.005))
    walls(right, (0, 0, 0.8, 0.8), (0.5, 0, 0, 0.5), 5)
    sheet.scale(left, 0.1, -0.26, -0.03)
    sheet.scale(right, 0.1, 0, -0.025)
    sheet.bar(norm, HEAT, "temperature [K]", (0.89, 0.2, 0.016, 0.6))

    def temperature(frame):
        return frame["temperature"]

    of_grains = Layer(left, temperature, norm, HEAT)
    of_water = Layer(right, temperature, norm, HEAT, OVERLAP * 0.01)

    def show(number):
        of_grains.show(grains[number])
        of_water.show(fluid_of(water[water.nearest(grains.times[number])]))
        return grains.times[number]

    return sheet.film(grains.numbers(count, 0.7), show)


def own_contact_law(folder, _):
    """The ball at equal intervals of time."""
    series = Series(folder / "bounce_2d.pvd")
    norm = plt.Normalize(0, series.times[-1])
    sheet = Sheet(720, 450)
    axes = sheet.axes((0.03, 0.14, 0.81, 0.76), (-0.02, 0.27), (-0.005, 0.225))
    walls(axes, (-0.02, 0.27), (-0.0015, -0.0015))
    sheet.scale(axes, 0.05, -0.02, -0.008)
    sheet.bar(norm, GRAINS, "time [s]")
    sheet.clock.set_text("a ball at intervals of 10 ms")
    for number in range(0, len(series), 2):
        frame = series[number]
        draw(axes, frame, [series.times[number]], edge=0.4, norm=norm, cmap=GRAINS)
    return [sheet.image()]


def bonded_beam(folder, _):
    """The bent beam, its deflection magnified, with Timoshenko's theory."""
    magnified = 20
    R, E, G, load = 0.01, 2e7, 8e6, 10.0  # those of the program
    frame = Series(folder / "beam.pvd")[0]
    x = frame["position"].copy()
    length = x[:, 0].max()
    s = np.linspace(0, length, 100)
    inertia, area = 2 * R**3 / 3, 2 * R
    exact = -load * (s**2 * (3 * length - s) / (6 * E * inertia) + s / (G * area))
    norm = plt.Normalize(0, 1000 * -x[:, 1].min())
    sheet = Sheet(720, 360)
    axes = sheet.axes((0.03, 0.12, 0.81, 0.74), (-0.03, 0.24), (-0.1, 0.03))
    axes.fill_between((-0.03, -0.012), -0.04, 0.03, color=WALL, linewidth=0)
    shown = dict(frame, position=x * [1, magnified, 1])
    draw(axes, shown, -1000 * x[:, 1], edge=0.5, norm=norm, cmap=GRAINS)
    axes.plot(s, magnified * exact, color=INK, linewidth=1.6, linestyle=(0, (4, 2)),
              label="Timoshenko's beam")
    tip = shown["position"][x[:, 0].argmax()]
    axes.annotate("", (tip[0], tip[1] - 0.035), (tip[0], tip[1] - 0.011),
                  arrowprops={"arrowstyle": "-|>", "color": INK, "linewidth": 1.5})
    axes.text(tip[0] + 0.005, tip[1] - 0.03, f"{load:g} N")
    axes.legend(frameon=False, loc="lower left", bbox_to_anchor=(0.42, 0.02))
    sheet.scale(axes, 0.05, 0, -0.085)
    sheet.bar(norm, GRAINS, "deflection [mm]")
    sheet.clock.set_text(f"bonded grains; deflection magnified {magnified} times")
    return [sheet.image()]


FILMS = (broken_tower_2d, dam_break_2d, hopper_2d, rotating_square, oscillating_drop, taylor_green,
         quickstart_tower, quickstart_dam, own_field, own_contact_law, bonded_beam)

# Frames per second; few frames, because all of the picture changes.
SLOW = {"hopper_2d": 10}

if __name__ == "__main__":
    draw_one_of(FILMS, "Draws a two-dimensional film or picture of the gallery.", 60, SLOW)
