# SPDX-License-Identifier: MIT
"""Simulations of grains and flows."""

from __future__ import annotations

import dataclasses
import os
from collections.abc import Iterable, Sequence

import numpy as np

from . import _silt, arguments
from .advancing import Advancing
from .column import Column
from .error import Error
from .moving import BodyState, FloatingBody, MovingFaces
from .openings import OPENINGS, OpeningState
from .setup import LAWS, WALLS, Box


class Simulation(Advancing):
    """Particles, and what moves them; made by grain_simulation() or flow_simulation().

        simulation["velocity"]    the values of a field of all particles, see Column
        simulation["velocity"] = array

    Particles have an order in memory, which steps may change, and permanent ids, from 0 in the order in
    which they were given. All quantities are in SI units; in 2D the thickness is 1 m, and angles and
    spins are positive counter-clockwise.

    While a step or run is made in one thread, all functions raise silt.Error in other threads. A step
    that fails, with silt.Error, leaves the simulation as it was before.
    """

    __slots__ = ()

    def __init__(self):
        raise TypeError("silt.Simulation is made by silt.grain_simulation() or silt.flow_simulation()")

    @classmethod
    def _of(cls, core) -> Simulation:
        simulation = cls.__new__(cls)
        simulation._core = core
        return simulation

    # --- state

    @property
    def particles_lost(self) -> int:
        """Number of particles that were removed because they left the box."""
        return self._core.particles_lost

    @property
    def ids(self) -> np.ndarray:
        """Permanent ids of the particles, in their present order in memory: a copy of shape (n,)."""
        return self._core.ids

    @property
    def fields(self) -> tuple[str, ...]:
        """Names of the fields."""
        return tuple(self._core.fields)

    def __len__(self) -> int:
        """Number of particles."""
        return self._core.size

    def __getitem__(self, field: str) -> Column:
        """The values of a field, see Column. The velocities of grains are those of half a time step before
        time(): snapshot() has all quantities at the same time."""
        if not isinstance(field, str):
            raise Error(f"Simulation: {field!r} is not the name of a field; "
                        f"give one of {', '.join(self.fields)}")
        return Column(self, field)

    def __setitem__(self, field: str, values) -> None:
        if isinstance(values, Column) and values.simulation is self and values.name == field:
            return  # simulation["velocity"] += …, which has written them
        self[field][...] = values

    def __iter__(self):
        raise TypeError("a silt.Simulation is not a sequence; its fields are in Simulation.fields")

    def __contains__(self, field) -> bool:
        return field in self.fields

    def __repr__(self) -> str:
        return (f"<silt.Simulation in {self.dimension}D: {len(self)} particles at step {self.steps}, "
                f"t = {self.time:g} s>")

    def snapshot(self) -> dict[str, np.ndarray]:
        """Copies of all fields, with all quantities at the present time, in the order of the ids, which are
        "id". Arrays of shape (n,), (n, 2) or (n, 3), see Column."""
        return self._core.snapshot()

    # --- particles

    def remove(self, ids) -> None:
        """Removes the particles with these ids, an array of shape (k,) or one id. Raises silt.Error, and
        removes none, if there is no such particle."""
        numbers = np.atleast_1d(np.asarray(ids))
        if numbers.size == 0:
            return
        if numbers.ndim != 1 or numbers.dtype.kind not in "iu" or numbers.min() < 0:
            raise Error(f"Simulation.remove: ids of the type {numbers.dtype} and shape {numbers.shape}; "
                        "give an array of integers of at least 0, of shape (k,)")
        self._core.remove(numbers.tolist())

    # --- measures

    def energies(self) -> dict[str, float]:
        """Energies by name [J], in 2D per metre of thickness: "kinetic" and "potential" (zero at the origin);
        of grains also "rotational", and "elastic", in the contacts of the last step; of flows without bodies."""
        return self._core.energies()

    def set_wall_present(self, wall: int, present: bool) -> None:
        """Takes a wall of grains away, or puts it back, from the next step on. Walls are numbered from 0, in
        the order in which they were given."""
        self._core.set_wall_present(arguments.count("Simulation: wall", wall),
                                    arguments.flag("Simulation.set_wall_present: present", present))

    def is_wall_present(self, wall: int) -> bool:
        """Whether a wall of grains acts on them."""
        return self._core.is_wall_present(arguments.count("Simulation: wall", wall))

    def wall_load(self, wall: int) -> tuple[np.ndarray, np.ndarray]:
        """Force [N] of all grains on a wall in the last step, and its torque about the origin [N m]: arrays of
        2 and 1 numbers in 2D (per metre of thickness), of 3 and 3 in 3D. Of a flow, that of the fluid on one of the
        `moving` walls, from both sides, by what stops the fluid there: 0 before the first step."""
        force, torque = self._core.wall_load(arguments.count("Simulation: wall", wall))
        return np.array(force), np.array(torque)

    @property
    def bodies(self) -> tuple[BodyState, ...]:
        """Of a flow: where the bodies are and how they move, in the order in which they were given."""
        return tuple(BodyState._of(self._core.body_state(body)) for body in range(self._core.body_count()))

    def body_load(self, body: int) -> tuple[np.ndarray, np.ndarray]:
        """Force [N] of the fluid on a body of a flow in the last step, and its torque about the centre of mass [N m],
        as wall_load(); without what the `load` of the body returned. Bodies are numbered from 0."""
        force, torque = self._core.body_load(arguments.count("Simulation: body", body))
        return np.array(force), np.array(torque)

    @property
    def openings(self) -> tuple[OpeningState, ...]:
        """Of a flow: what has passed the openings, in the order in which they were given."""
        return tuple(OpeningState(added=added, removed=removed, volume=volume)
                     for added, removed, volume in self._core.openings())

    def front(self) -> tuple[float, float]:
        """Of a flow: the largest x of the fluid along the floor, and its height at the wall at x = 0 [m], both
        without spray."""
        return self._core.front()

    def wall_pressure(self, point, normal) -> float:
        """Of a flow: the pressure at a point of a wall [Pa], extrapolated from the fluid before it.

        point     on the wall, at most half a spacing off, 2 or 3 numbers [m]
        normal    of the wall, into the fluid, 2 or 3 numbers of any length

        Raises silt.Error if the point is farther from all walls. The pressure of a dry wall is 0.
        """
        return self._core.wall_pressure(list(arguments.vector("Simulation.wall_pressure: point", point)),
                                        list(arguments.vector("Simulation.wall_pressure: normal", normal)))


