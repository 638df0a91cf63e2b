# SPDX-License-Identifier: MIT
"""Composes the images of the gallery, and writes them as WebP, still or animated.

    sheet = Sheet(720, 540)
    axes = sheet.axes((0.05, 0.1, 0.8, 0.8), (0, 1.6), (0, 1.2))
    sheet.bar(norm, WATER, "pressure [kPa]")
    write("out/dam.webp", sheet.film(range(40), show), 15)

Without its modules, the import prints a message and ends the program with exit code 3.
"""

import argparse
import io
import pathlib
import sys
import time

from support.modules import NOTHING_DRAWN, has, need

need("numpy", "matplotlib")
if not has("vtk"):
    print(f"{pathlib.Path(sys.argv[0]).name}: needs VTK, which {sys.executable} lacks; install: "
          "pip install vtk, or on Debian, for /usr/bin/python3, apt-get install python3-vtk9",
          file=sys.stderr)
    sys.exit(NOTHING_DRAWN)
import matplotlib

matplotlib.use("Agg")
import matplotlib.pyplot as plt
import numpy as np
from matplotlib.colors import LinearSegmentedColormap, ListedColormap, to_rgb
from PIL import Image
from vtk import vtkXMLUnstructuredGridReader
from vtk.util.numpy_support import vtk_to_numpy

from support import frames

LARGEST_FILE = 290_000  # [bytes]
BACKGROUND = "#f5f6f8"
INK = "#20242a"
WALL = "#9aa1aa"
DPI = 100
HOLD = 1.2  # time for which the last frame stays [s]

matplotlib.rcParams.update({
    "font.size": 12, "axes.labelsize": 12, "xtick.labelsize": 11, "ytick.labelsize": 11,
    "text.color": INK, "axes.labelcolor": INK, "xtick.color": INK, "ytick.color": INK,
})

# B. Ottosson, "A perceptual color space for image processing", 2020: linear sRGB to cone responses,
# and their cube roots to lightness and two opponent colours.
CONES = np.array([[0.4122214708, 0.5363325363, 0.0514459929],
                  [0.2119034982, 0.6806995451, 0.1073969566],
                  [0.0883024619, 0.2817188376, 0.6299787005]])
OKLAB = np.array([[0.2104542553, 0.7936177850, -0.0040720468],
                  [1.9779984951, -2.4285922050, 0.4505937099],
                  [0.0259040371, 0.7827717662, -0.8086757660]])


def to_oklab(colours):
    """(n, 3): lightness and two opponent colours of colours as Matplotlib understands them."""
    c = np.array([to_rgb(colour) for colour in colours])
    linear = np.where(c <= 0.04045, c / 12.92, ((c + 0.055) / 1.055) ** 2.4)
    return np.cbrt(linear @ CONES.T) @ OKLAB.T


def from_oklab(lab):
    """(n, 3): red, green and blue from 0 to 1."""
    linear = (lab @ np.linalg.inv(OKLAB).T) ** 3 @ np.linalg.inv(CONES).T
    linear = np.clip(linear, 0, 1)
    return np.where(linear <= 0.0031308, 12.92 * linear, 1.055 * linear ** (1 / 2.4) - 0.055)


def uniform_map(name, *colours):
    """A perceptually uniform colour map through these colours: equal steps of the value are equal
    distances in OKLab."""
    lab = to_oklab(colours)
    length = np.concatenate([[0], np.cumsum(np.linalg.norm(np.diff(lab, axis=0), axis=1))])
    at = np.linspace(0, length[-1], 256)
    return LinearSegmentedColormap.from_list(name, from_oklab(np.column_stack(
        [np.interp(at, length, lab[:, k]) for k in range(3)])))


WATER = uniform_map("water", "#bfe5e8", "#58bfd0", "#1a76b4", "#0a2a5c")
FOAM = uniform_map("foam", "#0b2f6b", "#1a76b4", "#4fbcd3", "#c4f1ec")
HEAT = uniform_map("heat", "#27336b", "#8c4a8f", "#e2705c", "#fbd98a")
GRAINS = uniform_map("grains", "#2b3f8c", "#2495a8", "#86cf8a", "#ffe066")
BANDS = ("#2b3f8c", "#ffe066", "#2495a8", "#e2705c")


