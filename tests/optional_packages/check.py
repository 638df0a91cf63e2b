#!/usr/bin/env python3
# SPDX-License-Identifier: MIT
"""Checks that no package ends a configuration that could do without it.

    check.py sources REPOSITORY
        Reads all CMake files: every look-up is one of silt_find, for a package that silt_package describes.
        Prints each fault and exits with 1.
    check.py states REPOSITORY SCRATCH COMPILER [--all]
        Configures with packages that are half there. Which there are, what they define and which of them
        must be there is read from the CMake files. Without --all: all optional packages at once in the
        state that real ones are found in, and a program that asks for several processes. With --all: every
        state of STATES, the packages that must be there, and packages that are repaired.
    check.py --self-test
        Checks that one example of every kind of fault is found.
"""

import pathlib
import re
import shutil
import subprocess
import sys
import tempfile

STATES = {
    "absent": "it is not there",
    "broken": "its CMake file raises an error",
    "no_folder": "the folder of its headers does not exist",
    "no_header": "its header is missing",
    "no_library": "its library is missing",
    "old": "its version is too old, or its header has not what Silt uses",
}
# A target that is missing without the package.
NEEDED_BY = {"GTest": "test_core", "benchmark": "bench_dem_step", "CLI11": "dam_break",
             "nlohmann_json": "dam_break", "Boost": "units", "MPI": "mpi_quickstart_tower",
             "Zoltan": "mpi_quickstart_tower", "HYPRE": "test_solve_hypre"}

# Other look-ups than those of silt_find. All of them search for a file only, and cannot fail, except the
# first one, of a package that works.
LISTED = {(".cmake/silt_find.cmake", "find_package"),
          (".cmake/FindHYPRE.cmake", "find_path"), (".cmake/FindHYPRE.cmake", "find_library"),
          (".cmake/FindZoltan.cmake", "find_path"), (".cmake/FindZoltan.cmake", "find_library"),
          ("tests/CMakeLists.txt", "find_program"), ("tests/fuzz/fuzz.cmake", "find_program")}
USERS_PROJECT = "tests/install/consumer/"

LOOK_UP = re.compile(r"find_(?!package_handle)\w+|pkg_\w+|fetchcontent_\w+|externalproject_\w+|load_cache", re.I)
MODULE = re.compile(r"Find(?!PackageHandle)\w+|FetchContent|ExternalProject|CMakeFindDependencyMacro")
COMMAND = re.compile(r"^[ \t]*(\w+)[ \t]*\(", re.M)
ARGUMENT = re.compile(r'"((?:[^"\\]|\\.)*)"|([^\s"()]+)|\)', re.S)


# --- the CMake files -----------------------------------------------------------------------------


def cmake_files(repository):
    """Yields (name, text)."""
    for entry in sorted(repository.iterdir()):
        if entry.name in ("build", "out", ".git"):
            continue
        for path in sorted(entry.rglob("*")) if entry.is_dir() else [entry]:
            if path.name == "CMakeLists.txt" or path.suffix == ".cmake":
                yield path.relative_to(repository).as_posix(), path.read_text(encoding="utf-8")


def commands(text):
    """Yields (line, name, arguments) of every command, also of those in files that are configured."""
    text = re.sub(r"^[ \t]*#.*", "", text, flags=re.M)
    for match in COMMAND.finditer(text):
        arguments = []
        for argument in ARGUMENT.finditer(text, match.end()):
            if argument[0] == ")":
                break
            arguments.append(argument[1] if argument[2] is None else argument[2])
        yield text.count("\n", 0, match.start()) + 1, match[1].lower(), arguments


def packages_of(repository):
    """What silt_package says of each package, by name; the packages that silt_find looks for, each with
    whether it must be there."""
    described, wanted = {}, {}
    for name, text in cmake_files(repository):
        for _, command, arguments in commands(text):
            if command == "silt_package":
                part = []
                parts = described[arguments[0]] = {}
                for argument in arguments[1:]:
                    if argument in ("FIND", "TARGETS", "HEADER", "USES", "NEEDS", "WITHOUT"):
                        part = parts[argument] = []
                    else:
                        part.append(argument)
            elif command == "silt_find":
                for package in arguments:
                    if package not in ("QUIET", "REQUIRED"):
                        wanted[package] = "REQUIRED" in arguments or wanted.get(package, False)
    return described, wanted


