# SPDX-License-Identifier: MIT
"""Laws, walls and boxes: what a simulation of grains is made of, besides arrays."""

from __future__ import annotations

import dataclasses

import numpy as np

from . import _silt, arguments
from .error import Error


def lattice(lower, upper, spacing: float) -> np.ndarray:
    """Centres of the cells of edge `spacing` [m] that fill the box from its lower corner.

    lower, upper    corners of the box, 2 or 3 numbers [m]

    Returns an array of shape (n, 2) or (n, 3) [m]; x varies fastest.
    """
    return _silt.lattice(list(arguments.vector("lattice: lower", lower)),
                         list(arguments.vector("lattice: upper", upper)),
                         arguments.number("lattice: spacing", spacing))


# --- laws ------------------------------------------------------------------------------------------


class _Law:
    """Base of the laws, all of whose attributes are numbers."""

    def __post_init__(self):
        arguments.convert(self, **{field.name: arguments.number for field in dataclasses.fields(self)})


@dataclasses.dataclass(frozen=True, kw_only=True)
class CundallStrack(_Law):
    """Linear springs and dashpots with Coulomb friction, after Cundall and Strack.

    normal_stiffness        [N/m], above 0
    tangential_stiffness    [N/m]; 0: no friction
    restitution             coefficient of normal restitution [-], in (0, 1]
    friction_angle          [rad], in [0, π/2)
    """

    normal_stiffness: float
    tangential_stiffness: float = 0.0
    restitution: float = 1.0
    friction_angle: float = 0.0


@dataclasses.dataclass(frozen=True, kw_only=True)
class LinearSpringDashpot(_Law):
    """A linear spring and dashpot along the normal, a linear spring with Coulomb friction across it.

    normal_stiffness        [N/m], above 0
    tangential_stiffness    [N/m], above 0
    restitution             coefficient of normal restitution [-], in (0, 1]
    friction_angle          [rad], in [0, π/2)
    """

    normal_stiffness: float
    tangential_stiffness: float
    restitution: float = 1.0
    friction_angle: float = 0.0


@dataclasses.dataclass(frozen=True, kw_only=True)
class HertzMindlin(_Law):
    """Elastic spheres: Hertz's normal force, and Mindlin's tangential force with Coulomb friction.

    young_modulus     [Pa], above 0
    poisson_ratio     [-], in (-1, 1/2]
    restitution       coefficient of normal restitution [-], in (0, 1]
    friction_angle    [rad], in [0, π/2)
    """

    young_modulus: float
    poisson_ratio: float
    restitution: float = 1.0
    friction_angle: float = 0.0


LAWS = (CundallStrack, LinearSpringDashpot, HertzMindlin)

# --- walls -----------------------------------------------------------------------------------------


def _side(name, value):
    return arguments.choice(name, value, ("inside", "outside"))


@dataclasses.dataclass(frozen=True, kw_only=True)
class Plane:
    """A half-space: everything behind the plane is solid. In 2D the plane is a line.

    normal    out of the solid, 2 or 3 numbers, of any length but 0
    point     any point of the plane [m]; the origin if not given
    """

    normal: tuple[float, ...]
    point: tuple[float, ...] | None = None

    def __post_init__(self):
        arguments.convert(self, normal=arguments.vector)
        if self.point is None:
            object.__setattr__(self, "point", (0.0,) * len(self.normal))
        arguments.convert(self, point=arguments.vector)


@dataclasses.dataclass(frozen=True, kw_only=True)
class BoxWall:
    """All sides of a box: a container, or with grains="outside" a solid block.

    lower, upper    corners, 2 or 3 numbers [m]; math.inf in `upper`: no wall there, such as no lid
    """

    lower: tuple[float, ...]
    upper: tuple[float, ...]
    grains: str = "inside"

    def __post_init__(self):
        arguments.convert(self, lower=arguments.vector, upper=arguments.vector, grains=_side)


@dataclasses.dataclass(frozen=True, kw_only=True)
class Circle:
    """A circular container in 2D, or with grains="outside" a solid disc.

    centre    2 numbers [m]
    radius    [m], above 0
    """

    centre: tuple[float, ...]
    radius: float
    grains: str = "inside"

    def __post_init__(self):
        arguments.convert(self, centre=arguments.vector, radius=arguments.number, grains=_side)


@dataclasses.dataclass(frozen=True, kw_only=True)
class Segment:
    """A thin straight wall in 2D, which acts on both sides.

    start, end    2 numbers each [m]
    """

    start: tuple[float, ...]
    end: tuple[float, ...]

    def __post_init__(self):
        arguments.convert(self, start=arguments.vector, end=arguments.vector)


@dataclasses.dataclass(frozen=True, kw_only=True, eq=False)
class Polyline:
    """A thin wall of consecutive segments in 2D, which acts on both sides.

    points    array of shape (n, 2) [m]
    closed    the last point is connected to the first
    """

    points: np.ndarray
    closed: bool = False

    def __post_init__(self):
        arguments.convert(self, points=arguments.points, closed=arguments.flag)
        if self.points.shape[1] != 2:
            raise Error(f"Polyline: points has the shape {self.points.shape}; give (n, 2)")


@dataclasses.dataclass(frozen=True, kw_only=True)
class Cylinder:
    """A pipe or drum around the grains in 3D, or with grains="outside" a solid column.

    start, end    two points of its axis, 3 numbers each [m]
    radius        [m], above 0
    ends          has flat ends at the two points; otherwise it is infinitely long
    """

    start: tuple[float, ...]
    end: tuple[float, ...]
    radius: float
    grains: str = "inside"
    ends: bool = False

    def __post_init__(self):
        arguments.convert(self, start=arguments.vector, end=arguments.vector, radius=arguments.number, grains=_side,
                          ends=arguments.flag)


@dataclasses.dataclass(frozen=True, kw_only=True, eq=False)
class MeshWall:
    """A thin surface of triangles in 3D, which acts on both sides.

    triangles    array of shape (n, 3, 3): the corners of each triangle [m]
    """

    triangles: np.ndarray

    def __post_init__(self):
        arguments.convert(self, triangles=arguments.array)
        if self.triangles.ndim != 3 or self.triangles.shape[1:] != (3, 3):
            raise Error(f"MeshWall: triangles has the shape {self.triangles.shape}; give (n, 3, 3)")

    @property
    def corners(self) -> np.ndarray:
        """Of all triangles, of shape (3 n, 3) [m]."""
        return self.triangles.reshape(-1, 3)


WALLS = (Plane, BoxWall, Circle, Segment, Polyline, Cylinder, MeshWall)

# --- the box ---------------------------------------------------------------------------------------


@dataclasses.dataclass(frozen=True, kw_only=True)
class Box:
    """The space of the grains. It has no walls; without one, space is unbounded.

    lower, upper    corners, 2 or 3 numbers [m]; infinite along an unbounded axis
    periodic        for each axis, whether it is periodic; none if not given
    on_escape       what happens to a grain that leaves: "refuse" raises an error, "remove" removes it
    """

    lower: tuple[float, ...]
    upper: tuple[float, ...]
    periodic: tuple[bool, ...] | None = None
    on_escape: str = "refuse"

    def __post_init__(self):
        arguments.convert(self, lower=arguments.vector, upper=arguments.vector,
                          on_escape=lambda name, value: arguments.choice(name, value, ("refuse", "remove")))
        periodic = (False,) * len(self.lower) if self.periodic is None else self.periodic
        object.__setattr__(self, "periodic", periodic)
        arguments.convert(self, periodic=arguments.flags)

