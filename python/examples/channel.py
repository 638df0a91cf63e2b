"""Fast water flows over a sill and falls out of a channel. Writes channel.pvd, for ParaView."""
import math

import silt

l0 = 0.02  # particle spacing [m]
speed, depth = 2.0, 0.1  # of the water that enters [m/s, m]
channel = silt.flow_simulation(
    position=silt.lattice((0.1, 0), (0.1 + l0, depth), l0), velocity=(speed, 0), spacing=l0, tank=(1.6, 0.6),
    speed_scale=speed, walls=silt.faces_of_polyline([(0.6, 0), (0.7, 0.04), (0.8, 0)]),
    openings=[silt.Inflow(faces=[[(0.1, 0), (0.1, 0.3)]], velocity=(speed, 0), level=depth),
              silt.Outflow(lower=(1.3, -math.inf), upper=(math.inf, math.inf))])
channel.run(until=1.5, output_every=0.02, observer=silt.VtkSeries("channel"))
entered, left = channel.openings
print(f"{entered.volume:.3f} m² of water have entered, {-left.volume:.3f} m² have left.")
