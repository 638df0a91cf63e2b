# SPDX-License-Identifier: MIT
"""The style of all pictures, and functions that write them.

    from support import plot_style as style        # before matplotlib.pyplot
    style.make(folder / "front.png", draw_front, runs)
    style.film(folder / "collapse.gif", figure, numbers, show)

Without Matplotlib, the import prints a message and ends the program with exit code 3.
Font sizes are for figures of width WIDE, shown at the full text width of a page, and of width
NARROW, shown at half of it.
"""

import io
import pathlib
import time

from support.modules import need

need("numpy", "matplotlib")
import matplotlib

matplotlib.use("Agg")
import matplotlib.pyplot as plt
import numpy as np
from matplotlib.colors import LinearSegmentedColormap, ListedColormap
from PIL import Image

LARGEST_FILE = 120_000  # [bytes]

WIDE = 8.2  # [inches]
NARROW = 6.4

# Okabe and Ito's colours, distinguishable with any colour vision.
BLUE = "#0072b2"
ORANGE = "#d55e00"
GREEN = "#009e73"
PURPLE = "#cc79a7"
YELLOW = "#e69f00"
SKY = "#56b4e9"
CURVES = (BLUE, ORANGE, GREEN, PURPLE, YELLOW, SKY)
DARK = "#20242a"
GREY = "#8a9099"
FLOOR = "#e7e3dc"
WALL = "#8f897f"
DASHED = (0, (4, 2.5))

# Both darken monotonically, so that they are also readable in grey. In discrete steps, because a
# picture may be written with 256 colours.
PRESSURE = ListedColormap(matplotlib.colormaps["YlGnBu"](np.linspace(0.28, 1, 20)), "pressure")
SPEED = LinearSegmentedColormap.from_list(
    "speed", ["#ddd6c8", "#f3cf6b", "#ee8434", "#c8313c", "#6a1247"], 20)

matplotlib.rcParams.update({
    "font.size": 10, "axes.titlesize": 10, "axes.labelsize": 10, "figure.titlesize": 10,
    "legend.fontsize": 9, "xtick.labelsize": 9, "ytick.labelsize": 9,
    "axes.titlelocation": "left", "axes.spines.top": False, "axes.spines.right": False,
    "axes.grid": True, "axes.axisbelow": True, "grid.color": "#e4e7eb", "grid.linewidth": 0.8,
    "axes.prop_cycle": matplotlib.cycler(color=CURVES), "lines.linewidth": 1.4,
    "legend.frameon": False, "figure.constrained_layout.use": True, "savefig.dpi": 150,
})


def make(path, draw, *arguments):
    """Prints what is drawn, and writes the figure returned by draw(*arguments), if any."""
    print(f"Drawing {path}", flush=True)
    figure = draw(*arguments)
    if figure is None:
        return
    memory = io.BytesIO()
    figure.savefig(memory, format="png")
    plt.close(figure)
    # All colours if the file is small enough, otherwise as many as possible.
    image = Image.open(memory).convert("RGB")
    for colours in (None, 256, 128, 64, 32):
        file = io.BytesIO()
        few = image if colours is None else image.quantize(
            colours, Image.Quantize.MAXCOVERAGE, dither=Image.Dither.NONE)
        few.save(file, format="png", optimize=True)
        if file.tell() < LARGEST_FILE:
            break
    pathlib.Path(path).write_bytes(file.getvalue())


def film(path, figure, frames, show, rate):
    """An animated GIF with `rate` frames per second; show(frame) draws one and returns its artists,
    which are removed before the next."""
    frames = list(frames)
    print(f"Drawing {path}, {len(frames)} frames", flush=True)
    begin = said = time.monotonic()
    figure.set_dpi(100)
    images = []
    for number, frame in enumerate(frames):
        artists = show(frame)
        figure.canvas.draw()
        # The layout is computed once, so that nothing moves between frames.
        figure.set_layout_engine("none")
        images.append(Image.fromarray(np.asarray(figure.canvas.buffer_rgba())).convert("RGB"))
        for artist in artists:
            artist.remove()
        if time.monotonic() - said > 4:
            said = time.monotonic()
            left = (said - begin) / (number + 1) * (len(frames) - number - 1)
            print(f"  {number + 1} of {len(frames)} frames, {left:.0f} s left", flush=True)
    plt.close(figure)
    # One palette for all frames, so that colours do not flicker.
    some = images[::max(1, len(images) // 4)]
    palette = Image.fromarray(np.concatenate([np.asarray(image) for image in some])).quantize(
        256, Image.Quantize.MAXCOVERAGE)
    images = [image.quantize(palette=palette, dither=Image.Dither.NONE) for image in images]
    images[0].save(path, save_all=True, append_images=images[1:], loop=0,
                   duration=round(1000 / rate))


def range_of(values, *included):
    """Limits of a colour scale that cover all values and those included. If single values would
    more than double it, it covers 99.9 % of the values, and bar_of states the share beyond it."""
    values = np.concatenate([np.ravel(each) for each in values])
    low, high = np.min([*values, *included]), np.max([*values, *included])
    usual = [*np.quantile(values, [0.0005, 0.9995]), *included]
    if high - low > 2 * (max(usual) - min(usual)) > 0:
        low, high = min(usual), max(usual)
    return low, max(high, low + 1e-12)


def bar_of(figure, shown, axes, label, values, **style):
    """A colour bar; if some of the values are beyond it, with an arrow at that end, and their share
    in the label."""
    values = np.concatenate([np.ravel(each) for each in values])
    shares = {"min": np.mean(values < shown.norm.vmin), "max": np.mean(values > shown.norm.vmax)}
    ends = [end for end, share in shares.items() if share > 0]
    for end, side in (("min", "below"), ("max", "above")):
        if end in ends:
            label += f"; {max(100 * shares[end], 0.001):.1g} % of the values are {side}"
    extend = "both" if len(ends) == 2 else ends[0] if ends else "neither"
    bar = figure.colorbar(shown, ax=axes, label=label, extend=extend, **style)
    bar.outline.set_visible(False)
    return bar


def legend_above(figure, axes, columns):
    """The legend of the given axes, for the whole figure, above all its axes."""
    handles, labels = axes.get_legend_handles_labels()
    height = (0.1 + 0.2 * np.ceil(len(labels) / columns)) / figure.get_figheight()
    figure.get_layout_engine().set(rect=(0, 0, 1, 1 - height))
    figure.legend(handles, labels, loc="upper left", ncols=columns, borderaxespad=0.3)


def legend_on_top(axes, columns=4, title=None):
    """A legend above the axes, so that it hides no data, and a title above it."""
    axes.legend(loc="lower left", bbox_to_anchor=(0, 1), ncols=columns, borderaxespad=0.2,
                borderpad=0, columnspacing=1.2, handlelength=1.6, title=title, title_fontsize=10,
                alignment="left")


def box(axes, x, y, labels=("x [m]", "y [m]")):
    """Axes of equal scale in metres over these limits; only outer axes are labelled."""
    axes.set(xlim=x, ylim=y, aspect="equal")
    axes.grid(False)
    place = axes.get_subplotspec()
    if place.is_last_row():
        axes.set_xlabel(labels[0])
    else:
        axes.tick_params(labelbottom=False)
    if place.is_first_col():
        axes.set_ylabel(labels[1])
    else:
        axes.tick_params(labelleft=False)
