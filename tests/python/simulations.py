# SPDX-License-Identifier: MIT
"""Small simulations for the tests, and the hash of their state."""

import struct

import numpy as np

import silt

R = 0.02  # of grains [m]
LAW = silt.CundallStrack(normal_stiffness=1e6, tangential_stiffness=5e5, restitution=0.5, friction_angle=0.46)
L0, D = 0.02, 0.01  # spacing of water, diameter of a grain in it [m]
SOFT = silt.CundallStrack(normal_stiffness=1e3, tangential_stiffness=300, restitution=0.5, friction_angle=0.4)


def grains(**further):
    """Twenty discs above a floor."""
    arguments = {"position": silt.lattice((-0.08, 0.1), (0.08, 0.3), 2 * R), "radius": R, "density": 2500,
                 "law": LAW, "walls": [silt.Plane(normal=(0, 1))]}
    return silt.grain_simulation(**(arguments | further))


def spheres(**further):
    return grains(**({"position": silt.lattice((0, 0, 0), (0.12, 0.12, 0.12), 2 * R),
                      "walls": [silt.Plane(normal=(0, 0, 1))]} | further))


def water(**further):
    """A small column in a tank."""
    arguments = {"position": silt.lattice((0, 0), (0.2, 0.3), 0.02), "spacing": 0.02, "tank": (0.6, 0.5),
                 "speed_scale": 1.7}
    return silt.flow_simulation(**(arguments | further))


def paddle(motion, **further):
    """Water at rest between a wall that moves and the end of the tank."""
    arguments = {"position": silt.lattice((0.1, 0), (0.6, 0.2), 0.02),
                 "moving": silt.MovingFaces(faces=[[(0.1, 0.5), (0.1, 0)]], motion=motion)}
    return water(**(arguments | further))


def floating_box(**further):
    """A box in water, with half of its density."""
    arguments = {"faces": silt.faces_of_box((0.2, 0.15), (0.4, 0.25)), "density": 500}
    body = silt.FloatingBody(**(arguments | further))
    x = silt.remove_inside(silt.lattice((0, 0), (0.6, 0.2), 0.02), arguments["faces"], 0.02)
    return water(position=x, bodies=body)


def discs(**further):
    """In the water of pool(), above the floor."""
    arguments = {"position": silt.lattice((0.02, 0.1), (0.18, 0.2), 1.6 * D), "radius": D / 2, "law": SOFT}
    return grains(**(arguments | further))


def pool(**further):
    return water(**({"tank": (0.2, 0.5)} | further))


def balls(**further):
    """A sphere in the water of tank()."""
    arguments = {"position": [(0.05, 0.05, 0.06)], "radius": D / 2, "law": SOFT}
    return spheres(**(arguments | further))


def tank(**further):
    arguments = {"position": silt.lattice((0, 0, 0), (0.1, 0.1, 0.12), L0), "tank": (0.1, 0.1, 0.3)}
    return water(**(arguments | further))


def bits(simulation):
    """All bits of the state, by field."""
    return {name: values.tobytes() for name, values in simulation.snapshot().items()}


def hash_of(simulation):
    """That of tests/portability/hash.hpp, as text."""
    state = simulation.snapshot()
    columns = [state[name].reshape(len(state["id"]), -1) for name in ("position", "velocity", "spin") if name in state]
    data = struct.pack("<d", simulation.time) + np.ascontiguousarray(np.hstack(columns)).tobytes()
    value = 0xCBF29CE484222325
    for byte in data:
        value = (value ^ byte) * 0x100000001B3 % 2**64
    return f"{value:016x}"