def faults(repository):
    """Yields a message for each fault."""
    listed = {entry for entry in LISTED if (repository / entry[0]).exists()}
    unused = set(listed)
    for name, text in cmake_files(repository):
        if name.startswith(USERS_PROJECT):
            continue
        for line, command, arguments in commands(text):
            what = f"{name}:{line}: {command}({' '.join(arguments[:2])}…)"
            if command == "include" and MODULE.fullmatch(arguments[0]):
                yield f"{what}: packages are looked for by silt_find"
            elif LOOK_UP.fullmatch(command):
                unused.discard((name, command))
                if (name, command) not in listed:
                    yield f"{what}: packages are looked for by silt_find; what is none is in LISTED of check.py"
                elif "REQUIRED" in arguments:
                    yield f"{what}: ends the configuration without a message of Silt"
    yield from (f"{name}: has no {command}; it is in LISTED of check.py" for name, command in sorted(unused))
    described, wanted = packages_of(repository)
    for name in sorted(set(wanted) ^ set(described)):
        yield f"{name}: " + ("no silt_package describes it" if name in wanted else "no silt_find looks for it")
    for name, parts in described.items():
        if not parts.get("TARGETS") or not parts.get("WITHOUT"):
            yield f"{name}: silt_package must name its TARGETS, and what is lost WITHOUT it"


# --- states --------------------------------------------------------------------------------------


class Packages:
    """The packages of a repository, and how they are made half there."""

    def __init__(self, repository, scratch):
        self.repository, self.scratch = repository, scratch
        self.described, wanted = packages_of(repository)
        self.optional = [name for name, must in wanted.items() if not must]
        self.required = [name for name, must in wanted.items() if must]

    def module(self, name):
        """Silt's own module that finds the package, or None."""
        path = self.repository / ".cmake" / f"Find{name}.cmake"
        return path.read_text(encoding="utf-8") if path.exists() else None

    def has_version(self, name):
        return any(re.fullmatch(r"[\d.]+", argument) for argument in self.described[name].get("FIND", []))

    def may_be(self, name, state):
        """Whether the package can be in this state, in a way that is noticed when configuring."""
        if state == "absent":
            return True
        if state == "broken":
            return self.module(name) is None
        if state == "old":
            return self.has_version(name) or "USES" in self.described[name]
        return "HEADER" in self.described[name]

    def options(self, states):
        """CMake's options that put packages in the states, {name: state}."""
        folder = pathlib.Path(tempfile.mkdtemp(dir=self.scratch))
        options = [f"-DCMAKE_MODULE_PATH={folder}"]
        for name, state in states.items():
            if state == "absent":
                options.append(f"-DCMAKE_DISABLE_FIND_PACKAGE_{name}=ON")
            elif self.module(name):
                header = folder / name / re.search(r"find_path\(\w+ (\S+)", self.module(name))[1]
                if state != "no_folder":
                    header.parent.mkdir()
                if state == "old":
                    header.write_text("")
                kind = "library" if state == "no_library" else "path"
                variable = re.search(rf"find_{kind}\((\w+)", self.module(name))[1]
                options.append(f"-D{variable}={header.parent}")
            elif {"CONFIG", "NO_MODULE"} & set(self.described[name].get("FIND", [])):
                (folder / f"{name}Config.cmake").write_text(self.cmake_file(name, state, folder))
                (folder / f"{name}ConfigVersion.cmake").write_text(
                    f"set(PACKAGE_VERSION {0.1 if state == 'old' else 99})\n"
                    f"set(PACKAGE_VERSION_COMPATIBLE {'FALSE' if state == 'old' else 'TRUE'})\n")
                options.append(f"-D{name}_DIR={folder}")
            else:
                (folder / f"Find{name}.cmake").write_text(self.cmake_file(name, state, folder))
        return options

    def cmake_file(self, name, state, folder):
        """A CMake file of the package in this state."""
        if state == "broken":
            return 'message(FATAL_ERROR "a file of this package is missing")\n'
        if state == "old" and self.has_version(name):
            return f"set({name}_FOUND FALSE)\n"
        headers = folder / f"{name}_headers"
        if state == "old":  # before the real one
            header = headers / self.described[name]["HEADER"][0]
            header.parent.mkdir(parents=True)
            header.write_text("")
        flaw = {"no_folder": f"target_include_directories(TARGET INTERFACE {headers})",
                "no_header": "target_compile_options(TARGET INTERFACE -nostdinc -nostdinc++)",
                "no_library": "target_link_libraries(TARGET INTERFACE silt_has_no_such_library)",
                "old": f"target_include_directories(TARGET INTERFACE {headers})"}[state]
        text = f"set({name}_FOUND TRUE)\n"
        for target in self.described[name]["TARGETS"]:
            text += f"add_library({target} INTERFACE IMPORTED)\n{flaw.replace('TARGET', target)}\n"
        return text


