# SPDX-License-Identifier: MIT
"""What advances in time: simulations, and two in one."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Sequence

from . import arguments
from .error import Error


class Advancing:
    """Base of Simulation and Coupled: steps, runs and checkpoints."""

    __slots__ = ("__weakref__", "_core")

    def __reduce_ex__(self, protocol):
        raise TypeError(f"a silt.{type(self).__name__} cannot be copied or pickled; write_checkpoint() "
                        "writes its state")

    # --- time

    @property
    def dimension(self) -> int:
        """2 or 3."""
        return self._core.dimension

    @property
    def time(self) -> float:
        """[s]"""
        return self._core.time

    @property
    def steps(self) -> int:
        """Number of completed steps."""
        return self._core.steps

    @property
    def last_time_step(self) -> float:
        """[s]; 0 before the first step."""
        return self._core.last_time_step

    # --- advancing

    def time_step(self) -> float:
        """The time step that the next step would have [s]."""
        return self._core.time_step()

    def step(self, count: int = 1, *, time_step: float | None = None) -> None:
        """Makes `count` steps.

        time_step    [s]; if not given, the simulation chooses it

        Raises silt.Error if a step fails, which is then undone; those before it are not. Ctrl-C ends it
        after a step, with KeyboardInterrupt.
        """
        name = f"{type(self).__name__}.step: "
        if time_step is not None:
            time_step = arguments.number(name + "time_step", time_step)
        self._core.step(arguments.count(name + "count", count), time_step)

    def run(
        self,
        until: float,
        output_every: float = 0.0,
        observer: Observer | Sequence[Observer] | None = None,
        *,
        time_step: float | None = None,
        end_exactly: bool = False,
    ) -> None:
        """Makes steps until the time is at least `until`.

        until           [s], not before the present time
        output_every    interval of the calls of observers [s]; 0: only at the beginning and at the end
        observer        what is called at the beginning, at the first step at or after every multiple of
                        `output_every`, and at the end: observer(simulation). One, or several in a list.
                        It may read and change the simulation, but not advance it
        time_step       [s]; if not given, the simulation chooses it
        end_exactly     whether the last steps are shortened to end at exactly `until`

        Other threads of Python run meanwhile. What an observer raises ends the run, and is raised by it.
        Ctrl-C ends it after the present step, with KeyboardInterrupt. In both cases, and after silt.Error,
        the simulation is as after its last step; run() again continues.
        """
        name = f"{type(self).__name__}.run: "
        until = arguments.number(name + "until", until)
        output_every = arguments.number(name + "output_every", output_every)
        if time_step is not None:
            time_step = arguments.number(name + "time_step", time_step)
        # A run ends up to one step after its `until`: it may be repeated.
        if until < self.time - self.last_time_step:
            raise Error(f"{name}until = {until:g} s is in the past, as the time is {self.time:g} s; "
                        "give a later one")
        if observer is None:
            observers = []
        elif isinstance(observer, Iterable) and not callable(observer):
            observers = list(observer)
        else:
            observers = [observer]
        for each in observers:
            if not callable(each):
                raise Error(f"{name}the observer {each!r} cannot be called; give a function of the "
                            "simulation")

        def observe():
            for each in observers:
                each(self)

        ends_exactly = arguments.flag(name + "end_exactly", end_exactly)
        self._core.run(until, output_every, time_step, ends_exactly, observe)

    # --- files

    def write_checkpoint(self, path) -> None:
        """Writes the complete state, from which read_checkpoint() continues with the same bits."""
        self._core.write_checkpoint(arguments.path(f"{type(self).__name__}.write_checkpoint: path", path))

    def read_checkpoint(self, path, *, accepts_other_setup: bool = False) -> None:
        """Replaces the state by that of a file.

        accepts_other_setup    reads it although it was written with other arguments than those of this
                               simulation, which then hold, but for the box and on_escape, those of the file

        Positions, velocities, radii and densities are state, which the file has. All other arguments must be
        those with which the file was written, except speed_scale of a flow, which only limits the time step.
        Raises silt.Error, and changes nothing, if they are not, unless that is accepted; also if the file
        cannot be read, or is of another dimension or kind of simulation.
        """
        name = f"{type(self).__name__}.read_checkpoint: "
        self._core.read_checkpoint(arguments.path(name + "path", path),
                                   arguments.flag(name + "accepts_other_setup", accepts_other_setup))


Observer = Callable[[Advancing], object]
