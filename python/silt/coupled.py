# SPDX-License-Identifier: MIT
"""Grains in a fluid that does not resolve them."""

from __future__ import annotations

from . import _silt, arguments
from .advancing import Advancing
from .error import Error
from .simulation import Simulation


def _drag(name: str, value) -> str | float | None:
    if value is None:
        return None
    if isinstance(value, str):
        return arguments.choice(name, value, _silt.drag_laws)
    return arguments.number(name, value)


class Coupled(Advancing):
    """Grains in a fluid that does not resolve them, as one simulation: they share the volume, and exchange
    momentum by buoyancy and drag.

        both = silt.Coupled(grains, fluid, drag="gidaspow", make_room=True)
        both.let_fluid_settle()
        both.run(until=1.0)
        grains["position"], fluid["fluid_fraction"]

    grains       from grain_simulation(), no larger than the spacing of the fluid
    fluid        from flow_simulation(), in the same number of dimensions, with the same gravity
    drag         law of drag of spheres, in 3D: "stokes" or "schiller_naumann", of single ones; "wen_yu", of
                 suspensions; "ergun", of packed beds; "gidaspow" or "di_felice", of both. None: no drag.
                 A number: β of a linear law, force = β (u − v) [kg/s], in 2D per metre of depth
    added_mass   coefficient of the added mass, 1/2 of a sphere, 1 of a disc [-]
    lift         coefficient of the lift, 1/2 of a sphere in a weak shear without viscosity [-]
    make_room    removes as many particles of the fluid as the grains displace, evenly, where they are, so
                 that its level stays; otherwise the grains raise it

    The two become parts of it, with what was written to their columns. They have further fields, such as
    "immersion" of grains, the share of a grain that is in the fluid, and "fluid_fraction" of the fluid, the
    share of the volume around a particle that is fluid. They are read and changed as before, but steps, runs
    and checkpoints are those of the Coupled. Walls of the one are none of the other: give them to both.

    Raises silt.Error, and leaves both as they are, if one has made a step, or if they do not fit: other
    gravity; a grain larger than the spacing, or on a wall of the flow; drag in a fluid without viscosity;
    grains that leave less room to the fluid than the closest packing.
    """

    __slots__ = ("_fluid", "_grains")

    def __init__(
        self,
        grains: Simulation,
        fluid: Simulation,
        *,
        drag: str | float | None,
        added_mass: float = 0.0,
        lift: float = 0.0,
        make_room: bool = False,
    ):
        for name, simulation in (("grains", grains), ("fluid", fluid)):
            if not isinstance(simulation, Simulation):
                raise Error(f"Coupled: {name} = {simulation!r} is none; give a Simulation")
        if grains is fluid:
            raise Error(f"Coupled: grains and fluid are the same, {grains!r}; give two simulations")
        self._core, grains._core, fluid._core = _silt.join(
            grains._core,
            fluid._core,
            _drag("Coupled: drag", drag),
            arguments.number("Coupled: added_mass", added_mass),
            arguments.number("Coupled: lift", lift),
            arguments.flag("Coupled: make_room", make_room),
        )
        self._grains, self._fluid = grains, fluid

    def __repr__(self) -> str:
        return (f"<silt.Coupled in {self.dimension}D: {len(self.grains)} grains in {len(self.fluid)} "
                f"particles of fluid at step {self.steps}, t = {self.time:g} s>")

    @property
    def grains(self) -> Simulation:
        """The grains. They make several steps in one of the flow."""
        return self._grains

    @property
    def fluid(self) -> Simulation:
        """The fluid."""
        return self._fluid

    def energies(self) -> dict[str, float]:
        """Energies after the last step, and what was lost since the first one, by name [J], in 2D per metre of
        thickness: "kinetic_of_grains" (of translation), "potential_of_grains", "kinetic_of_fluid" and
        "potential_of_fluid" (zero at the origin); "lost_by_exchange", by drag, and stored by the added mass;
        "imbalance", by which both are not closed, which is round-off."""
        return self._core.energies()

    def let_fluid_settle(self, tolerance: float = 1e-4, max_steps: int = 1000) -> float:
        """Before the first step: moves the fluid to where it rests between the grains, which are held.

        tolerance    ends when no particle has moved by more in a step, over the spacing [-]
        max_steps    of the flow, after which it ends anyhow

        Returns the last move, over the spacing [-]. Raises silt.Error after a step. Ctrl-C waits for its end.
        """
        name = "Coupled.let_fluid_settle: "
        limit = arguments.number(name + "tolerance", tolerance)
        if not limit > 0:
            raise Error(f"{name}tolerance = {limit:g}; give a number above 0")
        steps = min(arguments.count(name + "max_steps", max_steps), 2**31 - 1)
        return self._core.let_fluid_settle(limit, steps)
