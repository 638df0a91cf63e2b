#!/usr/bin/env python3
# SPDX-License-Identifier: MIT
"""Roll of a floating box about its middle by linear potential theory, in 2D.

    roll_of_a_box.py

Prints the zeros of the angle after a push, a torque of sin² π t/0.1 s, of the box of heave_of_a_box.py,
held in sway and heave. Its middle is at the surface. As there, with the added moment of inertia a(ω) and the
damping b(ω), per metre of depth and over the density of water,

  (−ω² (I + a) + i ω b + g V GM) φ = M,   GM = B²/(12 D) − D/2

Needs NumPy. It takes a minute.
"""

import sys

import numpy as np
from heave_of_a_box import BREADTH, DRAUGHT, G, radiation


def main():
    known = np.concatenate([np.arange(0.5, 14, 0.5), np.arange(14, 26, 1.5)])
    added, damping = np.array([radiation(omega, is_roll=True) for omega in known]).T
    omega = np.linspace(0.02, 60, 6000)
    a, b = np.interp(omega, known, added), np.interp(omega, known, damping, right=0)
    volume = BREADTH * DRAUGHT
    inertia = volume * (BREADTH**2 + (2 * DRAUGHT) ** 2) / 12
    stiffness = G * volume * (BREADTH**2 / (12 * DRAUGHT) - DRAUGHT / 2)
    pushed = np.linspace(0, 0.1, 401)
    push = np.exp(-1j * np.outer(omega, pushed)) @ np.sin(np.pi * pushed / 0.1) ** 2
    roll = push / (-omega**2 * (inertia + a) + 1j * omega * b + stiffness)
    t = np.arange(0.1, 2, 0.001)
    angle = (np.exp(1j * np.outer(t, omega)) @ roll).real
    zeros = t[1:][angle[1:] * angle[:-1] < 0]
    print("zeros of the roll:", ", ".join(f"{zero:.3f} s" for zero in zeros))
    at = np.interp(2 * np.pi / (zeros[2] - zeros[0]), known, added)
    print(f"moment of inertia {1000 * inertia:.3f} kg m, added {1000 * at:.3f} kg m, "
          f"stiffness {1000 * stiffness:.1f} N")


if __name__ == "__main__":
    sys.exit(main())
