# SPDX-License-Identifier: MIT
"""Walls of flows that move, bodies that float in them, and the faces of both."""

from __future__ import annotations

import dataclasses
from collections.abc import Callable

import numpy as np

from . import _silt, arguments
from .error import Error

# --- faces -----------------------------------------------------------------------------------------


def faces_of_box(lower, upper, *, open_top: bool = False) -> np.ndarray:
    """Faces on all sides of a box, with normals into it.

    lower, upper    corners, 2 or 3 numbers [m]
    open_top        without the upper side of the last axis, as a tank

    Returns an array of shape (n, 2, 2) in 2D, the ends of segments, (n, 3, 3) in 3D, the corners of triangles [m].
    """
    return _silt.faces_of_box(list(arguments.vector("faces_of_box: lower", lower)),
                              list(arguments.vector("faces_of_box: upper", upper)),
                              arguments.flag("faces_of_box: open_top", open_top))


def faces_of_polyline(points, *, closed: bool = False) -> np.ndarray:
    """The segments between consecutive points in 2D, with normals on the left of their direction.

    points    array of shape (n, 2) [m], at least two
    closed    the last point is connected to the first

    Returns an array of shape (n, 2, 2) [m], (n − 1, 2, 2) if it is not closed.
    """
    corners = arguments.points("faces_of_polyline: points", points)
    if corners.shape[1] != 2 or len(corners) < 2:
        raise Error(f"faces_of_polyline: points has the shape {corners.shape}; give (n, 2), at least two")
    if arguments.flag("faces_of_polyline: closed", closed):
        corners = np.vstack([corners, corners[:1]])
    return np.stack([corners[:-1], corners[1:]], axis=1)


def faces_of_disc(centre, radius: float, edge: float) -> np.ndarray:
    """A regular polygon with the area of a disc, and normals outwards.

    centre    2 numbers [m]
    radius    of the disc [m]
    edge      length of its edges, at most about [m], at least a thousandth of the radius

    Returns an array of shape (n, 2, 2), the ends of segments [m].
    """
    return _silt.faces_of_disc(list(arguments.vector("faces_of_disc: centre", centre)),
                               arguments.number("faces_of_disc: radius", radius),
                               arguments.number("faces_of_disc: edge", edge))


def faces_of_sphere(centre, radius: float, edge: float) -> np.ndarray:
    """Triangles with the volume of a sphere, and normals outwards: an icosahedron, divided.

    centre    3 numbers [m]
    radius    of the sphere [m]
    edge      length of the edges, at most about [m], at least a hundredth of the radius

    Returns an array of shape (n, 3, 3), the corners of triangles [m].
    """
    return _silt.faces_of_sphere(list(arguments.vector("faces_of_sphere: centre", centre)),
                                 arguments.number("faces_of_sphere: radius", radius),
                                 arguments.number("faces_of_sphere: edge", edge))


def remove_inside(position, faces, spacing: float) -> np.ndarray:
    """The positions at which fluid is beside a body: not inside of its closed faces, nor closer to them than 0.45
    spacings.

    position    shape (n, 2) or (n, 3) [m]
    faces       of the body, see faces_of_box()
    spacing     of the particles [m]

    Returns an array of shape (k, 2) or (k, 3) [m], in the same order.
    """
    x = arguments.points("remove_inside: position", position)
    return _silt.without_inside(x, arguments.faces("remove_inside: faces", faces),
                                arguments.number("remove_inside: spacing", spacing))


# --- motions ---------------------------------------------------------------------------------------


@dataclasses.dataclass(frozen=True, kw_only=True)
class Translation:
    """At constant velocity: x = X + V t.

    velocity    V, 2 or 3 numbers [m/s]
    """

    velocity: tuple[float, ...]

    def __post_init__(self):
        arguments.convert(self, velocity=arguments.vector)


@dataclasses.dataclass(frozen=True, kw_only=True)
class Rotation:
    """About a point in 2D, or an axis in 3D, at constant spin.

    spin     a number in 2D, 3 numbers along the axis in 3D [1/s]
    about    the point, or any point of the axis, 2 or 3 numbers [m]; the origin if not given
    """

    spin: tuple[float, ...]
    about: tuple[float, ...] | None = None

    def __post_init__(self):
        arguments.convert(self, spin=arguments.angular, about=arguments.optional(arguments.vector))


