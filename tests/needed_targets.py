# SPDX-License-Identifier: MIT
"""Used by tests/run: prints the targets of the tests that ctest selects.

    ctest --show-only=json-v1 … | needed_targets.py BUILD-FOLDER KNOWN-TARGETS

They have the names of the files of the build folder in the commands of the tests, which ctest knows
from its files there; it prints none of a program that is not built yet. The programs of GoogleTest
are the target matching_tests."""

import json
import os
import pathlib
import re
import sys

# Their commands name folders, not programs.
UNKNOWN = re.compile(r"python[.]|examples[.](pictures_rerun|gallery)$")
TEST = re.compile(r"^add_test\((?:\[=*\[)?(.*?)(?:\]=*\])? (\".*)\)$", re.M)


def main(build, known):
    known = set(re.findall(r"\w+", known))
    files = {}
    for listing in pathlib.Path(build).glob("*/CTestTestfile.cmake"):
        for name, command in TEST.findall(listing.read_text(encoding="utf-8")):
            files[name] = re.findall(r'"([^"]*)"', command)
    targets = {"matching_tests"}
    for test in json.load(sys.stdin)["tests"]:
        if UNKNOWN.match(test["name"]):
            return {"all"}
        targets |= {os.path.basename(file) for file in files.get(test["name"], ())
                    if file.startswith(build + os.sep)} & known
    return targets


print(*sorted(main(*sys.argv[1:])))
