#!/usr/bin/env python3
# SPDX-License-Identifier: MIT
"""Runs the examples for the pictures of README and docs, draws them, and records the runs.
examples/pictures builds the programs and calls this script.

    pictures.py --programs FOLDER [--all] [--redraw] [--threads N] [NAME…]
"""

import argparse
import json
import os
import pathlib
import shutil
import subprocess
import sys

HERE = pathlib.Path(__file__).resolve().parent
sys.path.insert(0, str(HERE))
from support.picture_list import IMAGES, RECORD, SOURCES, STUDIES, Study, digest_of, drawing_of


def options_of(arguments):
    parser = argparse.ArgumentParser(
        prog="pictures", description="Redraws the pictures of README and docs.")
    parser.add_argument("names", nargs="*", metavar="NAME", help="only these pictures, e.g. "
                        "broken_tower.png")
    parser.add_argument("--all", action="store_true", help="also those of the two long studies")
    parser.add_argument("--redraw", action="store_true",
                        help="draw existing runs in out/pictures instead of repeating them")
    parser.add_argument("--threads", type=int, default=os.cpu_count() or 1,
                        help="number of threads of a program (%(default)s)")
    parser.add_argument("--out", type=pathlib.Path, default=pathlib.Path("out/pictures"),
                        help="folder of the runs (%(default)s)")
    parser.add_argument("--programs", type=pathlib.Path, default=None, help=argparse.SUPPRESS)
    parser.add_argument("--print-programs", action="store_true", help=argparse.SUPPRESS)
    options = parser.parse_args(arguments)
    known = {name: source for source in SOURCES + STUDIES for name in source.pictures.values()}
    if unknown := [name for name in options.names if name not in known]:
        parser.error(f"{', '.join(unknown)}: no such picture; the pictures are {', '.join(known)}")
    requested = [known[name] for name in options.names]
    options.sources = [source for source in SOURCES + STUDIES if
                       (source in requested if requested else source in SOURCES or options.all)]
    return options


def call(*command):
    print("$", *command, flush=True)
    if (code := subprocess.run([str(part) for part in command]).returncode) != 0:
        sys.exit(f"pictures: {pathlib.Path(command[0]).name} ended with {code}")


def make(source, options):
    """Runs and draws a source; returns its folder."""
    folder = options.out / source.name
    if isinstance(source, Study):
        # A study keeps runs with the same options, and resumes if it was stopped.
        script, *arguments = source.argv(options.programs, folder, options.threads)
        call(sys.executable, HERE / script, *arguments)
        return folder
    if not options.redraw:
        shutil.rmtree(folder, ignore_errors=True)
        print(f"Running {source.program}", flush=True)
        try:
            source.run(options.programs, folder, options.threads)
        except subprocess.CalledProcessError as error:
            sys.exit(f"pictures: {source.program} ended with {error.returncode}")
    script, *arguments = source.drawing_command(folder)
    call(sys.executable, HERE / script, *arguments)
    return folder


def entry_of(source, folder):
    entry = {"commands": source.command_lines(),
             "pictures": {name: digest_of((IMAGES / name).read_bytes())
                          for name in source.pictures.values()},
             "drawing": drawing_of(source.drawn_by)}
    if not isinstance(source, Study):
        entry |= source.record(folder)
    return entry


def main(arguments):
    options = options_of(arguments)
    if options.print_programs:
        programs = {getattr(source, "program", source.name) for source in options.sources}
        if "paper" in programs:
            programs = programs - {"paper"} | {"dam_break", "hydrostatic"}
        print(*sorted(programs))
        return
    record = json.loads(RECORD.read_text(encoding="utf-8")) if RECORD.exists() else {}
    for source in options.sources:
        folder = make(source, options)
        for made, name in source.pictures.items():
            shutil.copyfile(folder / made, IMAGES / name)
            print(f"Written: docs/images/{name}, {(IMAGES / name).stat().st_size / 1e3:.0f} kB",
                  flush=True)
        record[source.name] = entry_of(source, folder)
        # Written after each source, because the next may be stopped.
        RECORD.write_text(json.dumps(dict(sorted(record.items())), indent=2, ensure_ascii=False)
                          + "\n", encoding="utf-8")


if __name__ == "__main__":
    main(sys.argv[1:])
