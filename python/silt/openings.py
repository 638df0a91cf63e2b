# SPDX-License-Identifier: MIT
"""Openings, through which water enters and leaves a flow."""

from __future__ import annotations

import dataclasses
import math

import numpy as np

from . import arguments


@dataclasses.dataclass(frozen=True, kw_only=True, eq=False)
class Inflow:
    """Water enters through faces with a given velocity, as before a piston, which is a wall of the flow.

    faces       in one plane, shape (n, 2, 2) or (n, 3, 3) [m]: not among the other walls, which go on beyond their
                rims by a spacing and a quarter in the direction of the velocity, as a guide of the piston
    velocity    normal to the faces, into the water, 2 or 3 numbers [m/s]
    level       water enters below this height [m], which the surface at the opening should keep; infinite if not given
    start       time at which it begins [s]
    ramp        time in which the speed rises linearly from 0 [s]

    At first, the water ends at the faces, half a spacing from the first particles, or there is none.
    """

    faces: np.ndarray
    velocity: tuple[float, ...]
    level: float = math.inf
    start: float = 0.0
    ramp: float = 0.0

    def __post_init__(self):
        arguments.convert(self, faces=arguments.faces, velocity=arguments.vector, level=arguments.number,
                          start=arguments.number, ramp=arguments.number)


@dataclasses.dataclass(frozen=True, kw_only=True, eq=False)
class Extraction:
    """Water leaves through faces with a given velocity, as behind a piston, which is a wall of the flow.

    faces       see Inflow
    velocity    normal to the faces, out of the water, 2 or 3 numbers [m/s]
    start       time at which it begins [s]
    ramp        time in which the speed rises linearly from 0 [s]
    """

    faces: np.ndarray
    velocity: tuple[float, ...]
    start: float = 0.0
    ramp: float = 0.0

    def __post_init__(self):
        arguments.convert(self, faces=arguments.faces, velocity=arguments.vector, start=arguments.number,
                          ramp=arguments.number)


@dataclasses.dataclass(frozen=True, kw_only=True)
class Outflow:
    """Removes the particles in a box, where water that arrives is free to leave.

    lower, upper    corners, 2 or 3 numbers [m]; infinite along an unbounded axis
    """

    lower: tuple[float, ...]
    upper: tuple[float, ...]

    def __post_init__(self):
        arguments.convert(self, lower=arguments.vector, upper=arguments.vector)


@dataclasses.dataclass(frozen=True, kw_only=True, eq=False)
class PressureOpening:
    """Water enters or leaves through faces, as the pressure of water at rest drives it that is outside.

    faces       in one plane, not among the walls, shape (n, 2, 2) or (n, 3, 3) [m]
    inwards     normal to the faces, into the water, 2 or 3 numbers of any length
    level       of the water outside [m]
    density     of it [kg/m³]
    gravity     [m/s²]
    at_level    pressure at the level [Pa]
    """

    faces: np.ndarray
    inwards: tuple[float, ...]
    level: float
    density: float = 1000.0
    gravity: float = 9.81
    at_level: float = 0.0

    def __post_init__(self):
        arguments.convert(self, faces=arguments.faces, inwards=arguments.vector, level=arguments.number,
                          density=arguments.number, gravity=arguments.number, at_level=arguments.number)


OPENINGS = (Inflow, Extraction, Outflow, PressureOpening)


@dataclasses.dataclass(frozen=True, kw_only=True)
class OpeningState:
    """What has passed an opening so far.

    added, removed    numbers of particles
    volume            of the particles added less those removed [m³], in 2D [m²]
    """

    added: int
    removed: int
    volume: float
