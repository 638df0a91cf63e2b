# SPDX-License-Identifier: MIT
"""Reads and draws the frames that silt::VtkSeries writes; shared by the plot scripts.

    series = Series("out/broken_tower/frames.pvd")
    series.times                     times of the frames [s]
    frame = series[3]                dict of arrays by field: frame["position"], frame["id"], ...
    draw(axes, frame, speed(frame))  particles as circles of their true size

Reading needs NumPy only; drawing also needs Matplotlib.
"""

import base64
import pathlib
import xml.etree.ElementTree as xml

import numpy as np

TYPES = {
    "Float32": "f4", "Float64": "f8",
    "Int8": "i1", "Int16": "i2", "Int32": "i4", "Int64": "i8",
    "UInt8": "u1", "UInt16": "u2", "UInt32": "u4", "UInt64": "u8",
}


def read_frame(path):
    """All arrays of one .vtu file, by name: (n,) for scalars, (n, 3) for vectors."""
    root = xml.parse(path).getroot()
    order = "<" if root.get("byte_order") == "LittleEndian" else ">"
    length = np.dtype(order + TYPES[root.get("header_type")]).itemsize
    arrays = {}
    for array in root.iter("DataArray"):
        kind = np.dtype(order + TYPES[array.get("type")])
        values = np.frombuffer(base64.b64decode(array.text), kind, offset=length)
        width = int(array.get("NumberOfComponents"))
        arrays[array.get("Name")] = values.reshape(-1, width) if width > 1 else values
    return arrays


class Series:
    """The frames listed in a .pvd file, read on demand."""

    def __init__(self, path):
        path = pathlib.Path(path)
        sets = list(xml.parse(path).getroot().iter("DataSet"))
        self.times = np.array([float(each.get("timestep")) for each in sets])
        self.files = [path.parent / each.get("file") for each in sets]

    def __len__(self):
        return len(self.files)

    def __getitem__(self, number):
        return read_frame(self.files[number])

    def nearest(self, time):
        """Number of the frame nearest to a time [s]."""
        return int(np.argmin(np.abs(self.times - time)))


def speed(frame):
    """|velocity| [m/s]."""
    return np.linalg.norm(frame["velocity"], axis=1)


def draw(axes, frame, colours, radius=None, edge=0.0, **style):
    """Particles as circles of their true size, coloured by the given values.

    radius: of all particles [m]; default: that of the frame. edge: width of outlines [points].
    Other style arguments (cmap, norm, ...) are passed to Matplotlib's EllipseCollection. Returns
    the collection, for a colour bar.
    """
    from matplotlib.collections import EllipseCollection

    x = frame["position"][:, :2]
    d = 2 * (frame["radius"] if radius is None else np.full(len(x), radius))
    circles = EllipseCollection(
        d, d, np.zeros(len(d)), units="xy", offsets=x, offset_transform=axes.transData,
        linewidths=edge, edgecolors="#20242a" if edge else "none", **style)
    circles.set_array(np.asarray(colours, dtype=float))
    axes.add_collection(circles)
    return circles


def extent(frames, axis, radius=0.0):
    """Lowest and highest coordinate of any particle of the frames [m]."""
    x = [frame["position"][:, axis] for frame in frames if len(frame["position"])]
    return min(each.min() for each in x) - radius, max(each.max() for each in x) + radius