@dataclasses.dataclass(frozen=True, kw_only=True)
class Vibration:
    """Harmonic: x = X + A sin(2π f t + φ).

    amplitude    A, 2 or 3 numbers [m]
    frequency    f [Hz]
    phase        φ [rad]
    """

    amplitude: tuple[float, ...]
    frequency: float
    phase: float = 0.0

    def __post_init__(self):
        arguments.convert(self, amplitude=arguments.vector, frequency=arguments.number, phase=arguments.number)


def _turns(name: str, value) -> np.ndarray:
    turns = arguments.array(name, value)
    if turns.ndim == 1:
        turns = turns.reshape(-1, 1)
    if turns.ndim != 2 or turns.shape[1] not in (1, 3):
        raise Error(f"{name} has the shape {turns.shape}; give (n,) in 2D, (n, 3) in 3D")
    return np.ascontiguousarray(turns)


def _times(name: str, value) -> np.ndarray:
    times = arguments.array(name, value)
    if times.ndim != 1:
        raise Error(f"{name} has the shape {times.shape}; give (n,)")
    return times


@dataclasses.dataclass(frozen=True, kw_only=True, eq=False)
class TabulatedMotion:
    """Through given positions at given times, with a continuous velocity; at rest before the first and after the
    last one.

    times     shape (n,), increasing [s]
    shifts    shape (n, 2) or (n, 3) [m]; none if not given
    turns     angles, shape (n,), in 2D, rotation vectors, shape (n, 3), in 3D [rad]; none if not given
    about     the point about which it turns, before the shift, 2 or 3 numbers [m]; the origin if not given
    """

    times: np.ndarray
    shifts: np.ndarray | None = None
    turns: np.ndarray | None = None
    about: tuple[float, ...] | None = None

    def __post_init__(self):
        arguments.convert(self, times=_times, shifts=arguments.optional(arguments.points),
                          turns=arguments.optional(_turns), about=arguments.optional(arguments.vector))


def _vector_and_angular(name: str, form: str, value) -> tuple[float, ...]:
    """Both, one after the other, of what a function has returned."""
    try:
        first, second = value
    except (TypeError, ValueError):
        raise Error(f"{name} returned {value!r}; let it return {form}, such as ((0.1, 0), 0) in 2D") from None
    return (*arguments.vector(f"{name}: the first of what it returned", first),
            *arguments.angular(f"{name}: the second of what it returned", second))


@dataclasses.dataclass(frozen=True, kw_only=True)
class MotionFunction:
    """Any function of the time, which should have a continuous second derivative.

    function    function(t), of the time [s]: returns the shift, 2 or 3 numbers [m], and the turn [rad], an angle in
                2D, a rotation vector in 3D: ((0.1, 0), 0). It is called several times in a step, also for times
                just before and after it, and must depend on the time alone
    about       the point about which it turns, before the shift, 2 or 3 numbers [m]; the origin if not given
    """

    function: Callable
    about: tuple[float, ...] | None = None

    def __post_init__(self):
        if not callable(self.function):
            raise Error(f"MotionFunction: function = {self.function!r} cannot be called; give a function of the time")
        arguments.convert(self, about=arguments.optional(arguments.vector))

    def _numbers(self, time: float) -> tuple[float, ...]:
        return _vector_and_angular("MotionFunction: function", "the shift and the turn", self.function(time))


MOTIONS = (Translation, Rotation, Vibration, TabulatedMotion, MotionFunction)

# --- walls and bodies ------------------------------------------------------------------------------


@dataclasses.dataclass(frozen=True, kw_only=True, eq=False)
class MovingFaces:
    """Faces of the walls of a flow that move together, as a rigid body.

    faces     where they are defined, shape (n, 2, 2) or (n, 3, 3) [m], see faces_of_box()
    motion    Translation, Rotation, Vibration, TabulatedMotion, MotionFunction, or the function of a MotionFunction
    """

    faces: np.ndarray
    motion: object

    def __post_init__(self):
        arguments.convert(self, faces=arguments.faces)
        if isinstance(self.motion, MOTIONS):
            return
        if isinstance(self.motion, type) or not callable(self.motion):
            raise Error(f"MovingFaces: motion = {self.motion!r} is none; give a Vibration, for example, or a function "
                        "of the time")
        object.__setattr__(self, "motion", MotionFunction(function=self.motion))


