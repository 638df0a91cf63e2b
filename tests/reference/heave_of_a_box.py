#!/usr/bin/env python3
# SPDX-License-Identifier: MIT
"""Heave of a floating box by linear potential theory, in 2D.

    heave_of_a_box.py > heave_of_a_box.csv

Added mass a(ω) and damping b(ω) are those of the radiation problem, by boundary elements (constant
source and dipole panels, half of the domain and its mirror image, with the condition of outgoing waves
at the far end). The motion after release from rest at y0 follows from its transform, as in
[Cummins1962]: with c = ρ g B, and per metre of depth

  (−ω² (m + a) + i ω b + c) Y = (i ω (m + a) + b) y0

Needs NumPy. It takes a minute.
"""

import sys

import numpy as np

G = 9.81
BREADTH, DRAUGHT, DEPTH = 0.4, 0.1, 0.4  # [m]; the box is 0.2 m high, half as dense as the water
PANELS = 14  # of half of the bottom


def wave_number(omega, depth):
    k = omega**2 / G
    for _ in range(200):
        k = omega**2 / (G * np.tanh(k * depth))
    return k


def boundary(length):
    """Ends of the panels, counterclockwise around the fluid at x > 0, and what they are."""
    size = BREADTH / 2 / PANELS
    ends, kinds = [], []

    def add(a, b, number, kind):
        along = np.linspace(0, 1, number + 1)[:, None]
        points = np.array(a) + (np.array(b) - np.array(a)) * along
        ends.append(np.stack([points[:-1], points[1:]], axis=1))
        kinds.extend([kind] * number)

    add([0, -DEPTH], [length, -DEPTH], int(length / size / 1.5), "floor")
    add([length, -DEPTH], [length, 0], int(DEPTH / size / 1.5), "far end")
    add([length, 0], [BREADTH / 2, 0], int((length - BREADTH / 2) / size / 1.2), "surface")
    add([BREADTH / 2, 0], [BREADTH / 2, -DRAUGHT], max(int(2 * DRAUGHT / size), 4), "side")
    add([BREADTH / 2, -DRAUGHT], [0, -DRAUGHT], 2 * PANELS, "bottom")
    return np.concatenate(ends), np.array(kinds)


def influence(ends, mirrored):
    """Integrals of ln r and of its normal derivative over each panel, at the middles of all."""
    a, b = ends[:, 0].copy(), ends[:, 1].copy()
    middle = (a + b) / 2
    if mirrored:
        a[:, 0] *= -1
        b[:, 0] *= -1
    length = np.linalg.norm(b - a, axis=1)
    tangent = (b - a) / length[:, None]
    normal = np.stack([tangent[:, 1], -tangent[:, 0]], axis=1) * (-1 if mirrored else 1)
    apart = middle[:, None] - a[None]
    x, y = (apart * tangent).sum(2), (apart * normal).sum(2)
    y_not_0 = np.where(np.abs(y) < 1e-12, 1e-300, y)
    angle = np.arctan(x / y_not_0) - np.arctan((x - length) / y_not_0)
    source = (x * np.log(np.hypot(x, y)) - (x - length) * np.log(np.hypot(x - length, y))
              + y * angle - length)
    dipole = -angle
    if not mirrored:
        np.fill_diagonal(dipole, 0)
    return source, dipole


def radiation(omega, is_roll=False):
    """Added mass and damping over the density; of roll, about the middle of the box, moments."""
    k = wave_number(omega, DEPTH)
    ends, kinds = boundary(min(12, max(3, 4 * np.pi / k + 1)))
    along = ends[:, 1] - ends[:, 0]
    length = np.linalg.norm(along, axis=1)
    x, y = ends.mean(axis=1).T
    out = np.stack([along[:, 1], -along[:, 0]]) / length  # normals out of the fluid
    moved = (kinds == "bottom") | (is_roll & (kinds == "side"))
    given = np.where(moved, x * out[1] - y * out[0] if is_roll else out[1], 0)
    # Roll is antisymmetric.
    source, dipole = (one - other if is_roll else one + other
                      for one, other in zip(influence(ends, False), influence(ends, True)))
    of_phi = np.where(kinds == "surface", omega**2 / G, np.where(kinds == "far end", -1j * k, 0))
    phi = np.linalg.solve(np.pi * np.eye(len(kinds)) - dipole + source * of_phi, -source @ given)
    force = 2 * np.sum(phi * given * length)
    return force.real, -omega * force.imag


def main():
    known = np.concatenate([np.arange(0.5, 14, 0.5), np.arange(14, 26, 1.5)])
    added, damping = np.array([radiation(omega) for omega in known]).T
    omega = np.linspace(0.02, 60, 6000)
    a, b = np.interp(omega, known, added), np.interp(omega, known, damping, right=0)
    mass, stiffness = BREADTH * DRAUGHT, G * BREADTH
    motion = ((1j * omega * (mass + a) + b)
              / (-omega**2 * (mass + a) + 1j * omega * b + stiffness)).real
    print("# Heave of a box 0.4 m wide and 0.2 m high, half as dense as the water, which is 0.4 m deep, over")
    print("# its height above rest at the release; 2D linear potential theory: written by heave_of_a_box.py.")
    print("# Its initial value, exactly 1, shows the error of the inverse transform.")
    print("t,heave")
    for t in np.arange(0, 3.005, 0.01):
        values = motion * np.cos(omega * t)
        print(f"{t:.2f},{2 / np.pi * np.sum((values[1:] + values[:-1]) / 2) * (omega[1] - omega[0]):.4f}")


if __name__ == "__main__":
    sys.exit(main())
