# SPDX-License-Identifier: MIT
# %% [markdown]
# # A dam break and a tower, step by step
# Cells for Jupyter, Spyder or VS Code; as a script, it shows the figures one after the other.

# %%
import matplotlib.pyplot as plt
import numpy as np

import silt

# %% [markdown]
# ## Water
# The fluid is an array of positions, here a column in the left corner of a tank.

# %%
l0 = 0.02  # particle spacing [m]
H = 0.8  # height of the column [m]
dam = silt.flow_simulation(position=silt.lattice((0, 0), (0.4, H), l0), spacing=l0, tank=(1.6, 1.2),
                           speed_scale=np.sqrt(9.81 * H))
dam

# %% [markdown]
# An observer is a function of the simulation. What it keeps are copies: `simulation["pressure"][:]`.

# %%
rows, frames = [], []


def observe(simulation):
    x_front, height = simulation.front()
    energies = simulation.energies()
    rows.append([simulation.time, x_front, height, energies["kinetic"], energies["potential"]])
    frames.append((simulation.time, simulation["position"][:], simulation["pressure"][:]))


dam.run(until=0.4, output_every=0.02, observer=observe)
t, x_front, height, kinetic, potential = np.transpose(rows)

# %%
figure, axes = plt.subplots(1, 3, figsize=(12, 3.2), layout="constrained")
for each, (time, x, pressure) in zip(axes, frames[:: len(frames) // 3][1:] + frames[-1:]):
    points = each.scatter(*x.T, c=1e-3 * pressure, s=8, vmin=0, vmax=8)
    each.set(title=f"t = {time:.2f} s", xlabel="x [m]", ylabel="y [m]", xlim=(0, 1.6), ylim=(0, 1), aspect="equal")
figure.colorbar(points, label="pressure [kPa]")
plt.show()

# %%
figure, (left, right) = plt.subplots(1, 2, figsize=(9, 3.2), layout="constrained")
left.plot(t, x_front, label="front")
left.plot(t, height, label="height at the wall")
left.set(xlabel="time [s]", ylabel="[m]")
left.legend()
right.stackplot(t, kinetic, potential, labels=["kinetic", "potential"])
right.set(xlabel="time [s]", ylabel="energy [J/m]")
right.legend(loc="lower right")
plt.show()

# %% [markdown]
# ## Grains
# Columns always show the present values, and can be written to between steps: here, the upper half of a
# tower is pushed.

# %%
R = 0.02  # radius of a grain [m]
tower = silt.grain_simulation(
    position=silt.lattice((-0.1, 0), (0.1, 0.8), 2 * R), radius=R, density=2500, damping=0.5,
    walls=[silt.Plane(normal=(0, 1))],
    law=silt.CundallStrack(normal_stiffness=1e6, tangential_stiffness=5e5, restitution=0.5, friction_angle=0.46))
position = tower["position"]
tower.run(until=0.2)
above = position[:, 1] > 0.4
tower["velocity"][above] += [1.0, 0.0]
tower.run(until=0.6)

# %%
figure, axes = plt.subplots(figsize=(8, 3.8), layout="constrained")
speed = np.linalg.norm(tower["velocity"], axis=1)
axes.scatter(*position[:].T, c=speed, s=60, edgecolors="black")
axes.set(xlabel="x [m]", ylabel="y [m]", aspect="equal", title=f"t = {tower.time:.2f} s")
plt.show()
