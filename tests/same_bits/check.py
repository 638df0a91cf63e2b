#!/usr/bin/env python3
# SPDX-License-Identifier: MIT
"""Runs an example with 1, 2, 3 and 4 threads and checks that its files are bitwise identical.

    check.py SCRATCH PROGRAM ARGUMENTS...
    check.py --self-test

The program must have --threads and --out. In summary.json, wall-clock times (names with "seconds")
and the options threads and out are ignored; in arguments.json, --threads.
"""

import concurrent.futures
import json
import pathlib
import shutil
import subprocess
import sys
import tempfile


def without_clock(value):
    """The value without wall-clock times and without the two options that differ."""
    if isinstance(value, list):
        return [without_clock(inner) for inner in value]
    if isinstance(value, dict):
        return {
            name: without_clock(inner)
            for name, inner in value.items()
            if "seconds" not in name and name not in ("threads", "out")
        }
    return value


def contents(path):
    if path.name == "summary.json":
        return without_clock(json.loads(path.read_text(encoding="utf-8")))
    if path.name == "arguments.json":
        arguments = json.loads(path.read_text(encoding="utf-8"))["arguments"]
        if "--threads" in arguments:
            index = arguments.index("--threads")
            del arguments[index:index + 2]
        return arguments
    return path.read_bytes()


def files_in(folder):
    return {path.relative_to(folder): path for path in folder.rglob("*") if path.is_file()}


def differences(right, other):
    """The files that exist in one folder only, or that differ."""
    ours, theirs = files_in(right), files_in(other)
    return sorted(
        name.as_posix()
        for name in ours.keys() | theirs.keys()
        if name not in ours or name not in theirs or contents(ours[name]) != contents(theirs[name])
    )


def check(scratch, program, arguments):
    shutil.rmtree(scratch, ignore_errors=True)
    folders = {threads: scratch / str(threads) for threads in (1, 2, 3, 4)}

    def run(threads):
        subprocess.run(
            [program, *arguments, "--threads", str(threads), "--out", str(folders[threads])],
            stdout=subprocess.DEVNULL,
            check=True,
        )

    # Two at once, because the run with one thread leaves the other core idle.
    with concurrent.futures.ThreadPoolExecutor(2) as workers:
        list(workers.map(run, folders))
    folders = list(folders.values())
    sound = True
    for folder in folders[1:]:
        for name in differences(folders[0], folder):
            print(f"{name} with {folder.name} threads differs from that with one thread")
            sound = False
    print(f"{len(files_in(folders[0]))} files of {program} compared")
    return sound and bool(files_in(folders[0]))


def self_test():
    with tempfile.TemporaryDirectory() as name:
        a, b = pathlib.Path(name, "a"), pathlib.Path(name, "b")
        for folder, threads in ((a, 1), (b, 2)):
            folder.mkdir()
            (folder / "same.csv").write_text("1\n", encoding="utf-8")
            (folder / "other.csv").write_text(f"{threads}\n", encoding="utf-8")
            clock = {"wall_seconds": threads}
            summary = {"runs": [clock], "options": {"threads": threads, "out": str(folder)}}
            (folder / "summary.json").write_text(json.dumps(summary), encoding="utf-8")
            given = {"arguments": ["--threads", str(threads), "--until", "1"]}
            (folder / "arguments.json").write_text(json.dumps(given), encoding="utf-8")
        (b / "more.csv").write_text("", encoding="utf-8")
        assert differences(a, b) == ["more.csv", "other.csv"]


def main(arguments):
    if arguments == ["--self-test"]:
        self_test()
    elif len(arguments) < 2:
        sys.exit(__doc__)
    elif not check(pathlib.Path(arguments[0]), arguments[1], arguments[2:]):
        sys.exit(1)


if __name__ == "__main__":
    main(sys.argv[1:])
