#!/usr/bin/env python3
# SPDX-License-Identifier: MIT
"""Computes the dam break of an ideal fluid in 2D (fully nonlinear potential flow, without surface tension):
a column of width a and height h is released from rest between a wall at x = 0 and a dry frictionless floor
y = 0. Writes a table of T = t √(g h)/a, the front Z = x/a on the floor and the height H = y/h at the wall.

    ideal_dam_break.py 1 potential_flow_front_1.csv --end 2.5              # h = a; takes minutes
    ideal_dam_break.py 0.5 potential_flow_front_0.5.csv --end 1.8 --nodes 160

Method: mixed Eulerian–Lagrangian, with Cauchy's integral for the complex potential w = φ + iψ
[LonguetHigginsCokelet1976, VinjeBrevig1981]. Nodes of the free surface move with the fluid; ψ follows from φ by
Σ_k ∫ w/(z − z_j) dz = 0 over elements on which w is linear in z (exact integrals), the real part of it at every
node z_j; images in wall and floor, on which ψ = 0, leave only the free surface to be discretised. Velocities are
dw/dz of cubic splines over the arc length, on each side of the upper edge of the column, which is a node. Each
time step (Runge and Kutta's, fourth order) ends with new nodes on these splines, densest at the toe and the edge.
Nothing is smoothed or cut off. The infinite acceleration of the toe at t = 0 is limited by the first element, and
its tip, where the angle of the surface tends to zero, wobbles by about that length: Z is the mean of three runs.
Later a run with short elements there lets the tip run ahead as a thin jet: the table ends before Z of a run differs
from the mean by 0.3 %.

Checks: the acceleration at t = 0 against a series (printed; 1e-5 g at the wall, of second order in the elements),
volume and energy (in the table). For n² = 2, `--nodes 160 --end 3.3` agrees with potential_flow_front.csv, which
another program of this method made, within 0.16 % in Z and 1e-5 in H. For n² = 1 half the time step (`strain`)
changes Z by at most 0.01 %.

Units in the code: a = g = 1, and z = x + iy.
"""

import argparse

import numpy as np


class Spline:
    """Cubic spline of the columns of f over s, with continuous third derivatives at the second and the last but
    one node, from the slopes at the nodes."""

    def __init__(self, s, f):
        self.s, self.f, h = s, f, np.diff(s)
        d = np.diff(f, axis=0) / h[:, None]
        n = len(s)
        A, b = np.zeros((n, n)), np.zeros_like(f)
        i = np.arange(1, n - 1)
        A[i, i - 1], A[i, i], A[i, i + 1] = h[1:], 2 * (h[1:] + h[:-1]), h[:-1]
        b[1:-1] = 3 * (h[1:, None] * d[:-1] + h[:-1, None] * d[1:])
        for end, one, two, h1, h2, d1, d2 in ((0, 1, 2, h[0], h[1], d[0], d[1]),
                                              (-1, -2, -3, h[-1], h[-2], d[-1], d[-2])):
            # (m0 + m1 − 2 d1)/h1² = (m1 + m2 − 2 d2)/h2²
            A[end, end], A[end, one], A[end, two] = 1, 1 - (h1 / h2) ** 2, -(h1 / h2) ** 2
            b[end] = 2 * d1 - 2 * d2 * (h1 / h2) ** 2
        self.slope = np.linalg.solve(A, b)

    def __call__(self, s):
        k = np.clip(np.searchsorted(self.s, s) - 1, 0, len(self.s) - 2)
        h = (self.s[k + 1] - self.s[k])[:, None]
        u = (s - self.s[k])[:, None] / h
        f0, f1, m0, m1 = self.f[k], self.f[k + 1], h * self.slope[k], h * self.slope[k + 1]
        return f0 + u * (m0 + u * (3 * (f1 - f0) - 2 * m0 - m1 + u * (m0 + m1 - 2 * (f1 - f0))))


def arc_length(z):
    return np.concatenate([[0], np.cumsum(np.abs(np.diff(z)))])


def sides(edge, count):
    """Nodes from the toe to the edge, and from the edge to the wall."""
    return slice(0, edge + 1), slice(edge, count)


def stream_function(z, phi):
    """ψ at the nodes z, which run from the toe to the wall; 0 at both ends."""
    n = len(z)
    inner = slice(1, -1)
    row = np.arange(n - 2)
    real, imaginary, of_constant = np.zeros((n - 2, n)), np.zeros((n - 2, n)), np.zeros(n - 2, complex)
    # Anticlockwise around the fluid and its images, with the sign of ψ and the direction of the nodes in each.
    for curve, sign, way in ((z, 1, 1), (-z[::-1].conj(), -1, -1), (-z, 1, 1), (z[::-1].conj(), -1, -1)):
        distance = curve - z[inner, None]
        if curve is z:
            distance[row, row + 1] = 1  # any number: what depends on it is removed below
        share = np.log(distance[:, 1:] / distance[:, :-1])
        if curve is z:
            share[row, row] = share[row, row + 1] = 0
        share /= np.diff(curve)
        of_node = np.zeros((n - 2, n), complex)
        of_node[:, :-1] = distance[:, 1:] * share
        of_node[:, 1:] -= distance[:, :-1] * share
        real += of_node.real[:, ::way]
        imaginary += sign * of_node.imag[:, ::way]
        of_constant += of_node.sum(axis=1)
    # The node's own share, since the integral of a constant is 0.
    real[row, row + 1] -= of_constant.real
    imaginary[row, row + 1] -= of_constant.imag
    psi = np.zeros(n)
    psi[inner] = np.linalg.solve(imaginary[:, inner], real @ phi)
    return psi


