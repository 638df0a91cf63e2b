# SPDX-License-Identifier: MIT
"""A column of water collapses in a tank. Writes dam.pvd, for ParaView."""
import silt

l0 = 0.02  # particle spacing [m]
dam = silt.flow_simulation(
    position=silt.lattice((0, 0), (0.4, 0.8), l0), spacing=l0, tank=(1.6, 1.2),
    speed_scale=2.8)  # √(g H) [m/s], which limits the time step from the beginning
dam.run(until=1.0, output_every=0.02, observer=silt.VtkSeries("dam"))
print(f"The pressure in the right corner is {dam.wall_pressure((1.6, 0), (-1, 0)):.0f} Pa.")
