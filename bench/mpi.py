#!/usr/bin/env python3
# SPDX-License-Identifier: MIT
"""Measures the steps of bench/mpi/steps.cpp in one process with one and two threads, and in two processes.

    mpi.py PROGRAM          runs PROGRAM, bench_mpi_steps, and prints a table
    mpi.py PROGRAM PAGE     also puts the table between the two comments in PAGE that ask for it

Each figure is a median of RUNS runs, the kinds in turn. Needs mpirun; no other program should run at the
same time.
"""

import json
import os
import pathlib
import statistics
import subprocess
import sys

from report import put_into_page

RUNS = 3
SCENES = [("bed", "bed of spheres", 100), ("dam_2d", "dam break", 20), ("dam_3d", "dam break in 3D", 10)]
# Kind, processes, threads of each.
KINDS = [("serial", 1, 1), ("serial", 1, 2), ("shared", 1, 1), ("shared", 2, 1)]


def run(program, scene, steps, kind, processes, threads):
    """The figures of one run."""
    environment = {**os.environ, "OMP_NUM_THREADS": str(threads), "OMPI_ALLOW_RUN_AS_ROOT": "1",
                   "OMPI_ALLOW_RUN_AS_ROOT_CONFIRM": "1"}
    command = ["mpirun", "-np", str(processes), "--bind-to", "none", program, scene, kind, str(steps)]
    done = subprocess.run(command, env=environment, check=True, capture_output=True, text=True)
    return json.loads(done.stdout.strip().splitlines()[-1])


def medians(program, scene, steps):
    """Of each kind, the median of each figure."""
    runs = {kind: [] for kind in KINDS}
    for _ in range(RUNS):
        for kind in KINDS:
            runs[kind].append(run(program, scene, steps, *kind))
    return {kind: {name: statistics.median(each[name] for each in results) for name in results[0]}
            for kind, results in runs.items()}


def table(program):
    lines = ["| scene | particles, halo | 1 thread | 2 threads | shared, 1 process | 2 processes | speed of "
             "these over 2 threads | processor time over 1 thread | in messages and waiting | reductions, messages, kB "
             "a step |", "|---|---|---|---|---|---|---|---|---|---|"]
    for scene, title, steps in SCENES:
        found = medians(program, scene, steps)
        one, two, alone, shared = (found[kind] for kind in KINDS)
        lines.append(
            f"| {title} | {shared['particles']:.0f}, {100 * shared['halo'] / shared['particles']:.0f} % "
            f"| {one['ms']:.1f} ms | {two['ms']:.1f} ms | {alone['ms']:.1f} ms | {shared['ms']:.1f} ms "
            f"| {two['ms'] / shared['ms']:.2f} | {shared['processor_ms'] / one['processor_ms']:.2f} "
            f"| {100 * shared['waiting_ms'] / shared['ms']:.0f} % "
            f"| {shared['reductions']:.0f}, {shared['messages']:.0f}, {shared['kB']:.0f} |")
        print(lines[-1], flush=True)
    return "\n".join(lines)


def main():
    program, *page = sys.argv[1:]
    text = table(program)
    print(text)
    if page:
        put_into_page(text, pathlib.Path(page[0]), "bench/mpi.py")


if __name__ == "__main__":
    main()
