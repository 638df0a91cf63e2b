# SPDX-License-Identifier: MIT
"""Draws the tanks of dam_break and hydrostatic, with walls of particles or of faces."""

from support.water import Tanks


class TanksWithFaces(Tanks):
    """Also draws the walls that have no particles. height: of these walls [m]."""

    def __init__(self, run, times, width, height, middle=None):
        super().__init__(run, times, width, middle)
        self.size = width, height

    def box(self, axes, y):
        from support import plot_style as style

        super().box(axes, y)
        if self.run.summary["wall_particles"] == 0:
            width, height = self.size
            top = min(height, y[1])
            axes.plot([0, 0, width, width], [top, 0, 0, top], color=style.WALL, linewidth=2,
                      zorder=0.5)