@dataclasses.dataclass(frozen=True, kw_only=True, eq=False)
class MassProperties:
    """Of a body, where it is defined.

    mass       [kg], in 2D per metre of depth
    centre     of mass, 2 or 3 numbers [m]
    inertia    about the centre: a number in 2D [kg m² per m], an array of shape (3, 3) in 3D [kg m²]
    """

    mass: float
    centre: tuple[float, ...]
    inertia: float | np.ndarray

    def __post_init__(self):
        arguments.convert(self, mass=arguments.number, centre=arguments.vector, inertia=arguments.array)


@dataclasses.dataclass(frozen=True, kw_only=True, eq=False)
class BodyState:
    """Where a floating body is, and how it moves.

    position           of the centre of mass [m]
    orientation        in 2D the angle by which it has turned [rad], which counts whole turns; in 3D a unit quaternion
                       w, x, y, z
    velocity           of the centre of mass [m/s]
    spin               a number in 2D, 3 numbers in 3D [1/s]
    rotation, shift    a point of the body, given at X [m], is now at rotation @ X + shift
    """

    position: np.ndarray
    orientation: float | np.ndarray
    velocity: np.ndarray
    spin: float | np.ndarray
    rotation: np.ndarray
    shift: np.ndarray

    @classmethod
    def _of(cls, numbers) -> BodyState:
        """From those of state_of_body() in moving_walls.hpp."""
        dimension = 2 if len(numbers) == 12 else 3
        sizes = (2, 1, 2, 1, 4, 2) if dimension == 2 else (3, 4, 3, 3, 9, 3)
        position, orientation, velocity, spin, rotation, shift = np.split(np.array(numbers), np.cumsum(sizes)[:-1])
        if dimension == 2:
            orientation, spin = float(orientation[0]), float(spin[0])
        return cls(position=position, orientation=orientation, velocity=velocity, spin=spin,
                   rotation=rotation.reshape(dimension, dimension), shift=shift)


@dataclasses.dataclass(frozen=True, kw_only=True, eq=False)
class FloatingBody:
    """A rigid body whose surface is a wall of the flow, which moves it.

    faces                closed, shape (n, 2, 2) or (n, 3, 3) [m]: all normals outwards, or all inwards
    density              [kg/m³]; or give mass_properties
    mass_properties      MassProperties, instead of the density
    velocity             of the centre of mass at first, 2 or 3 numbers [m/s]; 0 if not given
    spin                 at first, a number or 3 numbers [1/s]; 0 if not given
    held                 for each axis, whether it keeps its first velocity along it, whatever the load; none if not
                         given
    keeps_orientation    it does not turn
    radius               of a disc or a sphere, about the centre of its volume: its contacts are those of this shape,
                         and its faces, such as those of faces_of_disc(), those of the water only. Begin a spacing l0
                         away from walls and other bodies; as it rolls, its speed is its spin times radius + l0/2. 0: its
                         contacts are those of its faces [m]
    friction             coefficient of its friction on walls, and on other bodies, of which the smaller one counts
    load                 load(state, time) of springs, moorings and the like: returns force [N] and torque about the
                         centre of mass [N m], a number in 2D, such as ((0, 1), 0). It must be a function of the
                         BodyState and the time [s] alone: a checkpoint does not keep it
    """

    faces: np.ndarray
    density: float | None = None
    mass_properties: MassProperties | None = None
    velocity: tuple[float, ...] | None = None
    spin: tuple[float, ...] | None = None
    held: tuple[bool, ...] | None = None
    keeps_orientation: bool = False
    radius: float = 0
    friction: float = 0
    load: Callable | None = None

    def __post_init__(self):
        arguments.convert(
            self, faces=arguments.faces, density=arguments.optional(arguments.number),
            velocity=arguments.optional(arguments.vector), spin=arguments.optional(arguments.angular),
            held=arguments.optional(arguments.flags), keeps_orientation=arguments.flag, radius=arguments.number,
            friction=arguments.number)
        if (self.density is None) == (self.mass_properties is None):
            raise Error(f"FloatingBody: density = {self.density!r} and mass_properties = {self.mass_properties!r}; "
                        "give one of them")
        if self.mass_properties is not None and not isinstance(self.mass_properties, MassProperties):
            raise Error(f"FloatingBody: mass_properties = {self.mass_properties!r} are none; give MassProperties")
        if self.load is not None and not callable(self.load):
            raise Error(f"FloatingBody: load = {self.load!r} cannot be called; give a function of state and time")

    def _load_numbers(self, *numbers: float) -> tuple[float, ...]:
        load = self.load(BodyState._of(numbers[:-1]), numbers[-1])
        return _vector_and_angular("FloatingBody: load", "the force and the torque", load)
