# SPDX-License-Identifier: MIT
"""An unstable tower of grains collapses. Writes tower.pvd, for ParaView."""
import numpy as np

import silt

R = 0.02  # radius of a grain [m]
tower = silt.grain_simulation(
    position=np.vstack([silt.lattice((-0.1, 0), (0.1, 0.8), 2 * R), [0.3 * R, 0.8 + 2 * R]]),
    radius=R, density=2500, damping=0.5, walls=[silt.Plane(normal=(0, 1))],
    law=silt.CundallStrack(normal_stiffness=1e6, tangential_stiffness=5e5, restitution=0.5, friction_angle=0.46))
tower.run(until=1.5, output_every=0.02, observer=silt.VtkSeries("tower"))
print(f"The heap is {tower['position'][:, 1].max() + R:.3f} m high.")
