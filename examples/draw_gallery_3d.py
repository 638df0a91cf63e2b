#!/usr/bin/env python3
# SPDX-License-Identifier: MIT
"""Draws the three-dimensional films of the gallery with VTK, which needs an X server.

    xvfb-run -a draw_gallery_3d.py NAME FOLDER [--frames NUMBER]

Reads the output of the run of this film in FOLDER, and writes FOLDER/NAME.webp.
"""

import json
import pathlib
import sys

sys.path.insert(0, str(pathlib.Path(__file__).resolve().parent))
from support.films import (BANDS, FOAM, GRAINS, HEAT, Series, Sheet, draw_one_of, np, plt,
                           to_rgb)
from support.scenes import Scene


def render(scene, series, numbers, show, bar):
    """The images of a film: show(frame) fills the scene; bar: arguments of Sheet.bar, or None."""
    sheet = Sheet(*scene.size)
    axes = sheet.figure.add_axes((0, 0, 1, 1))
    axes.axis("off")
    picture = axes.imshow(np.zeros((*scene.size[::-1], 3), np.uint8), aspect="auto",
                          interpolation="none")
    if bar:
        sheet.bar(*bar)

    def show_number(number):
        scene.clear()
        show(series[number])
        picture.set_data(scene.pixels())
        return series.times[number]

    return sheet.film(numbers, show_number)


def broken_tower_3d(folder, count):
    """Coloured by the initial height, which shows where each layer goes."""
    series = Series(folder / "frames.pvd")
    first = series[0]
    height = np.empty(int(first["id"].max()) + 1)
    height[first["id"]] = first["position"][:, 1]
    norm = plt.Normalize(0, height.max())
    scene = Scene((500, 375), eye=(3.4, -4.6, 2.1), focus=(0, 0, 0.5), view_angle=18)

    def show(frame):
        x = frame["position"][:, [0, 2, 1]] * [1, -1, 1]  # y is the vertical axis of the run
        scene.spheres(x, frame["radius"], GRAINS(norm(height[frame["id"]])))

    bar = (norm, GRAINS, "initial height [m]", (0.87, 0.52, 0.018, 0.4))
    return render(scene, series, series.numbers(count, 1.6), show, bar)


def edges_of(size):
    """The edges of a box from the origin to its size, except the upper ones."""
    a, b, c = size
    corners = [(0, 0), (a, 0), (a, b), (0, b)]
    floor = [((*p, 0), (*q, 0)) for p, q in zip(corners, corners[1:] + corners[:1])]
    return floor + [((*p, 0), (*p, c)) for p in corners]


def dam_break_3d(folder, count):
    """The surface of the water, coloured by its speed."""
    series = Series(folder / "frames.pvd")
    size, spacing = (1.6, 0.4, 1.45), 0.025
    norm = plt.Normalize(0, 4)
    scene = Scene((560, 420), eye=(2.9, -4.3, 2.2), focus=(0.88, 0.2, 0.5), view_angle=21.5,
                  occlusion=0.15)

    def show(frame):
        x = frame["position"]
        inside = x[:, 2] < size[2]
        v = np.linalg.norm(frame["velocity"], axis=1)
        scene.tubes(edges_of((*size[:2], 0.9)), 0.003, "#8d96a3")
        scene.water(x[inside], v[inside], spacing, size, FOAM, norm)
        scene.cast(x[inside], spacing)

    bar = (norm, FOAM, "speed [m/s]", (0.87, 0.52, 0.018, 0.4), "max")
    return render(scene, series, series.numbers(count + 1)[1:], show, bar)


def vibrating_floor_3d(folder, count):
    """Coloured by speed; the sides of the cell are periodic."""
    series = Series(folder / "frames.pvd")
    options = json.loads((folder / "summary.json").read_text(encoding="utf-8"))["options"]
    d = options["diameter"]
    side, height = options["cell_width"] * d, 14 * d
    norm = plt.Normalize(0, 5)
    scene = Scene((480, 480), eye=(2.9, -3.5, 2.1), focus=(0.52, 0.48, 0.66), view_angle=24,
                  occlusion=2 * d)

    def show(frame):
        x = frame["position"].copy()
        x[:, :2] -= side * np.floor(x[:, :2] / side)
        scene.tubes(edges_of((side, side, height)), 0.005, "#8d96a3")
        scene.spheres(x, frame["radius"], HEAT(norm(np.linalg.norm(frame["velocity"], axis=1))))

    bar = (norm, HEAT, "speed [m/s]", (0.85, 0.55, 0.022, 0.36), "max")
    return render(scene, series, series.numbers(min(count, 21)), show, bar)


def hopper_3d(folder, count):
    """The rear half of the hopper, coloured by bands of the bed at rest."""
    series = Series(folder / "frames.pvd")
    summary = json.loads((folder / "summary.json").read_text(encoding="utf-8"))
    d = summary["options"]["diameter"]
    opening = summary["rates"][-1]["opening_over_d"]
    below = 6 * d  # grains are removed there
    first = series[0]
    band = np.empty(int(first["id"].max()) + 1)
    band[first["id"]] = (first["position"][:, 2] / (3 * d)).astype(int) % len(BANDS)
    colours = np.array([to_rgb(colour) for colour in BANDS])
    top = first["position"][:, 2].max()
    scene = Scene((440, 560), eye=(0.16, -1.15, 0.6), focus=(0, 0, 0.5 * top + 0.7 * below),
                  view_angle=18, floor=1.0, occlusion=2 * d)

    def show(frame):
        x = frame["position"]
        rear = x[:, 1] > -0.2 * d
        scene.mesh(folder / f"opening_{opening:g}.stl", top + 2 * d, (0, 0, below),
                   "#c3c8cf")
        scene.spheres(x[rear] + [0, 0, below], frame["radius"][rear],
                      colours[band[frame["id"][rear]].astype(int)])

    return render(scene, series, series.numbers(min(count, 21)), show, None)


FILMS = (broken_tower_3d, dam_break_3d, vibrating_floor_3d, hopper_3d)

# Frames per second; few frames, because all of the picture changes.
SLOW = {"hopper_3d": 10, "vibrating_floor_3d": 10}

if __name__ == "__main__":
    draw_one_of(FILMS, "Draws a three-dimensional film of the gallery.", 48, SLOW)
