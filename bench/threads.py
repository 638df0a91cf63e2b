#!/usr/bin/env python3
# SPDX-License-Identifier: MIT
"""Measures what the automatic number of threads costs or gains, on an idle and on a busy machine.

    threads.py PROGRAMS          runs examples from this folder and prints a table
    threads.py PROGRAMS PAGE     also puts the table between the two comments in PAGE that ask for it

PROGRAMS is the build folder of the examples, build/examples/examples after examples/run; it needs
quickstart_tower, quickstart_dam, broken_tower and dam_break. Each figure is a ratio of wall-clock
times: medians of RUNS alternating runs, with the automatic number of threads, and with one
(OMP_NUM_THREADS=1). On the busy machine an endless loop runs for every core. No other program should
run at the same time.
"""

import contextlib
import os
import pathlib
import statistics
import subprocess
import sys
import tempfile
import time

from report import put_into_page

RUNS = 5
TOWER = ["broken_tower", "--output-every", "10", "--checkpoint-every", "0"]
DAM = ["dam_break", "--output-every", "10", "--checkpoint-every", "0"]
# Title, command on idle cores, command on busy ones (shorter).
CASES = [
    ("quickstart_tower, 101 discs", ["quickstart_tower"], ["quickstart_tower"]),
    ("broken_tower, 1501 discs",
     [*TOWER, "--columns", "30", "--rows", "50", "--until", "0.1"],
     [*TOWER, "--columns", "30", "--rows", "50", "--until", "0.04"]),
    ("dam_break, l0 = 0.02 m", [*DAM, "--spacing", "0.02", "--until", "1"],
     [*DAM, "--spacing", "0.02", "--until", "0.5"]),
    ("dam_break, l0 = 0.01 m", [*DAM, "--until", "0.2"], [*DAM, "--until", "0.1"]),
    ("broken_tower, 32 001 discs",
     [*TOWER, "--columns", "320", "--rows", "100", "--until", "0.01"],
     [*TOWER, "--columns", "320", "--rows", "100", "--until", "0.004"]),
]


def seconds(programs, command, threads):
    environment = {name: value for name, value in os.environ.items() if not name.startswith("OMP_")}
    if threads:
        environment["OMP_NUM_THREADS"] = str(threads)
    with tempfile.TemporaryDirectory() as scratch:
        program, *arguments = command
        if not program.startswith("quickstart"):
            arguments += ["--out", scratch]
        begin = time.monotonic()
        subprocess.run([programs / program, *arguments], env=environment, cwd=scratch, check=True,
                       stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL)
        return time.monotonic() - begin


def medians(programs, command, numbers):
    """Medians of alternating runs, one for each number of threads."""
    times = {threads: [] for threads in numbers}
    for _ in range(RUNS):
        for threads in numbers:
            times[threads].append(seconds(programs, command, threads))
    return [statistics.median(times[threads]) for threads in numbers]


@contextlib.contextmanager
def every_core_busy():
    loops = [subprocess.Popen([sys.executable, "-c", "while True: pass"])
             for _ in range(os.cpu_count())]
    try:
        time.sleep(0.5)
        yield
    finally:
        for loop in loops:
            loop.kill()
            loop.wait()


def rows(programs):
    for title, idle, busy in CASES:
        print(f"Measuring {title} …", file=sys.stderr, flush=True)
        one, automatic, all_cores = medians(programs, idle, (1, 0, os.cpu_count()))
        with every_core_busy():
            busy_one, busy_automatic = medians(programs, busy, (1, 0))
        yield (f"| {title} | {one:.2f} | {automatic / one:.2f} | {all_cores / one:.2f} | "
               f"{busy_one:.2f} | {busy_automatic / busy_one:.2f} |")


def main(arguments):
    if len(arguments) not in (1, 2) or arguments[0].startswith("-"):
        sys.exit(__doc__)
    programs = pathlib.Path(arguments[0]).resolve()
    text = "\n".join([
        f"| {os.cpu_count()} cores | idle, one thread [s] | automatic | OMP_NUM_THREADS="
        f"{os.cpu_count()} | every core busy, one thread [s] | automatic |",
        "|---|---|---|---|---|---|", *rows(programs)])
    print(text)
    if len(arguments) == 2:
        put_into_page(text, pathlib.Path(arguments[1]), "bench/threads.py")


if __name__ == "__main__":
    main(sys.argv[1:])
