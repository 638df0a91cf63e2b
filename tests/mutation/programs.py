# SPDX-License-Identifier: MIT
"""Test programs: one per test source, compiled as by tests/CMakeLists.txt, and the
sources that include a header."""

import collections
import functools
import hashlib
import os
import pathlib
import re
import shlex
import shutil
import subprocess
import sys
import tempfile

from processes import Ran

INCLUDE = re.compile(r'^\s*#\s*include\s*[<"]([^>"]+)[>"]', re.MULTILINE)
FOLDERS = ("core", "dem", "geometry", "integrate", "io", "measure", "mps", "trust", "search",
           "solve", "validation")
NOT_TESTED = {name: "it needs an optional library"
              for name in ("solve/hypre.hpp", "solve/hypre_multigrid.hpp")}
HASHES = "tests/portability/hashes.cpp"
MEMBERS = "tests/restart_members/check.py"
# Programs with the first need one copy of the second, which another source may include.
COUNTED, COUNTING = "tests/support/counted_memory.hpp", "tests/support/failing_allocations.hpp"
FLAGS = ["-std=c++20", "-D_GLIBCXX_ASSERTIONS", "-ffp-contract=off", "-fopenmp", "-w",
         "-DSILT_SLOW_TESTS=1",
         "-fmax-errors=1"]
PRECOMPILED = "#include <Eigen/Core>\n#include <Eigen/Geometry>\n#include <gtest/gtest.h>\n"
MEMORY = 8 << 30  # of a test [bytes]
IDLE = 300  # a test that does nothing for so long hangs [s]


def copy_of(repository, folder):
    """A copy of what the tests need."""
    shutil.rmtree(folder, ignore_errors=True)
    for name in ("include", "tests", "examples"):
        shutil.copytree(repository / name, folder / name,
                        ignore=shutil.ignore_patterns("__pycache__", "mutation"))
    return Tree(folder)


