"""A gate opens between two levels of water in a basin with sloping sides. Writes basin.pvd, for ParaView."""
import numpy as np

import silt

l0 = 0.02  # particle spacing [m]
sides = silt.faces_of_polyline([(0, 0.5), (0.3, 0.1), (0.9, 0.1), (1.2, 0.5)])
gate = silt.faces_of_polyline([(0.6, 0.1), (0.6, 0.6)])
basin = {"spacing": l0, "tank": (1.2, 0.6)}
closed = basin | {"walls": np.vstack([sides, gate])}
left = silt.fill(inside=(0.5, 0.2), level=0.35, **closed)
right = silt.fill(inside=(0.7, 0.12), level=0.15, **closed)
x = np.vstack([left.position, right.position])
water = silt.flow_simulation(position=x, walls=sides, speed_scale=1.6, **basin)
water.run(until=0.5, output_every=0.02, observer=silt.VtkSeries("basin"))
moved = water["position"][:, 0].mean() - x[:, 0].mean()
print(f"{left.volume:.4f} m² and {right.volume:.4f} m² of water moved by {moved:.3f} m on average.")
