# SPDX-License-Identifier: MIT
"""Silt: granular flow (DEM) and incompressible flow with a free surface (MPS), in 2D and 3D.

    import silt

    R = 0.02
    heap = silt.grain_simulation(
        position=silt.lattice((-0.1, 0), (0.1, 0.8), 2 * R), radius=R, density=2500,
        law=silt.CundallStrack(normal_stiffness=1e6, tangential_stiffness=5e5, restitution=0.5,
                               friction_angle=0.46),
        walls=[silt.Plane(normal=(0, 1))])
    heap.run(until=1.0)
    print(heap["position"][:, 1].max())

See grain_simulation, flow_simulation, Coupled, fill, MovingFaces, FloatingBody, Simulation and Column. All quantities
are in SI units.
"""

from ._silt import version as __version__
from .column import Column
from .coupled import Coupled
from .error import Error
from .moving import (
    BodyState,
    FloatingBody,
    MassProperties,
    MotionFunction,
    MovingFaces,
    Rotation,
    TabulatedMotion,
    Translation,
    Vibration,
    faces_of_box,
    faces_of_disc,
    faces_of_polyline,
    faces_of_sphere,
    remove_inside,
)
from .openings import Extraction, Inflow, OpeningState, Outflow, PressureOpening
from .setup import (
    Box,
    BoxWall,
    Circle,
    CundallStrack,
    Cylinder,
    HertzMindlin,
    LinearSpringDashpot,
    MeshWall,
    Plane,
    Polyline,
    Segment,
    lattice,
)
from .simulation import (
    Filling,
    Simulation,
    VtkSeries,
    VtkWalls,
    fill,
    flow_simulation,
    grain_simulation,
    use_threads,
)

__all__ = [
    "BodyState",
    "Box",
    "BoxWall",
    "Circle",
    "Column",
    "Coupled",
    "CundallStrack",
    "Cylinder",
    "Error",
    "Extraction",
    "Filling",
    "FloatingBody",
    "HertzMindlin",
    "Inflow",
    "LinearSpringDashpot",
    "MassProperties",
    "MeshWall",
    "MotionFunction",
    "MovingFaces",
    "OpeningState",
    "Outflow",
    "Plane",
    "Polyline",
    "PressureOpening",
    "Rotation",
    "Segment",
    "Simulation",
    "TabulatedMotion",
    "Translation",
    "Vibration",
    "VtkSeries",
    "VtkWalls",
    "__version__",
    "faces_of_box",
    "faces_of_disc",
    "faces_of_polyline",
    "faces_of_sphere",
    "fill",
    "flow_simulation",
    "grain_simulation",
    "lattice",
    "remove_inside",
    "use_threads",
]
