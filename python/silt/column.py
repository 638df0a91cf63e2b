# SPDX-License-Identifier: MIT
"""The values of one field of all particles."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from .error import Error

if TYPE_CHECKING:
    from .simulation import Simulation


def _can_convert(values: np.ndarray, kind: np.dtype) -> bool:
    """Whether values can be converted to another type of number, except for round-off."""
    if kind.kind in "iu" and values.dtype.kind in "iu" and values.size > 0:
        limits = np.iinfo(kind)
        return bool(limits.min <= values.min() and values.max() <= limits.max)
    return np.can_cast(values.dtype, kind, "same_kind")


# What arrays have that changes none of them; in a column it is that of a copy.
_OF_ARRAYS = frozenset({
    "T", "all", "any", "argmax", "argmin", "argsort", "astype", "clip", "copy", "cumsum", "dot", "flatten", "max",
    "mean", "min", "nonzero", "prod", "ravel", "repeat", "reshape", "round", "std", "sum", "take", "tolist",
    "transpose", "var"})


class Column(np.lib.mixins.NDArrayOperatorsMixin):
    """The present values of one field of all particles, in their order in memory: simulation["velocity"].

    A column never shows an earlier step: it reads the memory of the simulation anew whenever it is
    used, also after steps, and after particles were removed or reordered.

        column[:, 1]            a copy of these values, as an array of its own, which stays as it is
        column[:, 1] = 0        writes to the simulation
        column += [1, 0]        the same, without a copy
        numpy.sin(column)       without a copy of the column, as with any ufunc
        numpy.array(column)     a copy
        column.max()            and other functions of arrays that do not change them, of a copy
        column.view()           an array that is this memory: see there

    A row is a place in memory, which a step may give to another particle: row i is of the particle
    simulation.ids[i].
    """

    __slots__ = ("_name", "_simulation")
    __hash__ = None

    def __init__(self, simulation: Simulation, name: str):
        self._simulation = simulation
        self._name = name
        self._values()  # there is such a field

    def _values(self, writable: bool = False) -> np.ndarray:
        return self._simulation._core.view(self._name, writable)

    @property
    def name(self) -> str:
        """Name of the field."""
        return self._name

    @property
    def simulation(self) -> Simulation:
        """The simulation, which lives at least as long as the column."""
        return self._simulation

    @property
    def shape(self) -> tuple[int, ...]:
        """(n,) for a number per particle, (n, 2) or (n, 3) for a vector."""
        return self._values().shape

    @property
    def dtype(self) -> np.dtype:
        return self._values().dtype

    @property
    def ndim(self) -> int:
        return self._values().ndim

    @property
    def size(self) -> int:
        return self._values().size

    def __len__(self) -> int:
        return len(self._values())

    def __getitem__(self, key):
        values = self._values()[key]
        return values.copy() if isinstance(values, np.ndarray) else values

    def __setitem__(self, key, values) -> None:
        if isinstance(values, Column):
            values = values[:]
        given = np.asarray(values)
        to = self._values(writable=True)
        shape, kind = to.shape, to.dtype
        # An exception keeps the variables of its functions, and an array would keep the next step from
        # being made.
        try:
            if not _can_convert(given, kind):
                raise Error(f'Column: these values of the type {given.dtype} cannot be written to '
                            f'"{self._name}", of the type {kind}; convert them')
            to[key] = given
        except (ValueError, TypeError, OverflowError) as error:
            raise Error(f'Column: these values cannot be written to "{self._name}", '
                        f"of the shape {shape}: {error}") from None
        finally:
            del to

    def __getattr__(self, name: str):
        if name in _OF_ARRAYS:
            return getattr(self[:], name)
        raise AttributeError(f"Column has no attribute {name!r}; an array has it, such as column[:], a copy, or "
                             "column.view()")

    def __dir__(self):
        return [*super().__dir__(), *_OF_ARRAYS]

    def __bool__(self) -> bool:
        return bool(self._values())

    def __iter__(self):
        return iter(self[:])

    def __array__(self, dtype=None, copy=None) -> np.ndarray:
        if copy is False:
            raise ValueError("Column: an array of it is a copy; use view() for one that is not")
        return np.array(self._values(), dtype=dtype)

    def __array_ufunc__(self, ufunc, method, *inputs, out=(), **keywords):
        # numpy.add.at() and the like write to their first input.
        arrays = [each._values(writable=method == "at" and place == 0) if isinstance(each, Column) else each
                  for place, each in enumerate(inputs)]
        if out:
            keywords["out"] = tuple(
                each._values(writable=True) if isinstance(each, Column) else each for each in out)
        try:
            result = getattr(ufunc, method)(*arrays, **keywords)
        finally:
            # As above.
            del arrays
            keywords.clear()
        if out and len(out) == 1:
            return out[0]
        return out or result

    def __repr__(self) -> str:
        return (f'Column "{self._name}" at step {self._simulation.steps} '
                f"(t = {self._simulation.time:g} s):\n{self._values()!r}")

    def view(self, *, writable: bool = False) -> np.ndarray:
        """The memory of the simulation as an array: no copy, at any size.

        Whatever might change or move that memory raises silt.Error as long as this array exists, or a
        slice of it, or anything else that refers to it: a step, a run, removal of particles, reading
        of a checkpoint. So it never shows another step than its own. Delete it before the next step;
        an interactive session also keeps the last result, as _. An observer must not keep one, either.
        The array keeps the simulation alive.

        With `writable`, what is written is used by the next step. This holds for whatever goes through
        references to Python objects, but not for an address, such as array.ctypes.data, that is kept.
        """
        return self._values(writable)