class Series(frames.Series):
    """The frames listed in a .pvd file, read by VTK."""

    def __getitem__(self, number):
        reader = vtkXMLUnstructuredGridReader()
        reader.SetFileName(str(self.files[number]))
        reader.Update()
        grid = reader.GetOutput()
        fields = grid.GetPointData()
        return {"position": vtk_to_numpy(grid.GetPoints().GetData())} | {
            fields.GetArrayName(k): vtk_to_numpy(fields.GetArray(k))
            for k in range(fields.GetNumberOfArrays())}

    def numbers(self, count, until=np.inf):
        """Numbers of at most so many frames, evenly spaced, from the first one to a time [s]."""
        last = int(np.flatnonzero(self.times <= until + 1e-9)[-1])
        return np.arange(0, last + 1, max(1, -(-last // (count - 1))))


class Sheet:
    """A figure of a size in pixels, filled by its contents."""

    def __init__(self, width, height):
        self.figure = plt.figure(figsize=(width / DPI, height / DPI), dpi=DPI,
                                 facecolor=BACKGROUND)
        self.clock = self.figure.text(0.03, 0.965, "", va="top", fontsize=15)

    def axes(self, rectangle, x, y):
        """Axes without frame and ticks that contain these limits with equal scales, in the middle of
        a rectangle given as fractions of the figure: left, bottom, width, height."""
        axes = self.figure.add_axes(rectangle)
        axes.set(xlim=x, ylim=y, aspect="equal", anchor="C")
        axes.axis("off")
        return axes

    def bar(self, norm, colours, label, rectangle=(0.87, 0.2, 0.018, 0.6), extend="neither"):
        """A colour bar in a rectangle given as for axes(); extend: the ends beyond which there are
        values."""
        axes = self.figure.add_axes(rectangle)
        bar = self.figure.colorbar(plt.cm.ScalarMappable(norm, colours), cax=axes, extend=extend)
        bar.outline.set_visible(False)
        bar.ax.tick_params(length=0, pad=5)
        bar.set_label(label, labelpad=8)

    def scale(self, axes, length, x, y):
        """A bar that shows a length [m], from this point of the axes."""
        axes.plot([x, x + length], [y, y], color=INK, linewidth=2, solid_capstyle="butt",
                  clip_on=False)
        text = f"{length:g} m" if length >= 0.1 else f"{1000 * length:g} mm"
        axes.annotate(text, (x, y), (0, -5), textcoords="offset points", va="top", fontsize=11,
                      annotation_clip=False)

    def image(self):
        """The present state."""
        self.figure.canvas.draw()
        return Image.fromarray(np.asarray(self.figure.canvas.buffer_rgba())).convert("RGB")

    def film(self, frames, show):
        """The images after show(frame) for each frame, with the time [s] that it returns."""
        frames = list(frames)
        begin = said = time.monotonic()
        images = []
        for number, frame in enumerate(frames):
            self.clock.set_text(f"t = {show(frame):.2f} s")
            images.append(self.image())
            if time.monotonic() - said > 4:
                said = time.monotonic()
                left = (said - begin) / (number + 1) * (len(frames) - number - 1)
                print(f"  {number + 1} of {len(frames)} frames, {left:.0f} s left", flush=True)
        plt.close(self.figure)
        return images


def encoded(images, rate, quality, only_key_frames):
    """The bytes of the file."""
    memory = io.BytesIO()
    further = {}
    if len(images) > 1:
        duration = [round(1000 / rate)] * (len(images) - 1) + [round(1000 * HOLD)]
        further = {"save_all": True, "append_images": images[1:], "duration": duration, "loop": 0}
        further |= {"kmin": 0, "kmax": 1} if only_key_frames else {"minimize_size": True}
    images[0].save(memory, "WEBP", quality=quality, method=4, **further)
    return memory.getvalue()


def best_of(images, rate, lowest, only_key_frames):
    """The encoded images and their quality: the highest for which the file is small enough; None if
    that is below the lowest."""
    low, high = lowest, 95
    best = encoded(images, rate, low, only_key_frames)
    if len(best) > LARGEST_FILE:
        return None
    if len(data := encoded(images, rate, high, only_key_frames)) <= LARGEST_FILE:
        return data, high
    while high - low > 5:
        middle = (low + high) // 2
        if len(data := encoded(images, rate, middle, only_key_frames)) > LARGEST_FILE:
            high = middle
        else:
            low, best = middle, data
    return best, low


def write(path, images, rate=1):
    """Writes the images as a film with this rate [1/s], or a single image as a picture. The file is
    small enough, if necessary because the images are made smaller.

    Frames encoded as differences leave blocks of earlier frames in soft shadows; they are used only if
    key frames alone would be of too low a quality."""
    while (best := best_of(images, rate, 45, True) or best_of(images, rate, 38, False)) is None:
        size = [round(0.88 * pixels) for pixels in images[0].size]
        images = [image.resize(size, Image.LANCZOS) for image in images]
    data, quality = best
    pathlib.Path(path).write_bytes(data)
    width, height = images[0].size
    print(f"Written: {path}, {len(images)} frames of {width} by {height} pixels, quality {quality}, "
          f"{len(data) / 1e3:.0f} kB", flush=True)


def draw_one_of(films, description, count, slow):
    """The main function of a program that draws one of its films or pictures, which the first argument
    names, and writes FOLDER/NAME.webp.

    films: functions of the folder of a run and the maximum number of frames; description: of the
    program; count: default number of frames; slow: frames per second of those films that are shown
    with fewer than 15.
    """
    named = {film.__name__: film for film in films}
    parser = argparse.ArgumentParser(description=description)
    parser.add_argument("name", choices=named)
    parser.add_argument("folder", type=pathlib.Path)
    parser.add_argument("--frames", type=int, default=count,
                        help="maximum number of frames (%(default)s)")
    options = parser.parse_args()
    images = named[options.name](options.folder, options.frames)
    write(options.folder / f"{options.name}.webp", images, slow.get(options.name, 15))
