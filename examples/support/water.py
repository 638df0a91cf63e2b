# SPDX-License-Identifier: MIT
"""Reads, evaluates and draws the output of the MPS examples dam_break and hydrostatic. Reading and
evaluation need NumPy only.

    run = DamBreak("out/dam_break")     run.front_error(), run.roughness(), ...
    tank = Tank("out/hydrostatic")      tank.summary["rer"], tank.pressure, tank.line(), ...
"""

import json
import pathlib

import numpy as np

from support.frames import Series, draw, extent

REFERENCE = pathlib.Path(__file__).resolve().parents[2] / "tests" / "reference"
FRONT = "martin_moyce_1952_n2eq2_front_table2.csv"
HEIGHT = "martin_moyce_1952_n2eq2_height_table6.csv"
POTENTIAL_FLOW = "potential_flow_front.csv"  # by boundary elements, see the beginning of the file

G = 9.81
DENSITY = 1000.0
# Captions of the compared schemes.
NAMES = {"recommended": "Silt, recommended scheme", 0: "Case 00 (original MPS)",
         10: "Case 10 (PNU-MPS)"}


def table(path):
    # NumPy would read the column names from the first comment.
    lines = [line for line in path.read_text().splitlines() if not line.startswith("#")]
    return np.genfromtxt(lines, delimiter=",", names=True)


def moving_average(t, p, window=0.02):
    """Moving average: for each sample, the mean of p within half a window [s]."""
    total = np.concatenate([[0], np.cumsum(p)])
    low = np.searchsorted(t, t - window / 2)
    high = np.searchsorted(t, t + window / 2, side="right")
    return (total[high] - total[low]) / (high - low)


def name_of(case):
    """Of a scheme of dam_break."""
    return NAMES.get(case, case if isinstance(case, str) else f"Case {case:02d}")


class Output:
    """The files that every program writes to its folder."""

    def __init__(self, folder):
        self.folder = pathlib.Path(folder)
        self.summary = json.loads((self.folder / "summary.json").read_text())
        self.options = self.summary["options"]
        self.pressure = np.atleast_1d(table(self.folder / "pressure.csv"))

    @classmethod
    def there(cls, folder):
        """The output of a complete run; None if there is none."""
        return cls(folder) if (pathlib.Path(folder) / "summary.json").exists() else None

    @property
    def series(self):
        return Series(self.folder / "frames.pvd")

    def end(self):
        """Of the pressure signal [s]."""
        return float(self.pressure["t"][-1])

    def has_boiled(self):
        """Whether too much water was lost for meaningful results."""
        return self.summary["particles_lost"] > 0.01 * self.summary["fluid_particles"]

    def roughness(self, begin=0.4, end=np.inf):
        """Rms [Pa] of the first gauge minus its moving average over 0.02 s, over its samples (one
        per step) from `begin` to `end` [s]; None if they span less than that average."""
        t, p = self.pressure["t"], self.pressure["p_1"]
        wanted = (t >= begin) & (t <= end)
        if not wanted.any() or np.ptp(t[wanted]) < 0.02:
            return None
        return float(np.sqrt(np.mean((p - moving_average(t, p))[wanted] ** 2)))

    def peak(self, begin=0.4, end=np.inf):
        """Maximum of the moving average of the first gauge over 0.02 s [Pa]."""
        t = self.pressure["t"]
        wanted = (t >= begin) & (t <= end)
        return float(moving_average(t, self.pressure["p_1"])[wanted].max()) if wanted.any() else None


