# SPDX-License-Identifier: MIT
"""How to read, change and observe a simulation. The blocks of docs/python.md are lines of this script."""
import numpy as np

import silt

R = 0.02  # radius of a grain [m]
heap = silt.grain_simulation(
    position=silt.lattice((-0.1, 0), (0.1, 0.4), 2 * R), radius=R, density=2500,
    walls=[silt.Plane(normal=(0, 1))],
    law=silt.CundallStrack(normal_stiffness=1e6, tangential_stiffness=5e5, restitution=0.5, friction_angle=0.46))

# Read and write.
velocity = heap["velocity"]  # always the present values
heap.run(until=0.1)
fastest = np.linalg.norm(velocity, axis=1).max()  # [m/s]
upper = heap["position"][:, 1] > 0.2
velocity[upper] = (1, 0)
heap["velocity"] += (0, 0.1)
before = velocity[:]  # a copy, which stays as it is
heap.run(until=0.2)
moved = not np.array_equal(velocity, before)

# The memory itself.
x = heap["position"].view(writable=True)  # no copy
x[:, 0] += 0.5
try:
    heap.step()
except silt.Error as error:
    print(error.what)
del x
heap.step()

# By ids.
heap.remove(heap.ids[heap["position"][:, 1] > 0.25])
state = heap.snapshot()
place = dict(zip(state["id"].tolist(), state["position"], strict=True))

# Observe.
heights = []


def observe(simulation):
    heights.append((simulation.time, simulation["position"][:, 1].max()))


heap.run(until=0.4, output_every=0.05, observer=observe)
heap.run(until=0.5, output_every=0.05, observer=[observe, silt.VtkSeries("heap")])

# Errors.
try:
    silt.lattice((0, 0), (1, 1), -0.1)
except silt.Error as error:
    sentence = error.what
heap["velocity"][0] = np.nan
try:
    heap.run(until=1)
except silt.Error as error:
    where = (error.id, error.step, error.time)
