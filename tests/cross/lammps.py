#!/usr/bin/env python3
# SPDX-License-Identifier: MIT
"""Cross-check: the same spheres with LAMMPS and with Silt and the same law.

    lammps.py PROGRAM FOLDER

PROGRAM is silt_beside_lammps; the common initial states and the results are written to FOLDER.
Prints a table and exits with 1 if a difference is larger than allowed, with 77 if LAMMPS is not
installed.

Two spheres collide obliquely: positions, velocities and spins agree to 1 % of their maximum.
Two clumps of three spheres (fix rigid) collide: until they meet, the difference of their positions
falls by four when the time steps are halved; the kinetic energy after it agrees to 1 %.
Two sticky spheres (JKR) collide: the velocity agrees to 5e-4 until LAMMPS ends the contact, at
about half of the gap at which the neck breaks; Silt's lasts until there, and leaves with the speed
that the energy of the neck leaves.
500 spheres collapse on a floor: the curves of the kinetic energy differ by no more than LAMMPS's
own change when its time step is halved.
"""

import math
import pathlib
import shutil
import subprocess
import sys

HERE = pathlib.Path(__file__).resolve().parent
SKIPPED = 77
# Units as in bench/scenes.hpp: diameter, mass and gravity are 1. Laws are kn, kt, gamma_n, gamma_t,
# xmu.
PAIR = {"law": "200000 57142.857142857143 50 25 0.5", "dt": 1e-4, "until": 0.5, "every": 1e-4}
CLUMP = {"law": "20000 5714.2857142857143 24 12 0.5", "dt": 1e-3, "until": 1, "every": 5e-2}
JKR = {"law": "20000 0 0.3 10", "dt": 1e-5, "until": 0.1, "every": 1e-4}
COLLAPSE = {"law": "20000 5714.2857142857143 240 120 0.5", "dt": 2e-4, "until": 10,
            "every": 0.02}


def run(*command):
    done = subprocess.run(list(map(str, command)), capture_output=True, text=True, check=False)
    if done.returncode != 0:
        sys.exit(f"lammps.py: {' '.join(map(str, command))} failed\n"
                 f"{done.stdout[-2000:]}{done.stderr}")


def frames_of(path):
    """Frames of a dump, each a list of rows: diameter, x y z, vx vy vz, wx wy wz."""
    frames = []
    for text in path.read_text(encoding="utf-8").split("ITEM: TIMESTEP\n")[1:]:
        lines = text.splitlines()
        first = next(k for k, line in enumerate(lines) if line.startswith("ITEM: ATOMS")) + 1
        frames.append([list(map(float, line.split()[1:])) for line in lines[first:]])
    return frames


def both(program, folder, scene, state, law, dt, until, every):
    """Frames of LAMMPS and of Silt, as functions of the folder of the run."""
    steps, stride = round(until / dt), round(every / dt)

    def lammps():
        path = folder / f"lammps_{scene}_{dt:g}.txt"
        values = {"scene": scene, "file": state, "law": law, "dt": dt, "steps": steps,
                  "every": stride, "frames": path}
        variables = [word for name, value in values.items() for word in ("-var", name, value)]
        run("lmp", "-log", "none", "-screen", "none", "-in", HERE / "grains.lammps", *variables)
        return frames_of(path)

    def silt():
        path = folder / f"silt_{scene}_{dt:g}.txt"
        run(program, "run", scene, state, law, dt, steps, stride, path)
        return frames_of(path)

    return lammps, silt


def norm(vector):
    return math.sqrt(sum(x * x for x in vector))


def pair_rows(program, folder, state):
    lammps, silt = both(program, folder, "pair", state, **PAIR)
    theirs, ours = lammps(), silt()
    assert len(theirs) == len(ours)
    for what, columns in (("position", slice(1, 4)), ("velocity", slice(4, 7)),
                          ("spin", slice(7, 10))):
        def largest(frames):
            return max(norm(row[columns]) for frame in frames for row in frame)

        apart = max(norm(a - b for a, b in zip(their[columns], our[columns]))
                    for their_frame, our_frame in zip(theirs, ours)
                    for their, our in zip(their_frame, our_frame))
        scale = largest(theirs)
        yield f"pair, {what}: maximum, and difference", scale, largest(ours), apart / scale, 0.01
    for sphere in (0, 1):
        spins = [frames[-1][sphere][7:10] for frames in (theirs, ours)]
        change = [norm(a - b for a, b in zip(spin, theirs[0][sphere][7:10])) for spin in spins]
        yield (f"pair, change of the spin of sphere {sphere + 1}", *change,
               abs(change[1] - change[0]) / change[0], 0.01)


