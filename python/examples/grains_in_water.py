"""Sand sinks in a tank of water. Writes sand.pvd, for ParaView."""
import math

import silt

l0, d = 0.02, 0.01  # spacing of the water, diameter of a grain [m]
length, depth = 0.16, 0.2  # of the water [m]
grains = silt.grain_simulation(
    position=silt.lattice((0, 0, 0.1), (length, length, 0.18), 1.6 * d), radius=d / 2, density=2650,
    law=silt.CundallStrack(
        normal_stiffness=1000, tangential_stiffness=300, restitution=0.5, friction_angle=0.4),
    walls=[silt.BoxWall(lower=(0, 0, 0), upper=(length, length, math.inf))])
water = silt.flow_simulation(
    position=silt.lattice((0, 0, 0), (length, length, depth), l0), spacing=l0, tank=(length, length, 0.3),
    speed_scale=1.4)
sand = silt.Coupled(grains, water, drag="gidaspow", make_room=True)
sand.let_fluid_settle(max_steps=20)

height = grains["position"][:, 2].mean()
sand.run(until=0.5, output_every=0.02, observer=silt.VtkSeries("sand"))
sunk = height - grains["position"][:, 2].mean()
print(f"The sand has sunk by {sunk:.3f} m; {grains['fluid_share'].mean():.0%} of the volume is water there.")