class DamBreak(Output):
    def __init__(self, folder):
        super().__init__(folder)
        self.front = np.atleast_1d(table(self.folder / "front.csv"))
        case = self.options["case"]
        self.name = name_of(case)
        self.width, self.height = self.options["column"]

    def dimensionless_front(self):
        """T = t √(2g/a) and Z = x/a."""
        return self.front["t"] * np.sqrt(2 * G / self.width), self.front["x_front"] / self.width

    def before_the_wall(self):
        """The rows of the front before it reaches the opposite wall."""
        wall = self.options["tank"][0] / self.width
        return np.maximum.accumulate(self.dimensionless_front()[1]) < 0.998 * wall

    def time_shift(self, at=(1.19, 1.44)):
        """The time of release is unknown in the experiment: shift of T that gives Z = 1.44 at
        T = 1.19."""
        T, Z = self.dimensionless_front()
        if Z.max() < at[1]:
            return None
        after = int(np.argmax(Z >= at[1]))
        return at[0] - np.interp(at[1], Z[after - 1:after + 1], T[after - 1:after + 1])

    def front_error(self):
        """Relative rms deviation of Z from Martin & Moyce for T in 1.19–3.3, after the shift."""
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

    def front_speed(self):
        """Slope dZ/dT over T = 1.5–2.9, after the shift."""
        T, Z = self.dimensionless_front()
        at = np.arange(1.5, 2.9, 0.02)
        return float(np.polyfit(at, np.interp(at - self.time_shift(), T, Z), 1)[0])

    def dimensionless_height(self):
        return self.front["height"] / self.height

    def height_error(self):
        """Relative rms deviation of the residual height from Martin & Moyce for τ ≤ 2.5, unshifted:
        their table of heights has a separate origin of time, which according to the exact solution
        is the same as here."""
        experiment = table(REFERENCE / HEIGHT)
        tau = self.front["t"] * np.sqrt(G / self.width)
        wanted = experiment["tau"] <= min(2.5, tau[-1])
        ours = np.interp(experiment["tau"][wanted], tau, self.dimensionless_height())
        return float(np.sqrt(np.mean((ours / experiment["H"][wanted] - 1) ** 2)))

    def errors_of_potential_flow(self):
        """Relative rms deviation of edge and height from the exact inviscid solution,
        T = 0.5–2.75."""
        exact = table(REFERENCE / POTENTIAL_FLOW)
        T, Z = self.dimensionless_front()
        wanted = (exact["T"] >= 0.5) & (exact["T"] <= min(2.75, T[-1]))
        errors = [np.interp(exact["T"][wanted], T, ours) / exact[name][wanted] - 1
                  for name, ours in (("Z", Z), ("H", self.dimensionless_height()))]
        return [float(np.sqrt(np.mean(error**2))) for error in errors]

    def behind(self, other):
        """Mean delay in T, over Z, of this run's front relative to the other's."""
        until = 0.95 * min(self.options["tank"][0], 1.6) / self.width
        T, Z = self.dimensionless_front()
        T_other, Z_other = other.dimensionless_front()
        return float(np.mean([np.interp(z, Z, T) - np.interp(z, Z_other, T_other)
                              for z in np.arange(1.5, until, 0.25)]))

    def is_martin_moyce(self):
        return abs(self.height / self.width - 2) < 1e-9

    def impulse(self, begin=0.4, end=np.inf):
        """Of the first gauge [Pa s]."""
        t, p = self.pressure["t"], self.pressure["p_1"]
        wanted = (t >= begin) & (t <= end)
        t, p = t[wanted], p[wanted]
        return float(np.sum(0.5 * (p[1:] + p[:-1]) * np.diff(t)))


class Tank(Output):
    def __init__(self, folder):
        super().__init__(folder)
        self.profile = np.atleast_1d(table(self.folder / "profile.csv"))

    def line(self):
        """The straight line through the profile: its slope over ρ g, the depth of its zero [m], and
        the maximum deviation of a layer from it [Pa]. The two layers at the surface are excluded,
        because P = 0 for some of their particles."""
        depth, p = self.profile["depth"][2:], self.profile["p_mean"][2:]
        if len(depth) < 3:
            return None
        slope, at_zero = np.polyfit(depth, p, 1)
        off = np.abs(p - slope * depth - at_zero).max()
        return slope / (DENSITY * G), -at_zero / slope, off


def draw_water(axes, frame, spacing, limits, middle=None):
    """Fluid, coloured by pressure between these limits [kPa], and walls, in 2D; of a 3D run the
    slice at y = middle. Returns the circles of the walls and of the fluid."""
    from support import plot_style as style

    keep = frame["kind"] < 2
    at = frame["position"]
    if middle is not None:
        keep &= np.abs(at[:, 1] - middle) <= 0.51 * spacing
        at = at[:, [0, 2, 1]]
    is_wall = frame["kind"][keep] == 1
    at = at[keep]
    walls = draw(axes, {"position": at[is_wall]}, np.zeros(is_wall.sum()), radius=0.5 * spacing)
    walls.set(array=None, facecolor=style.WALL)
    circles = draw(axes, {"position": at[~is_wall]}, frame["pressure"][keep][~is_wall] / 1e3,
                   radius=0.6 * spacing, cmap=style.PRESSURE,
                   norm=style.plt.Normalize(*limits))
    if not frame["pressure"].any():  # not yet computed
        circles.set(array=None, facecolor=style.GREY)
    return walls, circles


