# SPDX-License-Identifier: MIT
"""Conversion of arguments, with errors that name them."""

from __future__ import annotations

import operator
import os

import numpy as np

from .error import Error


def convert(part, **conversions) -> None:
    """Converts attributes of a frozen dataclass; names them in errors."""
    for name, conversion in conversions.items():
        converted = conversion(f"{type(part).__name__}: {name}", getattr(part, name))
        object.__setattr__(part, name, converted)


def optional(conversion):
    """The same conversion of an argument that may be None."""
    return lambda name, value: None if value is None else conversion(name, value)


def number(name: str, value) -> float:
    """A number. It may be infinite or NaN: that is for the simulation to judge."""
    try:
        if isinstance(value, (str, bytes)):
            raise TypeError
        return float(value)
    except (TypeError, ValueError, OverflowError):
        raise Error(f"{name} = {value!r} is not a number; give one") from None


def count(name: str, value) -> int:
    """An integer of at least 0."""
    try:
        converted = operator.index(value)
    except TypeError:
        raise Error(f"{name} = {value!r} is not an integer; give one") from None
    if not 0 <= converted < 2**63:
        raise Error(f"{name} = {value!r} is out of range; give an integer of at least 0")
    return converted


def flag(name: str, value) -> bool:
    """True or False, also of NumPy."""
    if isinstance(value, (bool, np.bool_)):
        return bool(value)
    raise Error(f"{name} = {value!r}; give True or False")


def array(name: str, value) -> np.ndarray:
    """An array of double precision, from numbers that convert to it without loss of their kind."""
    try:
        given = np.asarray(value)
        return np.ascontiguousarray(given.astype(float, casting="safe"))
    except (TypeError, ValueError) as error:
        # A list of lists of different lengths is an array of objects for NumPy, or an error.
        kind = getattr(value, "dtype", None) or type(value).__name__
        raise Error(f"{name} ({kind}) cannot be converted to an array of numbers: {error}") from None


def vector(name: str, value) -> tuple[float, ...]:
    """Two or three numbers."""
    numbers = array(name, value)
    if numbers.ndim != 1 or len(numbers) not in (2, 3):
        raise Error(f"{name} has the shape {numbers.shape}; give 2 numbers in 2D, 3 in 3D")
    return tuple(numbers.tolist())


def angular(name: str, value) -> tuple[float, ...]:
    """A turn, spin or torque: a number in 2D, three numbers in 3D."""
    numbers = array(name, value)
    if numbers.shape not in ((), (1,), (3,)):
        raise Error(f"{name} has the shape {numbers.shape}; give a number in 2D, 3 numbers in 3D")
    return tuple(numbers.reshape(-1).tolist())


def flags(name: str, value) -> tuple[bool, ...]:
    """True or False for each axis."""
    return tuple(x != 0 for x in vector(name, value))


def faces(name: str, value) -> np.ndarray:
    """An array of shape (n, 2, 2) or (n, 3, 3)."""
    numbers = array(name, value)
    if numbers.ndim != 3 or numbers.shape[1:] not in ((2, 2), (3, 3)):
        raise Error(f"{name} has the shape {numbers.shape}; give (n, 2, 2) in 2D, the ends of segments, or (n, 3, 3) "
                    "in 3D, the corners of triangles")
    return numbers


def points(name: str, value) -> np.ndarray:
    """An array of shape (n, 2) or (n, 3)."""
    numbers = array(name, value)
    if numbers.ndim != 2 or numbers.shape[1] not in (2, 3):
        raise Error(f"{name} has the shape {numbers.shape}; give (n, 2) in 2D, (n, 3) in 3D")
    return numbers


def filled(name: str, value, shape: tuple[int, ...]) -> np.ndarray:
    """An array of this shape, from one that can be broadcast to it."""
    numbers = array(name, value)
    try:
        return np.ascontiguousarray(np.broadcast_to(numbers, shape))
    except ValueError:
        raise Error(f"{name} has the shape {numbers.shape}; give {shape}, or one value for all") from None


def finite(name: str, numbers: np.ndarray) -> np.ndarray:
    """This array of one row per particle, if all of its numbers are finite."""
    odd = np.argwhere(~np.isfinite(numbers))
    if len(odd) > 0:
        row = int(odd[0][0])
        raise Error(f"{name} of particle {row} = {numbers[row].tolist()} is not finite; give finite numbers")
    return numbers


def choice(name: str, value, choices: tuple[str, ...]) -> str:
    if isinstance(value, str) and value in choices:
        return value
    raise Error(f"{name} = {value!r}; give " + " or ".join(repr(each) for each in choices))


def path(name: str, value) -> str:
    """A path, from a str or pathlib.Path."""
    try:
        converted = os.fspath(value)
    except TypeError:
        raise Error(f"{name} = {value!r} is not a path; give a str or pathlib.Path") from None
    if isinstance(converted, bytes) or "\0" in converted or not converted:
        raise Error(f"{name} = {value!r} is not the name of a file; give another one")
    return converted
