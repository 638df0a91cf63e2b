# SPDX-License-Identifier: MIT
"""Used by tests/run: prints the targets of the tests that ctest selects.

    ctest --show-only=json-v1 … | needed_targets.py BUILD-FOLDER KNOWN-TARGETS

They have the names of the files of the build folder in the commands of the tests. The programs of
GoogleTest are the target matching_tests."""

import json
import os
import re
import sys

# Their commands name folders, not programs.
UNKNOWN = re.compile(r"python[.]|examples[.](pictures_rerun|gallery)$")


def main(build, known):
    known = set(re.findall(r"\w+", known))
    targets = {"matching_tests"}
    for test in json.load(sys.stdin)["tests"]:
        if UNKNOWN.match(test["name"]):
            return {"all"}
        targets |= {os.path.basename(word) for word in test.get("command", ())
                    if word.startswith(build + os.sep)} & known
    return targets


print(*sorted(main(*sys.argv[1:])))
