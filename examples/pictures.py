#!/usr/bin/env python3
# SPDX-License-Identifier: MIT
"""Runs the examples for the pictures of README and docs, draws them, and records the runs.
examples/pictures and examples/gallery build the programs and call this script.

    pictures.py --programs FOLDER [--all] [--redraw] [--threads N] [NAME…]
    pictures.py --programs FOLDER --gallery [--redraw | --short] [--threads N] [NAME…]
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
from support.picture_list import (GALLERY, IMAGES, RECORD, SOURCES, STUDIES, GalleryItem, Study,
                                  digest_of, drawing_of)


def options_of(arguments):
    is_gallery = "--gallery" in arguments
    parser = argparse.ArgumentParser(
        prog="gallery" if is_gallery else "pictures",
        description="Makes the films and pictures of docs/gallery.md." if is_gallery else
        "Redraws the pictures of README and docs.")
    example = "dam_break_3d" if is_gallery else "broken_tower.png"
    parser.add_argument("names", nargs="*", metavar="NAME", help=f"only these, e.g. {example}")
    parser.add_argument("--gallery", action="store_true", help=argparse.SUPPRESS)
    if is_gallery:
        parser.add_argument("--short", action="store_true",
                            help="for tests: short runs and at most three frames of each, not "
                            "copied to docs/images")
        parser.set_defaults(all=False)
    else:
        parser.add_argument("--all", action="store_true", help="also those of the two long studies")
        parser.set_defaults(short=False)
    parser.add_argument("--redraw", action="store_true",
                        help="draw existing runs instead of repeating them")
    parser.add_argument("--threads", type=int, default=os.cpu_count() or 1,
                        help="number of threads of a program (%(default)s)")
    parser.add_argument("--out", type=pathlib.Path, default=pathlib.Path("out/pictures"),
                        help="folder of the runs (%(default)s)")
    parser.add_argument("--programs", type=pathlib.Path, default=None, help=argparse.SUPPRESS)
    parser.add_argument("--print-programs", action="store_true", help=argparse.SUPPRESS)
    options = parser.parse_args(arguments)
    usual, further = (GALLERY, []) if is_gallery else (SOURCES, STUDIES)
    known = {name: source for source in usual + further for name in source.picked_by()}
    if unknown := [name for name in options.names if name not in known]:
        parser.error(f"{', '.join(unknown)}: no such picture; the pictures are {', '.join(known)}")
    requested = [known[name] for name in options.names]
    options.sources = [source for source in usual + further if
                       (source in requested if requested else source in usual or options.all)]
    return options


def call(*command, cwd=None):
    print("$", *command, flush=True)
    code = subprocess.run([str(part) for part in command], cwd=cwd, check=False).returncode
    if code != 0:
        sys.exit(f"pictures: {pathlib.Path(command[0]).name} ended with {code}")


def make(source, options):
    """Runs and draws a source; returns its folder."""
    folder = options.out / source.name
    if isinstance(source, GalleryItem):
        make_item(source, options, folder)
        return folder
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


def make_item(item, options, folder):
    """Runs the program, unless the folder has its output already, and draws it."""
    program = options.programs.resolve() / item.program
    given = item.command_of("", options.short)[1:]
    # Written after the run, which is repeated if its options or the program have changed.
    complete = folder / "complete.json"
    is_there = complete.exists() and json.loads(complete.read_text(encoding="utf-8")) == given \
        and complete.stat().st_mtime > program.stat().st_mtime
    if not (is_there or options.redraw):
        shutil.rmtree(folder, ignore_errors=True)
        folder.mkdir(parents=True)
        if item.has_options:
            call(program, *given, "--threads", options.threads, "--out", folder)
        else:
            call(program, cwd=folder)
        complete.write_text(json.dumps(given), encoding="utf-8")
    script, *arguments = item.drawing_command(folder)
    display = ["xvfb-run", "-a"] if item.is_3d else []
    call(*display, sys.executable, HERE / script, *arguments,
         *(["--frames", 3] if options.short else []))


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
    # Waiting threads must not spin while other programs run.
    os.environ.setdefault("OMP_WAIT_POLICY", "passive")
    record = json.loads(RECORD.read_text(encoding="utf-8")) if RECORD.exists() else {}
    for source in options.sources:
        folder = make(source, options)
        if options.short:
            continue
        for made, name in source.pictures.items():
            (IMAGES / name).parent.mkdir(exist_ok=True)
            shutil.copyfile(folder / made, IMAGES / name)
            print(f"Written: docs/images/{name}, {(IMAGES / name).stat().st_size / 1e3:.0f} kB",
                  flush=True)
        record[source.name] = entry_of(source, folder)
        # Written after each source, because the next may be stopped.
        RECORD.write_text(json.dumps(dict(sorted(record.items())), indent=2, ensure_ascii=False)
                          + "\n", encoding="utf-8")


if __name__ == "__main__":
    main(sys.argv[1:])