class VtkSeries:
    """Observer that writes frames for ParaView: the folder `path`, and `path`.pvd, the file to open. Of a Coupled,
    one series has both grains and fluid."""

    def __init__(self, path):
        self._frames = _silt.VtkSeries(arguments.path("VtkSeries: path", path))

    def __call__(self, simulation: Advancing) -> None:
        simulation._core.write_frame(self._frames)

    @property
    def frames(self) -> int:
        """Number of frames written so far."""
        return self._frames.frames


class VtkWalls:
    """Observer of flows that writes frames of their walls for ParaView, where they are, with their group and velocity:
    the folder `path`, and `path`.pvd, the file to open. Group 0 is at rest; then follow the moving walls, and the
    bodies. Of a Coupled, those of its fluid."""

    def __init__(self, path):
        self._frames = _silt.VtkWalls(arguments.path("VtkWalls: path", path))

    def __call__(self, simulation: Advancing) -> None:
        getattr(simulation, "fluid", simulation)._core.write_walls(self._frames)

    @property
    def frames(self) -> int:
        """Number of frames written so far."""
        return self._frames.frames


def _several(name: str, given, kind: type | tuple[type, ...]) -> list:
    """A list of objects of a class, or of some, from several or one."""
    if isinstance(given, kind):
        return [given]
    objects = list(given) if isinstance(given, Iterable) else [given]
    for place, each in enumerate(objects):
        if not isinstance(each, kind):
            kinds = kind if isinstance(kind, tuple) else (kind,)
            names = " or ".join(each.__name__ for each in kinds)
            raise Error(f"{name}: {each!r}, at place {place}, is none; give {names}")
    return objects