def velocity(z, phi, edge):
    """u + iv at the nodes, which is the conjugate of dw/dz."""
    w = phi + 1j * stream_function(z, phi)
    dw_dz = np.zeros(len(z), complex)
    for side in sides(edge, len(z)):
        slope = Spline(arc_length(z[side]), np.column_stack([z[side], w[side]])).slope
        dw_dz[side] += slope[:, 1] / slope[:, 0]
    dw_dz[edge] /= 2  # the mean of both sides
    dw_dz[0], dw_dz[-1] = dw_dz[0].real, 1j * dw_dz[-1].imag
    return dw_dz.conj()


def rates(z, phi, edge):
    """dz/dt, and dφ/dt = |∇φ|²/2 − g y from Bernoulli's equation at P = 0."""
    v = velocity(z, phi, edge)
    return v, np.abs(v) ** 2 / 2 - z.imag


def advance(z, phi, edge, dt, first):
    """A step of the classical method of Runge and Kutta; first: rates at its beginning."""
    sums, last = [first[0], first[1]], first
    for part, weight in ((0.5, 2), (0.5, 2), (1, 1)):
        last = rates(z + part * dt * last[0], phi + part * dt * last[1], edge)
        sums = [sums[0] + weight * last[0], sums[1] + weight * last[1]]
    return z + dt / 6 * sums[0], phi + dt / 6 * sums[1]


SMALLEST = 0.05  # element, over the largest; with 0.01 the tip runs ahead early


class Spacing:
    """Length of the elements: the same everywhere, except that it becomes smaller towards the toe and the edge.
    `nodes`: how many elements the column with this n² has."""

    def __init__(self, nodes, n2):
        self.largest = 1
        self.largest = (self.count(n2, (0, n2))[1][-1] + self.count(1, (0,))[1][-1]) / nodes

    def count(self, length, dense):
        """Arc lengths on [0, length], and the number of elements before each; `dense`: where nodes are densest."""
        u = np.linspace(0, 1, 4001)
        s = length * (u - np.sin(2 * np.pi * u) / (2 * np.pi))  # densest at the ends, too
        size = self.largest * np.min([np.minimum(1, SMALLEST + 4 * np.abs(s - at)) for at in dense], axis=0)
        return s, np.concatenate([[0], np.cumsum(np.diff(s) * (1 / size[1:] + 1 / size[:-1]) / 2)])

    def nodes(self, length, dense):
        s, count = self.count(length, dense)
        new = np.interp(np.linspace(0, count[-1], max(4, round(count[-1])) + 1), count, s)
        new[-1] = length
        return new


def regrid(z, phi, edge, spacing):
    """The same surface with other nodes."""
    parts = []
    for number, side in enumerate(sides(edge, len(z))):
        s = arc_length(z[side])
        new = spacing.nodes(s[-1], (0, s[-1]) if number == 0 else (0,))
        parts.append(Spline(s, np.column_stack([z[side], phi[side]]))(new))
    edge = len(parts[0]) - 1
    joined = np.concatenate([parts[0], parts[1][1:]])
    z, phi = joined[:, 0].copy(), joined[:, 1].real
    z[0], z[-1] = z[0].real, 1j * z[-1].imag
    return z, phi, edge


def column(n2, spacing):
    front = 1 + 1j * spacing.nodes(n2, (0, n2))
    top = 1 - spacing.nodes(1, (0,)) + 1j * n2
    z = np.concatenate([front, top[1:]])
    return z, np.zeros(len(z)), len(front) - 1


def volume_and_energy(z, phi, edge):
    """∫ x dy and ½ ∫ φ dψ + ∫ x y dy over the free surface (wall and floor contribute nothing), by Gauss's rule with
    three points on the splines."""
    psi = stream_function(z, phi)
    total = np.zeros(2)
    for side in sides(edge, len(z)):
        s = arc_length(z[side])
        curve = Spline(s, np.column_stack([z[side], phi[side] + 1j * psi[side]]))
        for at, weight in ((0.5, 4 / 9), (0.5 - np.sqrt(0.15), 5 / 18), (0.5 + np.sqrt(0.15), 5 / 18)):
            h = np.diff(s)
            middle, ds = s[:-1] + at * h, 1e-4 * h
            f = curve(middle)
            df = weight * h[:, None] * (curve(middle + ds) - curve(middle - ds)) / (2 * ds[:, None])
            x, y, dy = f[:, 0].real, f[:, 0].imag, df[:, 0].imag
            total += [np.sum(x * dy), np.sum(f[:, 1].real * df[:, 1].imag / 2 + x * y * dy)]
    return total


