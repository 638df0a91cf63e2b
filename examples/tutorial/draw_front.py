#!/usr/bin/env python3
# SPDX-License-Identifier: MIT
"""Draws the front that compare.cpp computed, and the one that Martin and Moyce (1952) measured.

    draw_front.py FRONT.csv PICTURE.png

Needs Matplotlib (Debian: python3-matplotlib).
"""

import pathlib
import sys

sys.path.insert(0, str(pathlib.Path(__file__).resolve().parents[1]))
from support import plot_style as style  # before matplotlib.pyplot

import matplotlib.pyplot as plt
import numpy as np

from support.water import FRONT, REFERENCE, table

RELEASE = 1.44  # Z at which both times are 0, because the experiment does not tell the release


def draw(path):
    figure, axes = plt.subplots(figsize=(style.NARROW, 3.8))
    front, measured = table(pathlib.Path(path)), table(REFERENCE / FRONT)
    curve = front["Z"] > 1.1
    begin = np.interp(RELEASE, front["Z"], front["T"])
    axes.plot(front["T"][curve] - begin, front["Z"][curve], color=style.BLUE, linewidth=2.2,
              label="Silt, 20 particles per width a")
    shown = measured["Z"] > RELEASE - 0.01
    begin = measured["T"][measured["Z"] == RELEASE]
    axes.plot(measured["T"][shown] - begin, measured["Z"][shown], "o", color=style.DARK,
              markersize=5.5, label="Martin & Moyce (1952), experiment")
    axes.set(xlabel=f"time since x = {RELEASE} a, over √(a/2g)", ylabel="x/a",
             title="Front x of a collapsing column of width a and height 2a", xlim=(-0.6, 2.6),
             ylim=(1, 5))
    axes.legend(loc="upper left")
    return figure


def main(arguments):
    if len(arguments) != 2:
        sys.exit(__doc__)
    style.make(arguments[1], draw, arguments[0])


if __name__ == "__main__":
    main(sys.argv[1:])
