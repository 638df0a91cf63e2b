#!/usr/bin/env python3
# SPDX-License-Identifier: MIT
"""Tests that the pictures in docs/images correspond to the present code.

    check_pictures.py REPOSITORY                      checks the files only
    check_pictures.py REPOSITORY --rerun PROGRAMS     runs the programs in this folder again, and
                                                      compares their results with the record;
                                                      exits with 77 if NumPy is not installed

Faults are mended by examples/pictures and examples/gallery, which redraw the pictures.
"""

import concurrent.futures
import json
import math
import os
import pathlib
import re
import shutil
import subprocess
import sys
import tempfile

SKIPPED = 77
LARGEST = {".png": 150_000, ".webp": 300_000}  # [bytes]


def faults_of(repository):
    """Messages about pictures that are missing, too large, unused or out of date."""
    from support import picture_list as pictures

    examples, images = repository / "examples", repository / "docs" / "images"
    record = json.loads((images / "made_from.json").read_text(encoding="utf-8"))
    pages = [repository / "README.md", *(repository / "docs").rglob("*.md")]
    shown = {name for page in pages for name in
             re.findall(r"images/([\w./-]+\.(?:png|webp))", page.read_text(encoding="utf-8"))}
    there = {path.relative_to(images).as_posix() for path in images.rglob("*")
             if path.suffix in LARGEST}
    sources = pictures.SOURCES + pictures.STUDIES + pictures.GALLERY
    made = {name for source in sources for name in source.pictures.values()}
    for name in sorted(shown | there | made):
        if name not in there:
            yield f"{name}: shown on a page, but there is no such file"
        elif name not in shown:
            yield f"{name}: shown on no page"
        elif name not in made:
            yield f"{name}: neither examples/pictures nor examples/gallery makes it"
        elif (images / name).stat().st_size > (most := LARGEST[(images / name).suffix]):
            yield f"{name}: larger than {most / 1000:g} kB"
    page = (repository / "docs" / "gallery.md").read_text(encoding="utf-8")
    for item in pictures.GALLERY:
        if f"`examples/gallery {item.short_name}`" not in page:
            yield f"{item.short_name}: docs/gallery.md does not name the command that makes it"
    for source in sources:
        is_item = isinstance(source, pictures.GalleryItem)
        command = f"examples/{'gallery' if is_item else 'pictures'} {source.picked_by()[0]}"
        for fault in faults_of_source(source, record.get(source.name), images, examples):
            yield f"{source.name}: {fault}; run {command}"


def faults_of_source(source, entry, images, examples):
    from support import picture_list as pictures

    if entry is None:
        yield "made_from.json has no entry"
        return
    for name in source.pictures.values():
        path = images / name
        if path.exists() and pictures.digest_of(path.read_bytes()) != entry["pictures"].get(name):
            yield f"{name} is not the file recorded in made_from.json"
    if entry["commands"] != source.command_lines():
        yield "its pictures were drawn with other commands"
    if entry["drawing"] != pictures.drawing_of(source.drawn_by, examples):
        yield f"{source.drawn_by}, or a module of support/ that it imports, has changed since"
    if isinstance(source, pictures.Step):
        if entry["program"] != source.program_digest(examples):
            yield f"{source.program}.cpp has changed since"
        pages = (examples.parent / "docs" / "tutorial").glob("*.md")
        if not any(source.command_on_page() in page.read_text(encoding="utf-8") for page in pages):
            yield f"no page of the tutorial has its command, {source.command_on_page()}"
    if "options" in entry:
        # Two runs may give the same message.
        yield from dict.fromkeys(
            pictures.changed_options(source, entry["options"], examples))


def differences(recorded, found, where=""):
    """Integers must be equal, other numbers within one per cent."""
    if isinstance(recorded, dict) and isinstance(found, dict):
        for key in recorded.keys() | found.keys():
            yield from differences(recorded.get(key), found.get(key), f"{where}{key}: ")
    elif isinstance(recorded, float) and isinstance(found, (int, float)):
        if not math.isclose(recorded, found, rel_tol=0.01, abs_tol=1e-9):
            yield f"{where}{recorded:g} then, {found:g} now"
    elif recorded != found:
        yield f"{where}{recorded} then, {found} now"


