# SPDX-License-Identifier: MIT
"""The exception of the package."""

from __future__ import annotations


class Error(RuntimeError):
    """What Silt raises if something is wrong: a sentence that names the quantity, its value and what to
    do. Wrong numbers of arguments and unknown keywords raise TypeError, as everywhere.

    id      of the particle at fault, or None
    step    number of steps completed before the one that failed, or None
    time    at the beginning of that step [s], or None
    """

    id: int | None = None
    step: int | None = None
    time: float | None = None

    @property
    def what(self) -> str:
        """The sentence, as str(error)."""
        return str(self)


Error.__module__ = "silt"
