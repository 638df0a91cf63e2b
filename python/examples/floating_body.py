# SPDX-License-Identifier: MIT
"""Waves of a paddle lift a floating box. Writes water.pvd and walls.pvd, for ParaView."""
import numpy as np

import silt

l0 = 0.02  # particle spacing [m]
period = 1.0  # of the waves [s]


def paddle(t):
    """Shift [m] and turn [rad]: 3 cm to both sides, growing from rest."""
    s = min(t / period, 1)
    return (0.03 * s**2 * (3 - 2 * s) * np.sin(2 * np.pi * t / period), 0), 0


box = silt.faces_of_box((0.9, 0.18), (1.1, 0.3))
water = silt.flow_simulation(
    position=silt.remove_inside(silt.lattice((0.2, 0), (2, 0.24), l0), box, l0), spacing=l0, tank=(2, 0.6),
    speed_scale=1.5,
    moving=[silt.MovingFaces(faces=silt.faces_of_polyline([(0.2, 0.6), (0.2, 0)]), motion=paddle)],
    bodies=[silt.FloatingBody(faces=box, density=500)])

heights = []
water.run(until=3, output_every=0.04, observer=[
    silt.VtkSeries("water"), silt.VtkWalls("walls"), lambda s: heights.append(s.bodies[0].position[1])])
print(f"The box rises and falls by {max(heights) - min(heights):.3f} m.")