def jkr_rows(program, folder, state):
    lammps, silt = both(program, folder, "jkr", state, **JKR)
    theirs, ours = lammps(), silt()

    def gap(frame):
        return norm(a - b for a, b in zip(frame[0][1:4], frame[1][1:4])) - 1

    def speed(frame):
        return norm(frame[0][4:7])

    free = speed(theirs[-1])
    last = max(k for k in range(len(theirs)) if abs(speed(theirs[k]) - free) > 1e-12)
    apart = max(abs(speed(a) - speed(b)) for a, b in zip(theirs[:last + 1], ours))
    top = max(map(speed, theirs))
    yield "jkr, speed until LAMMPS ends the contact, and difference", top, max(map(speed, ours)), \
        apart / top, 5e-4
    E, _, nu, gamma = map(float, JKR["law"].split())
    E, R, w, mass = E / (2 * (1 - nu**2)), 0.25, 2 * gamma, 1
    least = (math.pi * w * R**2 / (8 * E))**(1 / 3)
    yield "jkr, gap at the end: LAMMPS's, and the exact one", gap(theirs[last]), 3 * least**2 / R, \
        0, math.inf

    def energy(a):
        k = math.sqrt(2 * math.pi * w / E)
        return E * (8 / 15 * a**5 / R**2 - 4 / 3 * k * a**3.5 / R + k**2 * a**2 / 2)

    # Of both spheres, after what the neck takes.
    left = mass * speed(ours[0])**2 - (energy(least) - energy(least * 16**(1 / 3)))
    exact = math.sqrt(left / mass)
    yield "jkr, speed after: exact, and Silt's", exact, speed(ours[-1]), \
        abs(speed(ours[-1]) / exact - 1), 1e-3


def kinetic_energy(frame):
    """Of spheres with the mass 1 at the diameter 1."""
    energy = 0
    for row in frame:
        mass, radius = row[0]**3, row[0] / 2
        energy += mass * (norm(row[4:7])**2 + 0.4 * (radius * norm(row[7:10]))**2) / 2
    return energy


def clump_rows(program, folder, state):
    runs = {}
    for divisor in (1, 2, 50):
        settings = {**CLUMP, "dt": CLUMP["dt"] / divisor}
        runs[divisor] = [run_one() for run_one in both(program, folder, "clump", state, **settings)]
    energies = [kinetic_energy(frame) for frame in runs[50][0]]
    meeting = next(k for k, e in enumerate(energies) if abs(e / energies[0] - 1) > 1e-6)

    def apart(divisor):
        theirs, ours = runs[divisor]
        return max(norm(a - b for a, b in zip(their[1:4], our[1:4]))
                   for their_frame, our_frame in zip(theirs[:meeting], ours)
                   for their, our in zip(their_frame, our_frame))

    yield "clump, positions until they meet: apart, and at half Δt", apart(1), apart(2), \
        abs(4 * apart(2) / apart(1) - 1), 0.1
    after = [kinetic_energy(frames[-1]) for frames in runs[50]]
    yield "clump, kinetic energy before they meet", energies[0], kinetic_energy(runs[50][1][0]), \
        abs(kinetic_energy(runs[50][1][0]) / energies[0] - 1), 1e-9
    yield "clump, kinetic energy after it", *after, abs(after[1] / after[0] - 1), 0.01


def mean_height(frame):
    return sum(row[3] for row in frame) / len(frame)


def collapse_rows(program, folder, state):
    lammps, silt = both(program, folder, "collapse", state, **COLLAPSE)
    finer, _ = both(program, folder, "collapse", state, **{**COLLAPSE, "dt": COLLAPSE["dt"] / 2})
    runs = [lammps(), silt(), finer()]
    assert len({len(frames) for frames in runs}) == 1
    # Round-off errors grow a thousandfold per unit of time; until t = 4 they are negligible.
    calm = round(4 / COLLAPSE["every"]) + 1
    far = [max(norm(a - b for a, b in zip(their[1:4], our[1:4]))
               for their_frame, our_frame in zip(runs[0][:calm], frames)
               for their, our in zip(their_frame, our_frame)) for frames in runs]
    yield "collapse, maximum distance of a grain until t = 4", *far[:2], far[1], far[2]

    for what, measure in (("kinetic energy", kinetic_energy), ("mean height", mean_height)):
        theirs, ours, half = ([measure(frame) for frame in frames] for frames in runs)
        top = max(theirs)
        for when, until in (("up to its peak", theirs.index(top) + 1), ("to the end", len(theirs))):
            def apart(curve):
                difference = [abs(a - b) for a, b in zip(curve[:until], theirs)]
                return max(difference) / top, norm(difference) / math.sqrt(until) / top

            for kind, measured, allowed in zip(("largest", "rms"), apart(ours), apart(half)):
                if until > 1:
                    yield (f"collapse, {what} {when}: peak, and {kind} apart",
                           top, max(ours[:until]), measured, allowed)


def main():
    if len(sys.argv) != 3:
        sys.exit(__doc__)
    if not shutil.which("lmp") or subprocess.run(["lmp", "-help"], capture_output=True, check=False).returncode:
        print("LAMMPS (Debian's package lammps) is not installed, or does not run: Silt is not checked against it.")
        sys.exit(SKIPPED)
    program, folder = pathlib.Path(sys.argv[1]).resolve(), pathlib.Path(sys.argv[2]).resolve()
    folder.mkdir(parents=True, exist_ok=True)
    good = True
    print(f"{'quantity':60} {'LAMMPS':>12} {'Silt':>12} {'difference':>10} {'allowed':>10}")
    for scene, rows_of in (("pair", pair_rows), ("clump", clump_rows), ("jkr", jkr_rows),
                          ("collapse", collapse_rows)):
        state = folder / f"{scene}.data"
        run(program, "make", scene, state)
        for quantity, theirs, ours, difference, allowed in rows_of(program, folder, state):
            holds = difference <= allowed
            good = good and holds
            print(f"{quantity:60} {theirs:12.8g} {ours:12.8g} {difference:10.1e} {allowed:10.1e}"
                  f"{'' if holds else '  TOO LARGE'}", flush=True)
    sys.exit(0 if good else 1)


if __name__ == "__main__":
    main()
