#!/usr/bin/env python3
# SPDX-License-Identifier: MIT
"""Measures how long a user's program takes to compile.

    compile_time.py          compiles the two quickstarts with g++ and, if installed, clang++ and
                             clang++-19, and prints a table
    compile_time.py PAGE     also puts the table between the two comments in PAGE that ask for it

Figures are processor times, medians of three: they depend less than wall times on what else the
machine is doing. `parsed` is the time without optimisation and code generation (-fsyntax-only),
`text` the size of the program's code as `size` counts it.
To see which templates take the time, add -ftime-trace (clang++) to FLAGS.
"""

import pathlib
import platform
import resource
import shutil
import statistics
import subprocess
import sys
import tempfile

from report import put_into_page

REPOSITORY = pathlib.Path(__file__).resolve().parents[1]
EXAMPLES = ["quickstart_tower", "quickstart_dam"]
FLAGS = ["-std=c++20", "-O2", "-ffp-contract=off"]
RUNS = 3


def includes():
    eigen = subprocess.run(["pkg-config", "--cflags", "eigen3"], capture_output=True, text=True,
                           check=False).stdout.split() or ["-I/usr/include/eigen3"]
    return [f"-I{REPOSITORY / 'include'}", *eigen]


def processor_seconds(command):
    before = resource.getrusage(resource.RUSAGE_CHILDREN)
    subprocess.run(command, check=True)
    after = resource.getrusage(resource.RUSAGE_CHILDREN)
    return after.ru_utime + after.ru_stime - before.ru_utime - before.ru_stime


def median(command):
    return statistics.median(processor_seconds(command) for _ in range(RUNS))


def text_of(program):
    counted = subprocess.run(["size", program], capture_output=True, text=True, check=True).stdout
    return int(counted.splitlines()[1].split()[0])


def has_openmp(compiler):
    return subprocess.run([compiler, "-fopenmp", "-x", "c++", "-fsyntax-only", "-"],
                          input="#include <omp.h>\n", text=True, capture_output=True,
                          check=False).returncode == 0


def rows():
    with tempfile.TemporaryDirectory() as scratch:
        output = pathlib.Path(scratch, "program.o")
        for compiler in filter(shutil.which, ("g++", "clang++", "clang++-19")):
            version = subprocess.run([compiler, "--version"], capture_output=True, text=True,
                                     check=True).stdout.splitlines()[0]
            openmp = ["-fopenmp"] if has_openmp(compiler) else []
            for name in EXAMPLES:
                command = [compiler, *FLAGS, *openmp, *includes(),
                           REPOSITORY / "examples" / f"{name}.cpp"]
                print(f"Compiling {name} with {compiler} …", file=sys.stderr, flush=True)
                whole = median([*command, "-c", "-o", output])
                parsed = median([*command, "-fsyntax-only"])
                yield (f"| {version} | `{name}` | {whole:.1f} | {parsed:.1f} |"
                       f" {text_of(output) / 1000:.0f} |")


def main(arguments):
    if len(arguments) > 1 or arguments[:1] in (["-h"], ["--help"]):
        sys.exit(__doc__)
    text = "\n".join([
        f"Processor seconds, with `{' '.join(FLAGS)}`, on {platform.machine()}:", "",
        "| compiler | program | compiled | parsed | text [kB] |", "|---|---|---|---|---|", *rows()])
    print(text)
    if arguments:
        put_into_page(text, pathlib.Path(arguments[0]), "bench/compile_time.py")


if __name__ == "__main__":
    main(sys.argv[1:])
