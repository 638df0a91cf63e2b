#!/usr/bin/env python3
# SPDX-License-Identifier: MIT
"""Measures what promises of docs/promises.md cost: the same bits on every processor, and the checks
of what a step did.

    promise_costs.py         runs three cases with each of three programs, and prints a table
    promise_costs.py PAGE    also puts the table between the two comments in PAGE that ask for it

The programs are compiled alike, except that one may fuse multiplications and additions
(-ffp-contract=fast), and one does not check its steps. They run in turn, RUNS times, on one thread.
A figure is the median of the ratios of runs in the same turn to those of the program that promises
all, in percent, with the quartiles.
"""

import os
import pathlib
import platform
import statistics
import subprocess
import sys
import tempfile

from compile_time import includes
from report import put_into_page

REPOSITORY = pathlib.Path(__file__).resolve().parents[1]
FLAGS = ["-std=c++20", "-O3", "-march=native", "-fno-math-errno", "-fopenmp"]
VARIANTS = {
    "all promises": ["-ffp-contract=off"],
    "fused operations": ["-ffp-contract=fast"],
    "steps not checked": ["-ffp-contract=off", "-DSILT_BENCH_UNWATCHED"],
}
CASES = {
    "bed": "32000 grains at rest, 3D",
    "gas": "32000 grains in motion, 3D",
    "dam": "dam break of 12800 particles, 2D",
}
RUNS = 15


def built(folder):
    programs = {}
    for name, flags in VARIANTS.items():
        print(f"Compiling: {name} …", file=sys.stderr, flush=True)
        programs[name] = folder / name.replace(" ", "_")
        subprocess.run(["g++", *FLAGS, *flags, *includes(),
                        REPOSITORY / "bench" / "costs" / "step_seconds.cpp",
                        "-o", programs[name]], check=True)
    return programs


def seconds(program, case):
    ran = subprocess.run([program, case], capture_output=True, text=True, check=True,
                         cwd=REPOSITORY, env={**os.environ, "OMP_NUM_THREADS": "1"})
    return float(ran.stdout)


def rows(programs):
    first = next(iter(programs))
    seconds(programs[first], "bed")  # makes the file of the state
    for case, title in CASES.items():
        print(f"Measuring: {title} …", file=sys.stderr, flush=True)
        turns = []
        for turn in range(RUNS):
            first_of_turn = turn % len(programs)  # none is always the first
            order = [*list(programs)[first_of_turn:], *list(programs)[:first_of_turn]]
            turns.append({name: seconds(programs[name], case) for name in order})
        cells = [f"{1e3 * statistics.median(turn[first] for turn in turns):.2f} ms"]
        for name in list(programs)[1:]:
            low, middle, high = statistics.quantiles(
                [100 * (turn[name] / turn[first] - 1) for turn in turns], n=4)
            cells.append(f"{middle:+.1f} ({low:+.1f} to {high:+.1f})")
        yield f"| {title} | {' | '.join(cells)} |"


def main(arguments):
    if len(arguments) > 1 or arguments[:1] in (["-h"], ["--help"]):
        sys.exit(__doc__)
    (REPOSITORY / "out" / "bench").mkdir(parents=True, exist_ok=True)
    with tempfile.TemporaryDirectory() as folder:
        table = list(rows(built(pathlib.Path(folder))))
    compiler = subprocess.run(["g++", "--version"], capture_output=True, text=True,
                              check=True).stdout.splitlines()[0]
    text = "\n".join([
        f"Medians of {RUNS} runs in turn on one thread, with quartiles; {compiler}, "
        f"`{' '.join(FLAGS)}`, {platform.machine()}:", "",
        "| case | step | fused operations [%] | steps not checked [%] |", "|---|---|---|---|", *table])
    print(text)
    if arguments:
        put_into_page(text, pathlib.Path(arguments[0]), "bench/promise_costs.py")


if __name__ == "__main__":
    main(sys.argv[1:])
