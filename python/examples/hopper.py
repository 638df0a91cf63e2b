# SPDX-License-Identifier: MIT
"""Discs settle in a hopper, then its lid opens; counts those that have left it."""
import numpy as np

import silt

R = 0.0095  # mean radius of a grain [m]
x = silt.lattice((-0.28, 0.72), (0.28, 1.04), 2.45 * R)
hopper = silt.grain_simulation(
    position=x, radius=R * np.random.default_rng(1).uniform(0.8, 1.2, len(x)), density=2500,
    law=silt.CundallStrack(normal_stiffness=1e6, tangential_stiffness=5e5, restitution=0.5, friction_angle=0.46),
    walls=[silt.Segment(start=(-0.06, 0.4), end=(0.06, 0.4)),  # the lid
           silt.Polyline(points=[(-0.3, 1.2), (-0.3, 0.7), (-0.06, 0.4)]),
           silt.Polyline(points=[(0.3, 1.2), (0.3, 0.7), (0.06, 0.4)]),
           silt.BoxWall(lower=(-0.8, 0), upper=(0.8, 1.2))],
    steps_per_contact=20)
hopper.run(until=0.6)
hopper.set_wall_present(0, False)

times, discharged = [], []


def count(simulation):
    times.append(simulation.time)
    discharged.append(int(np.sum(simulation["position"][:, 1] < 0.4)))


hopper.run(until=1.6, output_every=0.05, observer=count)
rate = (discharged[-1] - discharged[4]) / (times[-1] - times[4])
print(f"{discharged[-1]} of {len(hopper)} grains have left the hopper, {rate:.0f} per second.")