class Runs:
    """Configurations, and what they must print."""

    def __init__(self, repository, scratch, compiler):
        shutil.rmtree(scratch, ignore_errors=True)
        scratch.mkdir(parents=True)
        self.repository, self.scratch, self.compiler = repository, scratch, compiler
        self.packages = Packages(repository, scratch)

    def configure(self, build, options, source=None):
        """Exit code and output."""
        print("==", build.name, *options, flush=True)
        done = subprocess.run(["cmake", "-S", source or self.repository, "-B", build, "-DCMAKE_BUILD_TYPE=Debug",
                               f"-DCMAKE_CXX_COMPILER={self.compiler}", *options],
                              stdout=subprocess.PIPE, stderr=subprocess.STDOUT, text=True, check=False)
        (self.scratch / f"{build.name}.txt").write_text(done.stdout)
        return done.returncode, done.stdout

    @staticmethod
    def expect(condition, message, output):
        if not condition:
            sys.exit(f"{output}\nFAILED: {message}")

    def with_optional(self, name, states, folders=("TESTS", "EXAMPLES", "BENCH")):
        """These folders with optional packages in these states: a line for each, and all targets that can do
        without them."""
        build, options = self.scratch / name, self.packages.options(states)
        code, output = self.configure(build, [*(f"-DSILT_BUILD_{folder}=ON" for folder in folders), *options])
        self.expect(code == 0 and "CMake Error" not in output, "the configuration ended", output)
        self.expect("CMake Warning" not in output, "there are warnings", output)
        said = re.findall(r"^-- Silt: (\w+)[ 0-9.]* (?:was not found|does not work, see \S+)\. \w", output, re.M)
        targets = subprocess.run(["cmake", "--build", build, "--target", "help"], capture_output=True, text=True,
                                 check=True).stdout
        for package in self.packages.optional:
            lines = {1} if package in states else {0, 1}  # others may really be missing
            if set(said) & set(self.packages.described[package].get("NEEDS", [])):
                lines = {0}
            self.expect(said.count(package) in lines, f"{package} is named {said.count(package)} times", output)
            if package in states and package in NEEDED_BY:
                self.expect(not re.search(rf"\b{NEEDED_BY[package]}\b", targets),
                            f"{NEEDED_BY[package]} is a target without {package}", targets)
        self.expect(re.search(r"\bquickstart_tower\b", targets), "quickstart_tower is no target", targets)
        return build, options

    def program(self, silt, package, state):
        """A program that asks for several processes, with the package silt in that build folder."""
        project = self.scratch / "user"
        project.mkdir(exist_ok=True)
        (project / "CMakeLists.txt").write_text(
            "cmake_minimum_required(VERSION 3.24)\nproject(user LANGUAGES CXX)\n"
            "find_package(silt CONFIG ${ASKED} mpi)\n"
            'message(STATUS "silt: ${silt_FOUND}, mpi: ${silt_mpi_FOUND}")\n')
        found, debian = "silt: 0", ["libeigen3-dev"]
        if package != "Eigen3":
            found, debian = "silt: 1, mpi: FALSE", ["libopenmpi-dev", "libtrilinos-zoltan-dev", "libhypre-dev"]
        options = [f"-Dsilt_DIR={silt}", *self.packages.options({package: state})]
        for asked, wanted in (("OPTIONAL_COMPONENTS", 0), ("REQUIRED;COMPONENTS", 1)):
            code, output = self.configure(self.scratch / f"user_{package}_{state}_{wanted}",
                                          [f"-DASKED={asked}", *options], project)
            self.expect(code == wanted, f"exit code {code}", output)
            text = " ".join(output.split())
            self.expect(re.search(rf"{package}[ 0-9.]* (was not found|does not work, see \S+)\. ", text),
                        f"{package} is not named", output)
            if wanted == 0:
                self.expect(found in text, f"not '{found}'", output)
            else:
                self.expect(all(name in text for name in debian), f"not all of {debian} are named", output)

    def without_required(self, package, state):
        """Ends with Silt's message, and with no other error."""
        build = self.scratch / f"{package}_{state}"
        options = ["-DSILT_BUILD_PYTHON=ON", *self.packages.options({package: state})]
        hidden = []
        code, output = self.configure(build, options)
        while state == "old" and code == 0:  # CMake goes on searching, until the real ones are hidden
            real = re.search(rf"^{package}_DIR:PATH=(.*)", (build / "CMakeCache.txt").read_text(), re.M)[1]
            hidden.append(real)
            shutil.rmtree(build)
            code, output = self.configure(build, [*options, f"-DCMAKE_IGNORE_PATH={';'.join(hidden)}"])
        self.expect(code != 0, "the configuration did not end", output)
        errors = re.findall(r"^CMake Error.*\n +(.*)", output, re.M)
        # Without NumPy the message is that about Python.
        self.expect(len(errors) == 1 and re.match(rf"Silt: ({package}\b|the Python package needs)", errors[0]),
                    f"not Silt's message alone: {errors}", output)

    def everything(self):
        names = self.packages.optional
        for state in STATES:
            # Of what needs MPI nothing is said without it.
            states = {name: state for name in names if name != "MPI" and self.packages.may_be(name, state)}
            build, options = self.with_optional(state, states)
            if state == "broken":  # repaired, and broken again
                code, output = self.configure(build, ["-U" + option[2:].split("=")[0] for option in options])
                self.expect(code == 0 and "does not work" not in output, "a package was not found again", output)
                self.with_optional(state, states)
            self.with_optional(f"{state}_MPI", {"MPI": state}, ("EXAMPLES",))
            self.program(build, "MPI", state)
        # Flags with which no program can be linked are no fault of Eigen.
        code, output = self.configure(self.scratch / "flags", [
            "-DCMAKE_BUILD_TYPE=Release", "-DCMAKE_EXE_LINKER_FLAGS_RELEASE=-lsilt_has_no_such_library"])
        self.expect(code == 0 and "Eigen" not in output, "the flags are taken for a fault of a package", output)
        # An example that is asked for by name.
        code, output = self.configure(self.scratch / "dam_break", [
            "-DSILT_BUILD_EXAMPLES=ON", "-DSILT_EXAMPLES=dam_break", *self.packages.options({"CLI11": "broken"})])
        self.expect(code != 0 and re.findall(r"^CMake Error.*\n +(.*)", output, re.M)
                    == ["Silt: the example dam_break needs CLI11"], "it is not said what it needs", output)
        self.program(build, "Eigen3", "broken")
        for package in self.packages.required:
            for state in STATES:
                if self.packages.may_be(package, state):
                    self.without_required(package, state)