class Tree:
    """A copy of the repository that is not changed while it is tested."""

    def __init__(self, root):
        self.root = pathlib.Path(root)
        self.include = self.root / "include"
        listed = re.search(r"set\(quick_folders ([^)]*)\)",
                           (self.root / "tests/CMakeLists.txt").read_text(encoding="utf-8"))
        self.quick_folders = set(listed.group(1).split())

    def headers(self, folders):
        """Names, below include/silt/, of the headers in these folders."""
        silt = self.include / "silt"
        return sorted(path.relative_to(silt).as_posix() for folder in folders
                      for path in (silt / folder).rglob("*.hpp"))

    def test_sources(self):
        """The sources of tests that do not run long, and without optional libraries."""
        found = []
        for folder in FOLDERS:
            for path in sorted((self.root / "tests" / folder).glob("*_test.cpp")):
                if not path.name.endswith("_slow_test.cpp") and path.name != "hypre_test.cpp":
                    found.append(path.relative_to(self.root).as_posix())
        return found + ([HASHES] if (self.root / HASHES).is_file() else [])

    @functools.lru_cache(maxsize=None)
    def includes_of(self, name):
        """The files of the repository that this file includes itself."""
        text = (self.root / name).read_text(encoding="utf-8")
        found = []
        for path in INCLUDE.findall(text):
            for folder in ("include", "tests", "examples"):
                if (self.root / folder / path).is_file():
                    found.append(f"{folder}/{path}")
                    break
        return tuple(found)

    @functools.lru_cache(maxsize=None)
    def all_includes_of(self, name):
        """The files of the repository that this file includes, also through others."""
        found, waiting = set(), [name]
        while waiting:
            for path in self.includes_of(waiting.pop()):
                if path not in found:
                    found.add(path)
                    waiting.append(path)
        return frozenset(found)

    @functools.lru_cache(maxsize=None)
    def depths_of(self, name):
        """How many include directives lead from this file to each of those that it includes."""
        depths, waiting = {name: 0}, [name]
        for file in waiting:
            for path in self.includes_of(file):
                if path not in depths:
                    depths[path] = depths[file] + 1
                    waiting.append(path)
        return depths

    def tests_of(self, header, kills, executed=lambda source: 0):
        """The sources that include a header: first the one with its name, then those that have
        killed most mutants of the header, then those that execute most of its lines, then the
        nearest: those that include it themselves, or have its words in their name; those in its
        folder that mention one of its names; the hashes of whole runs; those that mention a name,
        are in the folder, or neither. Among equals, those come first that include it most directly,
        then those that have killed most of its folder, then those with the fewest headers.
        kills(source) are the two numbers of mutants, executed(source) that of lines, 0 if it is
        unknown."""
        name = f"include/silt/{header}"
        folder, stem = header.split("/")[0], pathlib.Path(header).stem
        own = f"tests/{folder}/{stem}_test.cpp"
        declared = (declared_names((self.root / name).read_text(encoding="utf-8"))
                    - self.usual_words())

        def distance(source):
            if name in self.includes_of(source) or beginnings(stem) <= beginnings(
                    pathlib.Path(source).stem):
                return 1
            if source == HASHES:
                return 3
            mentions = not declared.isdisjoint(self.words_of(source))
            in_folder = source.startswith(f"tests/{folder}/")
            return 2 if mentions and in_folder else 4 if mentions else 5 if in_folder else 6

        def order(source):
            of_header, of_folder = kills(source)
            return (source != own, -of_header, -executed(source), distance(source),
                    self.depths_of(source)[name], -of_folder,
                    len(self.all_includes_of(source)), source)

        users = [source for source in self.test_sources()
                 if name in self.all_includes_of(source)]
        return sorted(users, key=order)

    @functools.lru_cache(maxsize=None)
    def words_of(self, source):
        """The words of a test and of the test support that it includes."""
        support = [path for path in self.includes_of(source) if path.startswith("tests/")]
        return frozenset(word for name in [source, *support] for word in
                         re.findall(r"\w+", (self.root / name).read_text(encoding="utf-8")))

    @functools.lru_cache(maxsize=None)
    def usual_words(self):
        """Those in more than a fifth of the tests."""
        count = collections.Counter(word for source in self.test_sources()
                                    for word in self.words_of(source))
        return frozenset(word for word in count if 5 * count[word] > len(self.test_sources()) > 9)

    def hash_of(self, source):
        """Changes whenever the program would."""
        total = hashlib.sha256()
        for name in [source, *sorted(self.all_includes_of(source))]:
            total.update(name.encode() + b"\0" + (self.root / name).read_bytes() + b"\0")
        return total.hexdigest()[:16]


def beginnings(stem):
    """The beginnings of the words of a file's name."""
    return {word[:5] for word in stem.split("_")}


def declared_names(text):
    """The types and functions that a header declares, except for those in detail."""
    text = text.split("\nnamespace detail {")[0]
    types = re.findall(r"^\s*(?:class|struct|concept|enum class|using) (\w+)", text, re.MULTILINE)
    functions = re.findall(r"^[\w:<>,&* ]+ \*?(\w+)\([^;]*$", text, re.MULTILINE)
    return {name for name in types + functions if len(name) > 3}


