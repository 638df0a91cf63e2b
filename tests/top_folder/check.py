#!/usr/bin/env python3
# SPDX-License-Identifier: MIT
"""Checks that only what belongs there lies in the top folder of the repository: a file that a program
left there is easily committed.

    check.py FOLDER       the top folder; prints what does not belong there and exits with 1
    check.py --self-test  checks that a file too many is found
"""

import pathlib
import subprocess
import sys
import tempfile

BELONGS = {"CITATION.cff", "CMakeLists.txt", "CMakePresets.json", "LICENSE", "README.md", "bench", "docs", "examples",
           "include", "python", "tests"}


def committed(folder):
    """Names in the top folder that git knows; all of them without git."""
    git = subprocess.run(["git", "-C", str(folder), "ls-files"], capture_output=True, text=True, check=False)
    paths = git.stdout.splitlines() or [path.name for path in folder.iterdir()]
    return {path.split("/")[0] for path in paths}


def strangers(folder):
    ignored = {"build", "out"}
    return sorted(name for name in committed(folder) - BELONGS - ignored if not name.startswith("."))


def self_test():
    with tempfile.TemporaryDirectory() as name:
        folder = pathlib.Path(name)
        for entry in ("README.md", ".gitignore", "left.input"):
            (folder / entry).write_text("")
        assert strangers(folder) == ["left.input"], strangers(folder)


def main():
    if sys.argv[1:] == ["--self-test"]:
        self_test()
        return
    found = strangers(pathlib.Path(sys.argv[1]))
    for name in found:
        print(f"{name} does not belong in the top folder; remove it, or add it to BELONGS in {__file__}")
    sys.exit(1 if found else 0)


if __name__ == "__main__":
    main()