def self_test():
    with tempfile.TemporaryDirectory() as name:
        folder = pathlib.Path(name)
        (folder / "python").mkdir()
        (folder / "CMakeLists.txt").write_text('''
# find_package(Commented)
silt_package(Good FIND 1.2 COMPONENTS CXX TARGETS Good::Good HEADER good.h USES "good(1)"
  WITHOUT "Something needs it (Debian: good)")
silt_package(Idle TARGETS Idle::Idle WITHOUT "Nothing")
silt_package(Silent TARGETS Silent::Silent)
silt_find(Good Silent)
if(ON)
  find_package(Bad REQUIRED)
endif()
file(CONFIGURE OUTPUT x CONTENT [[
find_dependency(Bad)
]])
include(FindMPI)
silt_find(Unknown
  REQUIRED)
''')
        (folder / "python/more.cmake").write_text("pkg_check_modules(BAD bad)\nfind_library(BAD bad)\n")
        found = sorted(faults(folder))
        expected = ["CMakeLists.txt:12: find_dependency(Bad", "CMakeLists.txt:14: include(FindMPI",
                    "CMakeLists.txt:9: find_package(Bad", "Idle: no silt_find", "Silent: silt_package must",
                    "Unknown: no silt_package", "python/more.cmake:1: pkg_check_modules(BAD",
                    "python/more.cmake:2: find_library(BAD"]
        assert len(found) == len(expected), found
        for fault, start in zip(found, expected):
            assert fault.startswith(start), (fault, start)
        described, wanted = packages_of(folder)
        assert described["Good"] == {
            "FIND": ["1.2", "COMPONENTS", "CXX"], "TARGETS": ["Good::Good"], "HEADER": ["good.h"],
            "USES": ["good(1)"], "WITHOUT": ["Something needs it (Debian: good)"]}, described
        assert wanted == {"Good": False, "Silent": False, "Unknown": True}, wanted


def main():
    arguments = sys.argv[1:]
    if arguments == ["--self-test"]:
        self_test()
    elif arguments[:1] == ["sources"] and len(arguments) == 2:
        found = list(faults(pathlib.Path(arguments[1]).resolve()))
        print("\n".join(found))
        sys.exit(1 if found else 0)
    elif arguments[:1] == ["states"] and len(arguments) - ("--all" in arguments) == 4:
        repository, scratch = (pathlib.Path(argument).resolve() for argument in arguments[1:3])
        runs = Runs(repository, scratch, arguments[3])
        if "--all" in arguments:
            runs.everything()
        else:
            # As Debian's openmpi-bin alone is, and as the others are after an installation that did not end.
            states = {name: "broken" for name in runs.packages.optional if runs.packages.may_be(name, "broken")}
            build, _ = runs.with_optional("half_there", {**states, "MPI": "no_folder"})
            runs.program(build, "MPI", "no_folder")
    else:
        sys.exit(__doc__)


if __name__ == "__main__":
    main()