class Workshop:
    """Compiles and runs test programs of a tree in a folder of its own."""

    def __init__(self, tree, folder, compiler, runner, flags=(), precompile=True):
        self.tree, self.folder, self.runner = tree, pathlib.Path(folder), runner
        self.compiler, self.flags = shlex.split(compiler), list(flags)
        self.precompile = precompile
        self.include = tree.include
        self.folder.mkdir(parents=True, exist_ok=True)

    def put(self, header, text):
        """Replaces a header, in a copy, for the programs compiled from now on."""
        if self.include == self.tree.include:
            self.include = self.folder / "include"
            shutil.rmtree(self.include, ignore_errors=True)
            shutil.copytree(self.tree.include, self.include)
        (self.include / "silt" / header).write_text(text, encoding="utf-8")

    def take_away(self, header):
        if self.include != self.tree.include:
            shutil.copy(self.tree.include / "silt" / header, self.include / "silt" / header)

    def check_members(self, seconds):
        """Whether every member of a part with state is in checkpoints, as tests/run checks it."""
        return self.runner.run([sys.executable, self.tree.root / MEMBERS, self.include,
                                self.tree.root / "examples"], seconds, self.folder)

    def compile(self, source, seconds):
        """Compiles a test source to the program `program` of the folder. Throws if the compiler
        fails without naming an error, for example because something else ended it."""
        # Only the first run of a workshop has to precompile, which counts for no mutant.
        options = self._options(source)
        prefix = self._precompiled(options) if self.precompile and source != HASHES else []
        includes = self.tree.all_includes_of(source)
        if COUNTED in includes and COUNTING not in includes:
            options = [*options, "-include", self.tree.root / COUNTING]
        link = [] if source == HASHES else ["-lgtest", "-lgtest_main", "-lpthread"]
        ran = self.runner.run(
            [*self.compiler, *prefix, *options, self.tree.root / source, "-o",
             self.folder / "program", *link], seconds, self.folder)
        if ran.status == "failed" and (": error: " not in ran.output.replace("fatal ", "")
                                       or "Killed signal" in ran.output):
            raise RuntimeError(f"{source}: the compiler failed, exit {ran.code}\n{ran.output}")
        return ran

    def _options(self, source):
        # Tests that compute much are optimised, as by tests/CMakeLists.txt.
        quick = source.split("/")[1] in self.tree.quick_folders | {"portability"}
        root = self.tree.root
        return [*FLAGS, "-Og" if quick else "-O2", f"-I{self.include}", f"-I{root / 'tests'}",
                f"-I{root / 'examples'}", "-isystem", eigen_folder(),
                f'-DSILT_TESTS_DIR="{root / "tests"}"', *self.flags]

    def _precompiled(self, options):
        """Options that use Eigen and GoogleTest, precompiled with these options."""
        name = "precompiled_" + hashlib.sha256(" ".join(map(str, options)).encode()).hexdigest()[:8]
        header = self.folder / f"{name}.hpp"
        if not header.with_suffix(".hpp.gch").is_file():
            header.write_text(PRECOMPILED, encoding="utf-8")
            made = self.folder / f"{name}.gch"
            ran = self.runner.run([*self.compiler, *options, "-x", "c++-header", header, "-o",
                                   made], 600, self.folder)
            if ran.status != "passed":
                raise RuntimeError(f"Eigen and GoogleTest do not compile:\n{ran.output}")
            made.rename(header.with_suffix(".hpp.gch"))
        return ["-include", header]

    def run(self, source, seconds):
        """Runs the program that was compiled last, without its slow tests."""
        environment = {**os.environ, "OMP_NUM_THREADS": "1", "OMP_WAIT_POLICY": "passive",
                       "GTEST_FAIL_FAST": "1", "GTEST_FILTER": "-*Slow:*Slow/*",
                       "GTEST_COLOR": "no"}
        with tempfile.TemporaryDirectory(dir=self.folder) as folder:
            environment["TMPDIR"] = folder
            ran = self.runner.run([self.folder / "program"], seconds, folder, MEMORY, environment,
                                  IDLE)
        if source == HASHES and ran.status == "passed":
            expected = (self.tree.root / HASHES).with_suffix(".txt").read_text(encoding="utf-8")
            if ran.output.split() != expected.split():
                ran = Ran("failed", ran.seconds, "other hashes", 1)
        return ran


@functools.lru_cache(maxsize=None)
def eigen_folder():
    flags = subprocess.run(["pkg-config", "--cflags-only-I", "eigen3"], text=True,
                           capture_output=True, check=False).stdout.split()
    return flags[0].removeprefix("-I") if flags else "/usr/include/eigen3"
