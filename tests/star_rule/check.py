#!/usr/bin/env python3
# SPDX-License-Identifier: MIT
"""Checks rules for the text of all headers of the library.

    check.py FOLDER       the include/ folder; prints each fault as file:line and exits with 1
    check.py --self-test  checks that one example of every kind of fault is found

Star rule: a folder under include/silt/ includes core/, itself and what SHARED allows; only the
headers directly in include/silt/ combine folders. A folder may have rooms, see FLOORS: a room includes itself and
the rooms of lower floors only.
"""

import pathlib
import re
import sys
import tempfile

INCLUDE = re.compile(r'^\s*#\s*include\s*([<"])([^>"]+)[>"]')
OPENMP = re.compile(r'#\s*pragma\s+omp\b|_Pragma\s*\(\s*"omp\b')
FORBIDDEN = re.compile(r"^(iostream|regex|ranges|Eigen/Dense|(unsupported/)?Eigen/src/.*)$")
THREADS = "core/parallel.hpp"
LOOP = "core/each_instruction_set.hpp"
# What folders may include in addition to core/ and themselves.
SHARED = {"coupled": {"dem", "geometry", "mps", "search"}, "dem": {"geometry", "integrate"}, "measure": {"geometry"},
          "mpi": {"linear", "solve"}, "mps": {"geometry", "linear"}, "solve": {"linear"}}
# The rooms of folders, from the lowest floor to the highest.
FLOORS = {"dem": [{"law", "wall", "setup"}, {"contact"}, {"bond", "clump", "measure", "conformance"}],
          "mps": [{"fluid"}, {"operator"}, {"policy"}, {"wall"}, {"scheme", "record"},
                  {"view", "setup"}, {"pressure"}, {"step", "filling"}]}


def floor_of(folder, room):
    """The floor of a room, from 0; None if there is no such room."""
    return next((floor for floor, rooms in enumerate(FLOORS[folder]) if room in rooms), None)


def fault_of_room(name, path):
    """A message if the header `name` must not include `path` because of their rooms."""
    folder, room, *rest = name.parts
    own = floor_of(folder, room) if rest else None
    if own is None:
        return f"a header of {folder}/ must be in one of its rooms, see FLOORS in check.py"
    other = path.split("/")[2]
    if path.startswith(f"silt/{folder}/") and other != room and floor_of(folder, other) >= own:
        return f"{folder}/{room}/ may include only itself and rooms on lower floors, not {path}"
    return None


def faults_of(root, header):
    """Yields (line number, message) for each fault of a header below root/silt."""
    name = header.relative_to(root / "silt")
    folder = name.parts[0] if len(name.parts) > 1 else None
    lines = header.read_text(encoding="utf-8").splitlines()

    if not lines or lines[0] != "// SPDX-License-Identifier: MIT":
        yield 1, "the first line must be // SPDX-License-Identifier: MIT"
    if name.as_posix() != LOOP and "#pragma once" not in lines:
        # A header that is included once for each instruction set has guards instead.
        guard = "SILT_" + "_".join(name.with_suffix("").parts).upper()
        if not all(line in lines for line in ("#ifndef SILT_INSTRUCTION_SET", f"#ifndef {guard}", f"#define {guard}",
                                              f"#define SILT_KERNELS <silt/{name.as_posix()}>")):
            yield 1, f"#pragma once, or the guards of SILT_INSTRUCTION_SET and {guard}, are missing"

    for number, line in enumerate(lines, 1):
        if OPENMP.search(line) and name.as_posix() != THREADS:
            yield number, f"only {THREADS} may use OpenMP"
        include = INCLUDE.match(line)
        if not include:
            continue
        bracket, path = include.groups()
        if path == "omp.h" and name.as_posix() != THREADS:
            yield number, f"only {THREADS} may use OpenMP"
        if FORBIDDEN.match(path):
            yield number, f"<{path}> must not be included in a header"

        if path.startswith("silt/"):
            if not (root / path).is_file():
                yield number, f"there is no {path}"
            elif folder and path.split("/")[1] not in (
                    allowed := {"core", folder, *SHARED.get(folder, ())}):
                names = " and ".join(f"{name}/" for name in sorted(allowed))
                yield number, f"{folder}/ may include only {names} of the library, not {path}"
            elif folder in FLOORS and (fault := fault_of_room(name, path)):
                yield number, fault
        elif bracket == '"' or (header.parent / path).is_file():
            yield number, f"include headers of the library by their full path, silt/..., not {path}"


