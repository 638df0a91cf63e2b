#!/usr/bin/env python3
# SPDX-License-Identifier: MIT
"""Makes a small version of some items of the gallery, of every kind: films of grains and of water in
2D and 3D, of water with openings, a hopper from its STL file, and a still picture. Checks that the files
are as they should be.

    check_gallery.py REPOSITORY PROGRAMS SCRATCH

Exits with 77 if a module or the virtual screen is missing.
"""

import os
import pathlib
import shutil
import subprocess
import sys

SKIPPED = 77
FRAMES = 3
FILMS = ("broken_tower_2d", "dam_break_2d", "own_field", "hydraulic_jump", "broken_tower_3d",
         "dam_break_3d", "hopper_3d")
STILLS = ("own_contact_law",)
MODULES = "numpy, matplotlib, PIL, vtk"


def use_python_with_modules():
    """Continues this script with Debian's interpreter if this one lacks modules and that has them;
    otherwise skips the test."""
    from support.modules import SYSTEM_PYTHON

    def has(python):
        return subprocess.run([python, "-c", f"import {MODULES}"], capture_output=True,
                              check=False).returncode == 0

    if not has(sys.executable):
        if sys.executable != SYSTEM_PYTHON and os.access(SYSTEM_PYTHON, os.X_OK) \
                and has(SYSTEM_PYTHON):
            os.execv(SYSTEM_PYTHON, [SYSTEM_PYTHON, *sys.argv])
        print(f"skipped: not all of these modules are installed: {MODULES}")
        sys.exit(SKIPPED)
    for program in ("xvfb-run", "xauth"):
        if not shutil.which(program):
            print(f"skipped: {program} is not installed")
            sys.exit(SKIPPED)


def faults_of(path, frames):
    import numpy as np
    from PIL import Image, ImageSequence

    if not path.exists():
        return ["was not written"]
    faults = []
    if path.stat().st_size > 300_000:
        faults.append(f"has {path.stat().st_size} bytes")
    with Image.open(path) as image:
        if image.format != "WEBP":
            faults.append(f"is {image.format}")
        images = [np.asarray(frame.convert("RGB"), dtype=int)
                  for frame in ImageSequence.Iterator(image)]
    if not min(2, frames) <= len(images) <= frames:
        faults.append(f"has {len(images)} frames instead of {frames}")
    for number, pixels in enumerate(images):
        # The particles, besides texts and walls: a share of the picture that is coloured.
        coloured = np.mean(pixels.max(axis=2) - pixels.min(axis=2) > 60)
        if coloured < 0.003:
            faults.append(f"is blank in frame {number}: {100 * coloured:.2f} % is coloured")
    for number, (one, next_one) in enumerate(zip(images, images[1:])):
        if np.mean(np.abs(one - next_one).max(axis=2) > 30) < 1e-4:
            faults.append(f"does not move after frame {number}")
    return faults


def main(repository, programs, scratch):
    sys.path.insert(0, str(repository / "examples"))
    use_python_with_modules()
    shutil.rmtree(scratch, ignore_errors=True)
    script = [sys.executable, repository / "examples" / "pictures.py", "--gallery", "--short",
              "--programs", programs, "--out", scratch, "--threads", "1"]
    images = repository / "docs" / "images"
    before = {path: path.stat().st_mtime_ns for path in images.rglob("*")}
    subprocess.run([*script, *FILMS, *STILLS], check=True)
    faults = []
    for names, frames in ((FILMS, FRAMES), (STILLS, 1)):
        for name in names:
            path = scratch / "gallery" / name / f"{name}.webp"
            faults += [f"{name} {fault}" for fault in faults_of(path, frames)]
    if before != {path: path.stat().st_mtime_ns for path in images.rglob("*")}:
        faults.append("a test has changed docs/images")

    # A run whose output is there is not repeated.
    again = subprocess.run([*script, STILLS[0]], capture_output=True, text=True, check=True)
    if f"{programs / STILLS[0]}" in again.stdout:
        faults.append(f"{STILLS[0]} was run again")
    wrong = subprocess.run([*script, "no_such_film"], capture_output=True, text=True, check=False)
    if wrong.returncode == 0 or "no_such_film: no such picture" not in wrong.stderr:
        faults.append(f"an unknown name is accepted: {wrong.stderr}")
    if faults:
        sys.exit("\n".join(faults))
    print("The gallery is made.")


if __name__ == "__main__":
    main(*(pathlib.Path(argument).resolve() for argument in sys.argv[1:]))