def grain_simulation(
    *,
    position,
    radius,
    density,
    law,
    walls: Sequence = (),
    velocity=0.0,
    gravity=None,
    damping: float = 0.0,
    box: Box | None = None,
    steps_per_contact: float = 50.0,
    max_overlap: float = 0.5,
) -> Simulation:
    """A simulation of grains: discs in 2D, spheres in 3D.

    position             of the centres, shape (n, 2) or (n, 3) [m]
    radius               shape (n,), or a number for all [m]
    density              of the material, shape (n,), or a number for all [kg/m³]
    law                  of all contacts: CundallStrack, LinearSpringDashpot or HertzMindlin
    walls                up to eight: Plane, BoxWall; in 2D Circle, Segment, Polyline; in 3D Cylinder, MeshWall
    velocity             shape (n, 2) or (n, 3), or one vector or number for all [m/s]
    gravity              2 or 3 numbers [m/s²]; 9.81 downwards, along the last axis, if not given
    damping              global damping, a deceleration proportional to the velocity [1/s]
    box                  the space of the grains, see Box
    steps_per_contact    duration of the shortest contact over the time step [-]
    max_overlap          a step fails if an overlap exceeds this share of the radius [-]

    Raises silt.Error if a number is out of range, or an array has another shape or type.
    """
    name = "grain_simulation: "
    x = arguments.points(name + "position", position)
    n, dimension = x.shape
    if not isinstance(law, LAWS):
        raise Error(f"{name}law = {law!r} is none; give a CundallStrack, LinearSpringDashpot or HertzMindlin")
    if isinstance(walls, WALLS):
        walls = [walls]
    walls = list(walls) if isinstance(walls, Iterable) else [walls]
    for place, wall in enumerate(walls):
        if not isinstance(wall, WALLS):
            raise Error(f"{name}walls: {wall!r}, at place {place}, is no wall; give a Plane, for example")
    if box is not None and not isinstance(box, Box):
        raise Error(f"{name}box = {box!r} is none; give a Box")
    if gravity is None:
        gravity = (0.0,) * (dimension - 1) + (-9.81,)
    return Simulation._of(_silt.grains(
        x,
        arguments.finite(name + "velocity", arguments.filled(name + "velocity", velocity, (n, dimension))),
        arguments.filled(name + "radius", radius, (n,)),
        arguments.filled(name + "density", density, (n,)),
        law,
        walls,
        np.array(arguments.vector(name + "gravity", gravity)),
        arguments.number(name + "damping", damping),
        box,
        arguments.number(name + "steps_per_contact", steps_per_contact),
        arguments.number(name + "max_overlap", max_overlap),
    ))


def flow_simulation(
    *,
    position,
    spacing: float,
    tank,
    lid: bool = False,
    walls=None,
    moving: Sequence[MovingFaces] = (),
    bodies: Sequence[FloatingBody] = (),
    openings: Sequence = (),
    velocity=0.0,
    density: float = 1000.0,
    viscosity: float = 1e-6,
    speed_scale: float = 0.0,
    gravity=None,
    on_escape: str = "refuse",
) -> Simulation:
    """A simulation of an incompressible flow with a free surface in a rectangular tank, by the scheme
    mps::Recommended.

    position       of the particles, shape (n, 2) or (n, 3) [m]: on a lattice of the spacing, half a spacing
                   from walls; between walls of any shape from fill()
    spacing        of the particles [m]
    tank           (length, height) in 2D, (length, depth, height) in 3D [m]; a corner is at the origin, and the
                   walls are exactly there: where fluid should rest, they are half a spacing from its lattice
    lid            whether the tank is closed
    walls          further faces at rest, shape (n, 2, 2) or (n, 3, 3) [m], see faces_of_box()
    moving         walls that move, in the tank: several MovingFaces
    bodies         that float: several FloatingBody. Leave out the fluid inside of them, see remove_inside()
    openings       in the tank, away from its sides, where water enters and leaves: several Inflow, Extraction, Outflow,
                   PressureOpening
    velocity       shape (n, 2) or (n, 3), or one vector or number for all [m/s]
    density        [kg/m³]
    viscosity      kinematic [m²/s]
    speed_scale    expected speed, such as √(g H), which limits the time step from the beginning [m/s]
    gravity        2 or 3 numbers [m/s²]; 9.81 downwards, along the last axis, if not given
    on_escape      what happens to a particle that leaves the open tank, three of its heights above the floor:
                   "refuse" raises an error, "remove" removes it

    Raises silt.Error if a number is out of range, or an array has another shape or type.
    """
    name = "flow_simulation: "
    x = arguments.points(name + "position", position)
    on_escape = arguments.choice(name + "on_escape", on_escape, ("refuse", "remove"))
    dimension = x.shape[1]
    if walls is None:
        walls = np.zeros((0, dimension, dimension))
    return Simulation._of(_silt.flow(
        x,
        arguments.finite(name + "velocity", arguments.filled(name + "velocity", velocity, x.shape)),
        list(arguments.vector(name + "tank", tank)),
        arguments.flag(name + "lid", lid),
        arguments.faces(name + "walls", walls),
        _several(name + "moving", moving, MovingFaces),
        _several(name + "bodies", bodies, FloatingBody),
        on_escape == "remove",
        arguments.number(name + "spacing", spacing),
        arguments.number(name + "density", density),
        arguments.number(name + "viscosity", viscosity),
        arguments.number(name + "speed_scale", speed_scale),
        None if gravity is None else np.array(arguments.vector(name + "gravity", gravity)),
        _several(name + "openings", openings, OPENINGS),
    ))


