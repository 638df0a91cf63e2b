#!/usr/bin/env python3
# SPDX-License-Identifier: MIT
"""Checks the single header that .cmake/amalgamate.py writes, and compiles the quickstarts with it instead
of the folder include/.

    check.py REPOSITORY SCRATCH EIGEN COMPILER...  only compiles them
    check.py --run RESULTS REPOSITORY SCRATCH EIGEN COMPILER...
                                                   runs them: the files that they write must be those in
                                                   RESULTS/NAME, bit for bit

EIGEN is its include folder.
"""

import importlib.util
import pathlib
import re
import shutil
import subprocess
import sys
import tempfile

FLAGS = ["-std=c++20", "-ffp-contract=off", "-Wall", "-Wextra", "-Wpedantic", "-Wconversion", "-Wshadow", "-Werror"]
QUICKSTARTS = ("quickstart_tower", "quickstart_dam")
# All that a program gets to see.
MACROS = {"SILT_VERSION", "SILT_VERSION_MAJOR", "SILT_VERSION_MINOR", "SILT_VERSION_PATCH",
          "SILT_ISA_OF_FLAGS", "SILT_LEVEL_OF_FLAGS", "SILT_ADDS_AVX2", "SILT_ADDS_AVX512", "SILT_FOR_PROCESSOR",
          "SILT_FOR_PROCESSOR_UP_TO_AVX2", "SILT_INDEPENDENT_ITERATIONS", "SILT_UNROLLED", "SILT_VECTORISES",
          "SILT_HAS_POSIX_FILES"}
INCLUDE_OF_SILT = re.compile(r"^#include <silt/.*>\n", re.M)


def load(repository):
    spec = importlib.util.spec_from_file_location("amalgamate", repository / ".cmake/amalgamate.py")
    module = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(module)
    return module


def run(command, **options):
    print(" ".join(map(str, command)), flush=True)
    return subprocess.run(command, check=True, **options)


def headers_in(text):
    return re.findall(r"^// --- (silt/.*)$", text, re.M)


def check_text(script, repository, header):
    """Every header once, none by #include; parts of the library; what is refused."""
    text = header.read_text(encoding="utf-8")
    expected = script.default_headers(repository / "include")[1:]
    assert len(expected) > 200 and "silt/silt.hpp" in expected
    difference = set(headers_in(text)) ^ set(expected)
    assert not difference and len(headers_in(text)) == len(expected), difference
    version = script.version_of(repository / "include")
    assert re.fullmatch(r"\d+\.\d+\.\d+", version)
    assert text.startswith(f"// SPDX-License-Identifier: MIT\n// Silt {version} ")
    assert (repository / "LICENSE").read_text(encoding="utf-8").split("\n")[2] in text  # the copyright
    assert not INCLUDE_OF_SILT.search(text)
    assert text.count("#pragma once") == 1
    includes = re.findall(r"^#include <(.*)>$", text, re.M)
    assert includes.count("vector") == 1 and includes.count("Eigen/Core") == 1

    macros = set(re.findall(r"^#\s*define (\w+)", text, re.M)) - set(re.findall(r"^#\s*undef (\w+)", text, re.M))
    assert macros == MACROS, macros ^ MACROS

    part = headers_in(script.amalgamate(repository, ["silt/core/error.hpp"]))
    assert part == ["silt/core/eigen.hpp", "silt/core/vectors.hpp", "silt/core/types.hpp",
                    "silt/core/error.hpp"], part
    whole = headers_in(script.amalgamate(repository, ["silt/silt.hpp", "silt/mpi.hpp"]))
    assert "silt/mpi/world.hpp" in whole and len(whole) == len(set(whole))


def check_refusals(script):
    guard = "#pragma once\n"
    faults = {
        "macros of the library begin with SILT_": {"a": "#define LIMIT 3\n"},
        "there is no header silt/b.hpp": {"a": "#include <silt/b.hpp>\n"},
        "ends within a condition": {"a": "#if 1\n"},
        "silt/b.hpp is included under a condition": {
            "a": "#ifdef _OPENMP\n#include <silt/b.hpp>\n#endif\n#include <silt/b.hpp>\n", "b": "int b;\n"},
    }
    for message, headers in faults.items():
        with tempfile.TemporaryDirectory() as name:
            folder = pathlib.Path(name, "include/silt")
            folder.mkdir(parents=True)
            for header, text in headers.items():
                (folder / f"{header}.hpp").write_text(guard + text, encoding="utf-8")
            try:
                script.amalgamate(pathlib.Path(name), ["silt/a.hpp"])
            except script.Refused as refusal:
                assert message in str(refusal), refusal
            else:
                raise AssertionError(f"not refused: {message}")


def with_single_header(repository, name):
    text = (repository / "examples" / f"{name}.cpp").read_text(encoding="utf-8")
    text, count = INCLUDE_OF_SILT.subn("", text)
    assert count >= 1
    return '#include "silt.hpp"\n' + text


def compile_quickstarts(repository, scratch, compile_command):
    """Both in one file, which takes less time, and includes the header twice."""
    both = scratch / "both.cpp"
    both.write_text("".join(with_single_header(repository, name).replace("int main()", f"int {name}()")
                            for name in QUICKSTARTS), encoding="utf-8")
    run([*compile_command, "-fsyntax-only", both])


def run_quickstart(repository, scratch, compile_command, name, expected):
    """Compares the files that it writes with those in the folder `expected`."""
    source, other, program = scratch / f"{name}.cpp", scratch / "other.cpp", scratch / name
    source.write_text(with_single_header(repository, name), encoding="utf-8")
    other.write_text('#include "silt.hpp"\n', encoding="utf-8")  # in two files of one program
    run([*compile_command, "-O2", source, other, "-o", program])
    folder = scratch / f"{name}.out"
    shutil.rmtree(folder, ignore_errors=True)
    folder.mkdir()
    run([program], cwd=folder, stderr=subprocess.DEVNULL)

    def files_in(root):
        return {path.relative_to(root).as_posix(): path.read_bytes() for path in root.rglob("*") if path.is_file()}

    ours, theirs = files_in(folder), files_in(expected)
    assert len(ours) > 50 and ours.keys() == theirs.keys(), ours.keys() ^ theirs.keys()
    different = [file for file in ours if ours[file] != theirs[file]]
    assert not different, f"{name}: with the single header, {different} differ"
    print(f"{name}: {len(ours)} files are the same")


def main(arguments):
    results = None
    if arguments[:1] == ["--run"]:
        results = pathlib.Path(arguments[1]).resolve()
        arguments = arguments[2:]
    if len(arguments) < 4:
        sys.exit(__doc__)
    repository, scratch, eigen = (pathlib.Path(argument).resolve() for argument in arguments[:3])
    scratch.mkdir(parents=True, exist_ok=True)
    header = scratch / "silt.hpp"
    run([sys.executable, repository / ".cmake/amalgamate.py", header])

    compile_command = [*arguments[3:], *FLAGS, "-isystem", eigen]
    script = load(repository)
    check_text(script, repository, header)
    check_refusals(script)
    if not results:
        compile_quickstarts(repository, scratch, compile_command)
        return
    for name in QUICKSTARTS:
        run_quickstart(repository, scratch, compile_command, name, results / name)


if __name__ == "__main__":
    main(sys.argv[1:])