def use_python_with_numpy():
    """Continues this script with Debian's interpreter if this one lacks NumPy and that has it;
    otherwise skips the test."""
    from support import modules

    if modules.has("numpy"):
        return
    has_numpy = [modules.SYSTEM_PYTHON, "-c", "import numpy"]
    if sys.executable != modules.SYSTEM_PYTHON and subprocess.run(
            has_numpy, capture_output=True, check=False).returncode == 0:
        os.execv(modules.SYSTEM_PYTHON, [modules.SYSTEM_PYTHON, *sys.argv])
    print("skipped: NumPy is not installed")
    sys.exit(SKIPPED)


def rerun(repository, programs):
    use_python_with_numpy()
    from support import picture_list as pictures

    record = json.loads(pictures.RECORD.read_text(encoding="utf-8"))

    def record_now(source):
        with tempfile.TemporaryDirectory() as name:
            folder = pathlib.Path(name)
            source.run(programs, folder, threads=1)
            return source.record(folder)

    # Results are the same with any number of threads: two programs need less time than two threads.
    with concurrent.futures.ThreadPoolExecutor(2) as workers:
        for source, now in zip(pictures.SOURCES, workers.map(record_now, pictures.SOURCES)):
            then = {key: record[source.name][key] for key in now}
            for difference in differences(then, now):
                yield f"{source.name}: {difference}; run examples/pictures"


def self_test(repository):
    """Checks that relevant changes are detected, and that others are not."""
    from support.picture_list import GALLERY

    with tempfile.TemporaryDirectory() as name:
        copy = pathlib.Path(name)
        for part in ("examples", "docs"):
            shutil.copytree(repository / part, copy / part)
        shutil.copyfile(repository / "README.md", copy / "README.md")
        assert not list(faults_of(copy))

        def after(path, old, new):
            """The faults after replacing this text."""
            text = (copy / path).read_text(encoding="utf-8")
            assert old in text, f"{path} has no {old}"
            (copy / path).write_text(text.replace(old, new, 1), encoding="utf-8")
            faults = [fault.split(":")[0] for fault in faults_of(copy)]
            (copy / path).write_text(text, encoding="utf-8")
            return faults

        tower = ["broken_tower"]
        films = ["gallery/broken_tower_3d", "gallery/broken_tower_2d"]
        assert after("examples/broken_tower.cpp", "int rows = 30;", "int rows = 31;") == \
            tower + films
        assert set(after("examples/support/scenes.py", "SUPERSAMPLING = 2", "SUPERSAMPLING = 1")) \
            == {item.name for item in GALLERY if item.is_3d}
        script = "examples/plot_broken_tower.py"
        assert after(script, "class Run:", "COLOUR = 1\nclass Run:") == tower
        assert not after(script, "class Run:", "# A comment.\nclass Run:")
        assert "dam_break" in after("examples/support/plot_style.py", "NARROW = 6.4",
                                        "NARROW = 6.5")
        assert after("examples/tutorial/first_fall.cpp", "int main() {", "int main() {;") == [
            "tutorial_first_fall"]
        assert not after("examples/tutorial/first_fall.cpp", "int main() {", "int main() {  // Run")
        (copy / "docs" / "images" / "hopper.png").write_bytes(b"another")
        assert [fault.split(":")[0] for fault in faults_of(copy)] == ["hopper"]
    assert not list(differences({"a": 1, "b": 1.0}, {"a": 1, "b": 1.005}))
    assert len(list(differences({"a": 5, "b": 1.0}, {"a": 9, "b": 1.02}))) == 2


def main(arguments):
    if len(arguments) not in (1, 3) or arguments[1:2] not in ([], ["--rerun"]):
        sys.exit(__doc__)
    repository = pathlib.Path(arguments[0]).resolve()
    sys.path.insert(0, str(repository / "examples"))
    if len(arguments) == 3:
        faults = list(rerun(repository, pathlib.Path(arguments[2])))
    else:
        faults = list(faults_of(repository))
    if faults:
        sys.exit("\n".join(faults))
    if len(arguments) == 1:
        self_test(repository)
    print("The pictures correspond to the present code.")


if __name__ == "__main__":
    main(sys.argv[1:])