@dataclasses.dataclass(frozen=True, kw_only=True, eq=False)
class Filling:
    """Water at rest, made by fill().

    position     of the particles, shape (n, 2) or (n, 3) [m]
    volume       of the room that they fill [m³], in 2D per metre of depth [m²]
    deviation    largest deviation from what the scheme needs for rest: of the particle number density from that of a
                 lattice, over the latter, and of the depth of the particles on the surface, over the spacing [-];
                 0 on a lattice
    """

    position: np.ndarray
    volume: float
    deviation: float

    def __len__(self) -> int:
        """Number of particles."""
        return len(self.position)

    def __repr__(self) -> str:
        return (f"<silt.Filling in {self.position.shape[1]}D: {len(self)} particles, "
                f"volume = {self.volume:g}, deviation = {self.deviation:g}>")


def fill(
    *,
    inside,
    level: float,
    spacing: float,
    tank,
    lid: bool = False,
    walls=None,
    moving: Sequence[MovingFaces] = (),
    bodies: Sequence[FloatingBody] = (),
) -> Filling:
    """Water at rest between walls of any shape: all of the room that is connected with a point, up to a level. Where
    the room consists of cells of a lattice, the particles are its points; elsewhere they are moved until the scheme
    leaves them at rest, which takes about 1 ms per particle on one thread.

    inside     a point in the water, 2 or 3 numbers [m]
    level      of its surface, along the last axis [m]; above a lid, the room below the lid is full
    spacing    of the particles [m]

    tank, lid, walls, moving and bodies are those of flow_simulation(): water is beside moving walls and bodies where
    they are at the time 0. Further walls, which the flow does not have, are a gate that opens at once.

        water = silt.fill(inside=(0.5, 0.1), level=0.3, **walls)
        flow = silt.flow_simulation(position=water.position, **walls)    with walls = {"spacing": …, "tank": …, …}

    Columns of different levels are several calls, whose positions are stacked.

    Raises silt.Error if a number is out of range, if the walls do not hold the water, or if a part of the room is too
    narrow for the spacing.
    """
    point = arguments.vector("fill: inside", inside)
    if walls is None:
        walls = np.zeros((0, len(point), len(point)))
    position, volume, deviation = _silt.fill(
        list(point),
        arguments.number("fill: level", level),
        arguments.number("fill: spacing", spacing),
        list(arguments.vector("fill: tank", tank)),
        arguments.flag("fill: lid", lid),
        arguments.faces("fill: walls", walls),
        _several("fill: moving", moving, MovingFaces),
        _several("fill: bodies", bodies, FloatingBody),
    )
    return Filling(position=position, volume=volume, deviation=deviation)


_is_forked = False


def _after_fork() -> None:
    global _is_forked  # noqa: PLW0603
    _is_forked = True
    _silt.after_fork()


# A step with several threads would wait for ever for those of the parent.
if hasattr(os, "register_at_fork"):
    os.register_at_fork(after_in_child=_after_fork)


def use_threads(number: int) -> None:
    """Sets the number of threads of all steps that the calling thread of Python makes from now on; otherwise it
    is chosen automatically. Results are bitwise identical for any number.

    A process that was forked, as by multiprocessing on Linux, uses one thread; for it, silt.Error is raised if the
    number is above 1.
    """
    threads = min(arguments.count("use_threads: number", number), 2**31 - 1)
    if _is_forked and threads > 1:
        raise Error(f"use_threads: number = {threads}, but this process was forked, and uses one thread; start "
                    'it by multiprocessing.get_context("spawn"), or give 1')
    _silt.use_threads(threads)
