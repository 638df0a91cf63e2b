#!/usr/bin/env python3
# SPDX-License-Identifier: MIT
"""Writes the library, or a part of it, as a single header.

    amalgamate.py OUTPUT [HEADER...]

    .cmake/amalgamate.py silt.hpp                                 all that needs only Eigen
    .cmake/amalgamate.py silt_dem.hpp silt/dem.hpp silt/io/vtk.hpp  these, and what they include
    .cmake/amalgamate.py silt.hpp silt/silt.hpp silt/mpi.hpp      with an optional header

Every header of the library appears once, in the order of inclusion; of those that are included once for
each instruction set, that part appears as often. Other headers, those of Eigen and of
the standard library, are still included. The single header replaces the folder include/silt: a program
must not include both.
"""

import pathlib
import re
import sys

REPOSITORY = pathlib.Path(__file__).resolve().parent.parent
INCLUDE = re.compile(r"#\s*include\s*<([^>]+)>")
BEGIN_OF_CONDITION = re.compile(r"#\s*if")
OTHER_BRANCH = re.compile(r"#\s*el")
END_OF_CONDITION = re.compile(r"#\s*endif")
MACRO = re.compile(r"#\s*define\s+(\w+)")
SPDX = "// SPDX-License-Identifier: MIT"
# Includes a part of a header for each instruction set.
LOOP = "silt/core/each_instruction_set.hpp"
KERNELS = re.compile(r"#ifndef SILT_INSTRUCTION_SET\n#ifndef (\w+)\n#define \1\n(.*)^#endif\n#else\n(.*)^#endif\n*\Z", re.M | re.S)
# Headers that need a library other than Eigen.
OPTIONAL = re.compile(r"silt/(mpi\.hpp|mpi/.*|solve/hypre.*)")


class Refused(Exception):
    """A header that cannot be part of a single header."""


class Amalgamation:
    def __init__(self, include):
        self.include = pathlib.Path(include)
        self.lines = []
        self.conditions = []  # the headers that each of the open conditions has added
        self.added = set()    # headers whose text or #include precedes
        self.lost = set()     # those that precede only under a condition

    def add(self, name):
        """Appends the text of a header of the library, after the headers that it includes."""
        if name in self.added:
            return
        if name in self.lost:
            raise Refused(f"{name} is included under a condition before it is included without; name it, "
                          "or a header that includes it, earlier")
        path = self.include / name
        if not path.is_file():
            raise Refused(f"there is no header {name} in {self.include}")
        self.note(name)
        text = path.read_text(encoding="utf-8")
        kernels = KERNELS.search(text)
        if kernels:
            text = text[:kernels.start()] + kernels[2]
        heading = ["", f"// --- {name}"]  # and the comment at its top; comes after the headers that it includes
        self.add_text(name, text, heading, kernels[3] if kernels else "")

    def add_loop(self, kernels):
        """Appends the part of a header for each instruction set."""
        self.add("silt/core/instruction_set.hpp")
        text = (self.include / LOOP).read_text(encoding="utf-8")
        text = text[text.index("#ifdef SILT_KERNELS\n"):text.index("#undef SILT_KERNELS\n")].split("\n", 1)[1]
        for number, part in enumerate(text.split("#include SILT_KERNELS\n")):
            if number > 0:
                self.lines += kernels.strip("\n").splitlines()
            self.lines += [line for line in part.splitlines() if line and not line.startswith("//")]

    def add_text(self, name, text, heading, kernels):
        depth = len(self.conditions)
        for line in text.splitlines():
            include = INCLUDE.match(line)
            if line in (SPDX, "#pragma once") or (include and include[1] in self.added):
                continue
            if include and include[1] == LOOP:
                self.add_loop(kernels)
            elif include and include[1].startswith("silt/"):
                self.add(include[1])
            elif line.startswith("#define SILT_KERNELS "):
                pass
            elif heading and line.startswith("//"):
                heading.append(line)
            elif line or not heading:
                self.lines += [*heading, line]
                heading = []
                if include:
                    self.note(include[1])
                self.follow_conditions(line)
                self.check_macro(name, line)
        self.lines += heading
        if len(self.conditions) != depth:
            raise Refused(f"{name} ends within a condition")

    def note(self, name):
        self.added.add(name)
        if self.conditions:
            self.conditions[-1].add(name)

    def follow_conditions(self, line):
        """A header that was added under a condition is not there after it."""
        if BEGIN_OF_CONDITION.match(line):
            self.conditions.append(set())
        elif OTHER_BRANCH.match(line) or END_OF_CONDITION.match(line):
            under_condition = self.conditions.pop()
            self.added -= under_condition
            self.lost |= {name for name in under_condition if name.startswith("silt/")}
            if OTHER_BRANCH.match(line):
                self.conditions.append(set())

    @staticmethod
    def check_macro(name, line):
        macro = MACRO.match(line)
        if macro and not macro[1].startswith("SILT_"):
            raise Refused(f"{name} defines the macro {macro[1]}; macros of the library begin with SILT_")


def version_of(include):
    text = pathlib.Path(include, "silt/version.hpp").read_text(encoding="utf-8")
    return ".".join(re.findall(r"#define SILT_VERSION_(?:MAJOR|MINOR|PATCH) (\d+)", text))


def default_headers(include):
    names = sorted(path.relative_to(include).as_posix() for path in pathlib.Path(include).rglob("*.hpp"))
    return ["silt/silt.hpp", *(name for name in names if name != LOOP and not OPTIONAL.fullmatch(name))]


def amalgamate(repository, headers=()):
    """The text of the single header."""
    include = pathlib.Path(repository, "include")
    amalgamation = Amalgamation(include)
    for name in headers:
        amalgamation.add(name)
    for name in () if headers else default_headers(include):
        if name not in amalgamation.lost:
            amalgamation.add(name)
    licence = pathlib.Path(repository, "LICENSE").read_text(encoding="utf-8").strip()
    return "\n".join([
        SPDX, f"// Silt {version_of(include)} as a single header, written by .cmake/amalgamate.py.", "//",
        *(f"// {line}".rstrip() for line in licence.splitlines()), "#pragma once", *amalgamation.lines, ""])


def main(arguments):
    if not arguments or arguments[0].startswith("-"):
        sys.exit(__doc__)
    output, *headers = arguments
    try:
        text = amalgamate(REPOSITORY, headers)
    except Refused as refusal:
        sys.exit(f"amalgamate.py: {refusal}")
    try:
        pathlib.Path(output).write_text(text, encoding="utf-8")
    except OSError as error:
        sys.exit(f"amalgamate.py: cannot write {output}: {error.strerror}")


if __name__ == "__main__":
    main(sys.argv[1:])