def check(root):
    root = pathlib.Path(root)
    headers = sorted((root / "silt").rglob("*.hpp"))
    return [
        f"{header}:{number}: {message}"
        for header in headers
        for number, message in faults_of(root, header)
    ]


def self_test():
    sound = "// SPDX-License-Identifier: MIT\n#pragma once\n"
    files = {
        "core/types.hpp": "#include <Eigen/Core>\n#include <vector>\n",
        "core/parallel.hpp": "#include <omp.h>\n#pragma omp parallel for\n",
        "search/grid.hpp": "#include <silt/core/types.hpp>\n#include <silt/search/cells.hpp>\n",
        "search/cells.hpp": "",
        "linear/system.hpp": "",
        "solve/jacobi.hpp": "#include <silt/linear/system.hpp>\n",
        "dem/law/law.hpp": "",
        "dem/contact/contacts.hpp": "#include <silt/dem/law/law.hpp>\n",
        "dem/wall/mesh/mesh.hpp": "#include <silt/dem/wall/wall.hpp>\n",
        "dem/wall/wall.hpp": "",
        "dem.hpp": "#include <silt/core/types.hpp>\n#include <silt/search/grid.hpp>\n",
    }
    planted = {
        "another folder": ("search/x.hpp", sound + "#include <silt/dem/law/law.hpp>\n", 3),
        "a shared folder": ("search/x.hpp", sound + "#include <silt/linear/system.hpp>\n", 3),
        "a higher floor": ("dem/law/x.hpp", sound + "#include <silt/dem/contact/contacts.hpp>\n", 3),
        "the same floor": ("dem/law/x.hpp", sound + "#include <silt/dem/wall/wall.hpp>\n", 3),
        "no room": ("dem/x.hpp", sound + "#include <silt/dem/law/law.hpp>\n", 3),
        "a folder from core": ("core/x.hpp", sound + "#include <silt/search/grid.hpp>\n", 3),
        "an umbrella": ("search/x.hpp", sound + "#include <silt/dem.hpp>\n", 3),
        "a short path": ("search/x.hpp", sound + '#include "cells.hpp"\n', 3),
        "a short path in brackets": ("search/x.hpp", sound + "#include <cells.hpp>\n", 3),
        "a missing header": ("search/x.hpp", sound + "#include <silt/core/y.hpp>\n", 3),
        "a forbidden header": ("core/x.hpp", sound + "#  include <iostream>\n", 3),
        "all of Eigen": ("core/x.hpp", sound + "#include <Eigen/Dense>\n", 3),
        "Eigen's inside": ("core/x.hpp", sound + "#include <Eigen/src/Core/util/Macros.h>\n", 3),
        "omp.h": ("dem/x.hpp", sound + "#include <omp.h>\n", 3),
        "an OpenMP pragma": ("dem/x.hpp", sound + "#pragma omp simd\n", 3),
        "an OpenMP operator": ("dem/x.hpp", sound + '_Pragma("omp simd")\n', 3),
        "no licence": ("core/x.hpp", "// A file.\n#pragma once\n", 1),
        "no guard": ("core/x.hpp", "// SPDX-License-Identifier: MIT\n", 1),
    }

    def write(root, name, text):
        path = root / "silt" / name
        path.parent.mkdir(parents=True, exist_ok=True)
        path.write_text(text, encoding="utf-8")

    wrong = []
    for what, (name, text, line) in {"nothing": (None, "", 0), **planted}.items():
        with tempfile.TemporaryDirectory() as folder:
            root = pathlib.Path(folder)
            for sound_name, body in files.items():
                write(root, sound_name, sound + body)
            if name:
                write(root, name, text)
            found = check(root)
            expected = f"{root / 'silt' / name}:{line}: " if name else None
            if [fault.startswith(expected) for fault in found] != ([True] if name else []):
                wrong.append(f"planted {what}, found {found}")
    return wrong


def main(arguments):
    if len(arguments) != 1:
        sys.exit(__doc__)
    faults = self_test() if arguments[0] == "--self-test" else check(arguments[0])
    for fault in faults:
        print(fault)
    sys.exit(1 if faults else 0)


if __name__ == "__main__":
    main(sys.argv[1:])