def initial_acceleration_error(z, edge, n2):
    """Largest error of the vertical acceleration of the top at t = 0, and that at the wall [g], against the
    series for the pressure, p = Σ 2 (−1)^n / k² · cos(k x) sinh(k (h − y)) / cosh(k h), k = (n + ½) π. By
    Bernoulli's equation φ_t = −y there, and acceleration is the gradient of φ_t."""
    top = z[edge:]
    n = np.arange(400)
    k = (n + 0.5) * np.pi
    exact = (2 * (-1.0) ** n / k / np.cosh(np.minimum(k * n2, 700)) * np.cos(np.outer(top.real, k))).sum(axis=1) - 1
    error = np.abs(velocity(z, -z.imag, edge)[edge:].imag - exact)
    return error.max(), error[-1]


def run(n2, nodes, end, every=0.05, strain=0.1):
    """Rows of T, Z, H, the relative errors of volume and energy, and the number of nodes."""
    spacing = Spacing(nodes, n2)
    z, phi, edge = column(n2, spacing)
    at_first = volume_and_energy(z, phi, edge)
    print("acceleration of the top at t = 0: largest error %.1e g, at the wall %.1e g"
          % initial_acceleration_error(z, edge, n2))
    rows, t = [], 0.0
    for T in np.arange(0, end + every / 2, every):
        until = T / np.sqrt(n2)
        while t < until - 1e-12:
            first = rates(z, phi, edge)
            # The length of an element changes by about `strain` at most, also from rest.
            length, dv = np.abs(np.diff(z)), np.abs(np.diff(first[0]))
            limit = min(0.02, strain * np.min(length / (dv + 1e-9)), np.sqrt(strain * np.min(length)))
            dt = (until - t) / np.ceil((until - t) / limit)
            z, phi = advance(z, phi, edge, dt, first)
            z, phi, edge = regrid(z, phi, edge, spacing)
            t += dt
        errors = volume_and_energy(z, phi, edge) / at_first - 1
        if not np.abs(errors).max() < 1e-4:
            print(f"stops before T = {T:.2f}, where volume or energy is off by more than 0.01 %")
            break
        rows.append((T, z[0].real, z[-1].imag / n2, *errors, len(z)))
        print("T %.2f  Z %.5f  H %.5f  volume %+.1e  energy %+.1e  %d nodes" % rows[-1], flush=True)
    return np.array(rows), spacing


HEADER = """\
# Dam break of an ideal fluid in 2D (fully nonlinear potential flow, no surface tension): column of width a and height
# h = {n2:g} a, released from rest at t = 0 between a wall at x = 0 and a dry frictionless floor; no right wall.
# T = t √(g h)/a, Z = x/a of the front on the floor, H = y/h of the surface at the wall; no shift of T.
# By `ideal_dam_break.py {n2:g} --nodes {nodes} --end {end:g}`, which explains the method.
# Z: mean of runs with {counts} nodes (at start-end), smallest elements
# {smallest} a; it differs from each of them by at most {Z:.4f} (rms {Z_rms:.4f}), relatively {Z_relative:.2%}.
# H: first run; it differs from the others by at most {H:.5f}.
# Largest relative errors of a run: volume {volume:.0e}, energy {energy:.0e}.
"""


def main():
    parser = argparse.ArgumentParser(description=__doc__.split("\n\n")[0])
    parser.add_argument("n2", type=float, help="h/a, the n² of Martin and Moyce")
    parser.add_argument("table", help="the file to write")
    parser.add_argument("--end", type=float, default=3.0, help="T of the last row at most (%(default)s)")
    parser.add_argument("--nodes", type=int, default=200,
                        help="at the start (%(default)s); the other runs have 0.8 and 0.6 times as many")
    options = parser.parse_args()

    runs = [run(options.n2, round(part * options.nodes), options.end) for part in (1, 0.8, 0.6)]
    shortest = min(len(rows) for rows, _ in runs)
    T, Z, H, volume, energy, nodes = np.array([rows[:shortest] for rows, _ in runs]).transpose(2, 0, 1)
    off = np.abs(Z - Z.mean(axis=0))
    agrees = np.logical_and.accumulate((off < 0.003 * Z).all(axis=0))
    T, Z, H, volume, energy, nodes, off = (column[:, agrees] for column in (T, Z, H, volume, energy, nodes, off))
    with open(options.table, "w", encoding="utf-8") as file:
        file.write(HEADER.format(
            n2=options.n2, nodes=options.nodes, end=options.end,
            counts=", ".join(f"{row[0]:.0f}-{row[-1]:.0f}" for row in nodes),
            smallest=", ".join(f"{SMALLEST * spacing.largest:.5f}" for _, spacing in runs),
            Z=off.max(), Z_rms=np.sqrt(np.mean(off**2)), Z_relative=(off / Z).max(),
            H=np.abs(H - H[0]).max(), volume=np.abs(volume).max(), energy=np.abs(energy).max()))
        file.write("T,Z,H\n")
        file.writelines("%.2f,%.4f,%.5f\n" % row for row in zip(T[0], Z.mean(axis=0), H[0]))


if __name__ == "__main__":
    main()