class Tanks:
    """Draws the tank of a run at some times, in 2D; of a 3D run its central slice.

    width: of the tank [m]; middle: [m], of a 3D run.
    """

    def __init__(self, run, times, width, middle=None):
        from support import plot_style as style

        self.run, self.middle = run, middle
        self.spacing = run.options["spacing"]
        self.numbers = sorted({run.series.nearest(time) for time in times})
        self.frames = [run.series[number] for number in self.numbers]
        self.times = run.series.times[self.numbers]
        self.x = (-2 * self.spacing, width + 2 * self.spacing)
        self.y = self.heights(self.frames)
        self.pressures = [frame["pressure"][frame["kind"] == 0] / 1e3 for frame in self.frames]
        self.limits = style.range_of(self.pressures, 0)

    def heights(self, frames):
        """Height of the highest spray in these frames, which may be above the walls."""
        fluid = [{"position": frame["position"][frame["kind"] == 0]} for frame in frames]
        up = 1 if self.middle is None else 2
        return -2 * self.spacing, extent(fluid, up, 3 * self.spacing)[1]

    def aspect(self, y):
        return (y[1] - y[0]) / (self.x[1] - self.x[0])

    def box(self, axes, y):
        from support import plot_style as style

        style.box(axes, self.x, y, ("x [m]", "height [m]"))
        for number, place in enumerate(self.run.options["probes"]):
            axes.plot(place[0], place[-1], "o", color=style.ORANGE, markersize=4.5,
                      markerfacecolor="none", clip_on=False, zorder=4)

    def show(self, axes, number):
        return draw_water(axes, self.frames[number], self.spacing, self.limits, self.middle)

    def figure(self, title):
        """Panels of all times, three per row."""
        from support import plot_style as style

        rows = [self.heights(self.frames[k:k + 3]) for k in range(0, len(self.times), 3)]
        tall = [0.3 + 1.6 * self.aspect(y) for y in rows]
        figure, panels = style.plt.subplots(
            len(rows), 3, figsize=(style.NARROW, 0.9 + sum(tall)), height_ratios=tall,
            sharex=True, squeeze=False)
        for axes in panels.flat[len(self.times):]:
            axes.remove()
        for number, (axes, time) in enumerate(zip(panels.flat, self.times)):
            self.box(axes, rows[number // 3])
            _, circles = self.show(axes, number)
            axes.set_title(f"t = {time:.2f} s" + ("" if time > 0 else " (start)"))
        key = "circle: pressure gauge"
        if not all(frame["pressure"].any() for frame in self.frames):
            key += "; grey: pressure not yet computed"
        figure.suptitle(f"{title}{'; ' if len(title + key) < 65 else chr(10)}{key}", x=0.01,
                        ha="left")
        self.bar(figure, panels.flat[:len(self.times)], circles, shrink=0.8, aspect=30)
        return figure

    def bar(self, figure, axes, circles, **more):
        from support import plot_style as style

        style.bar_of(figure, circles, axes, "pressure [kPa]", self.pressures, **more)

    def film(self, path, title, rate):
        from support import plot_style as style

        figure, axes = style.plt.subplots(figsize=(8, min(9.5, 0.9 + 6.4 * self.aspect(self.y))))
        self.box(axes, self.y)
        figure.suptitle("circle: pressure gauge", x=0.01, ha="left")
        _, circles = artists = self.show(axes, 0)
        self.bar(figure, axes, circles, shrink=0.8, aspect=30)
        for artist in artists:
            artist.remove()

        def show(number):
            axes.set_title(f"{title}, t = {self.times[number]:.2f} s")
            return self.show(axes, number)

        style.film(path, figure, range(len(self.times)), show, rate)
