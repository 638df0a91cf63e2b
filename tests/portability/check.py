#!/usr/bin/env python3
# SPDX-License-Identifier: MIT
"""Compiles the library with other compilers and for other processors.

    check.py headers VARIANT INCLUDE...         all headers, in one source file
    check.py warnings VARIANT INCLUDE...        the quickstarts, which must compile without warnings
    check.py hashes VARIANT INCLUDE...          hashes.cpp, which must print hashes.txt
    check.py arithmetic VARIANT INCLUDE...      few_steps.cpp: with fused operations it runs, at
                                                two levels of optimisation; one_particle.cpp:
                                                options that reorder sums or assume finite numbers
                                                are refused

The first INCLUDE is the include folder of the library, the others are those of Eigen. For VARIANT
see VARIANTS. If its compiler is missing, prints a message and exits with 77.
"""

import os
import pathlib
import re
import shutil
import subprocess
import sys
import tempfile

HERE = pathlib.Path(__file__).resolve().parent
SKIPPED = 77

# Typical compiler flags of a user, in addition to the include folders.
FLAGS = ["-std=c++20", "-O3", "-ffp-contract=off", "-Wall", "-Wextra", "-Wpedantic", "-Werror"]
# On processors with AVX10, clang 19 warns about -march=native, even for an empty file.
CLANG19 = ["clang++-19", "-Wno-invalid-feature-combination"]
WASM = ["clang++-19", "--target=wasm32-wasi", "-stdlib=libc++"]
LIBCXX = [*CLANG19, "-stdlib=libc++"]
# Compiler and -march, some for use by hand only; "" is the compiler's default, "widest" the last one in NEEDED that this
# processor supports.
VARIANTS = {
    "gcc": (["g++"], ""),
    "gcc_widest": (["g++"], "widest"),
    "gcc_v3": (["g++"], "x86-64-v3"),
    "gcc_v4": (["g++"], "x86-64-v4"),
    "gcc_native": (["g++"], "native"),
    "clang14_v3": (["clang++-14"], "x86-64-v3"),
    "clang14_v4": (["clang++-14"], "x86-64-v4"),
    "clang14_native": (["clang++-14"], "native"),
    "clang19_v4": (CLANG19, "x86-64-v4"),
    "clang19_native": (CLANG19, "native"),
    "clang19_libcxx": (LIBCXX, ""),
    "clang19_libcxx_native": (LIBCXX, "native"),
    "wasm32": (WASM, ""),
}

# Processor features required to run programs compiled with -march.
NEEDED = {
    "x86-64-v3": {"avx2", "bmi2", "fma"},
    "x86-64-v4": {"avx2", "bmi2", "fma", "avx512f", "avx512bw", "avx512cd", "avx512dq", "avx512vl"},
}
# Headers that need files, which wasm32 does not have, and headers of optional packages.
FOR_FILES = {"archive", "black_box", "checkpoint", "checkpoints", "csv", "csv_series", "file", "particle_csv",
             "replace_file", "stl", "vtk", "vtk_cells", "vtk_clumps", "vtk_contacts", "vtk_walls"}
OPTIONAL = re.compile("mpi.*|solve/hypre.*")


def skip(message):
    print(message)
    sys.exit(SKIPPED)


def run(command):
    """Runs a command, and ends the test if it fails."""
    print(" ".join(map(str, command)), flush=True)
    if subprocess.run(command, check=False).returncode != 0:
        sys.exit(1)


def narrower_sets(processor, command):
    """The instruction sets of a program for any x86-64 that this processor has, but the widest."""
    if processor or command[: len(WASM)] == WASM or os.uname().machine != "x86_64":
        return []
    has = ["sse2"] + ["avx2"] * runs_here("x86-64-v3") + ["avx512"] * runs_here("x86-64-v4")
    return has[:-1]


def runs_here(processor):
    if processor not in NEEDED:
        return True
    info = pathlib.Path("/proc/cpuinfo")
    features = set(info.read_text(encoding="utf-8").split()) if info.exists() else set()
    return NEEDED[processor] <= features


def compiler_of(variant, includes, eigen="-I"):
    """The command with the include folders; `eigen` is the option for those of Eigen."""
    command, processor = VARIANTS[variant]
    if processor == "widest":
        processor = ([""] + [name for name in NEEDED if runs_here(name)])[-1]
    if not shutil.which(command[0]):
        skip(f"{command[0]} is not installed")
    command = [*command, *([f"-march={processor}"] if processor else [])]
    command += [f"-I{includes[0]}"] + [f"{eigen}{folder}" for folder in includes[1:]]
    accepted = subprocess.run(
        [*command, "-std=c++20", "-fsyntax-only", "-x", "c++", "-"],
        input="#include <vector>\n", text=True, capture_output=True, check=False)
    if accepted.returncode != 0:
        skip(f"{' '.join(VARIANTS[variant][0])} has no standard library on this machine, or does not support "
             f"-march={processor}")
    return command, processor


def openmp_of(command, scratch):
    """The flag for OpenMP, which README's command has, if the compiler has its library."""
    made = subprocess.run(
        [*command, "-fopenmp", "-x", "c++", "-", "-o", scratch / "openmp"],
        input="#include <omp.h>\nint main() { return omp_get_max_threads() < 1; }\n",
        text=True, capture_output=True, check=False)
    if made.returncode != 0:
        print(f"{command[0]} has no OpenMP on this machine")
        return []
    return ["-fopenmp"]


def check_headers(variant, includes, _):
    command, _ = compiler_of(variant, includes, eigen="-isystem")
    folder = pathlib.Path(includes[0], "silt")
    headers = {path.relative_to(folder).as_posix() for path in folder.rglob("*.hpp")}
    headers = {header for header in headers if not OPTIONAL.fullmatch(header)}
    if command[: len(WASM)] == WASM:
        headers -= {f"io/{name}.hpp" for name in FOR_FILES}
        command += ["-fwasm-exceptions"]
    assert len(headers) > 100, headers
    source = "".join(f"#include <silt/{name}>\n" for name in sorted(headers))
    command += ["-std=c++20", "-fsyntax-only", "-Wall", "-Wextra", "-Wpedantic", "-Werror"]
    print(" ".join(command), f"on {len(headers)} headers", flush=True)
    return subprocess.run([*command, "-x", "c++", "-"], input=source, text=True,
                          check=False).returncode == 0


def check_warnings(variant, includes, scratch):
    command, _ = compiler_of(variant, includes)
    command += openmp_of(command, scratch)
    # clang warns before it optimises, except about registers that calls pass; hashes.cpp, which is
    # compiled with the same flags, has such calls, too.
    is_clang = command[0].startswith("clang")
    output = ["-fsyntax-only"] if is_clang else ["-c", "-o", scratch / "quickstart.o"]
    for quickstart in sorted((HERE.parents[1] / "examples").glob("quickstart_*.cpp")):
        run([*command, *FLAGS, quickstart, *output])
    return True


def check_hashes(variant, includes, scratch):
    command, processor = compiler_of(variant, includes)
    program = scratch / "hashes"
    start = [program]
    if command[: len(WASM)] == WASM:
        # Debian's libc++abi has no exceptions for wasm32; hashes.cpp throws none.
        command += ["-fignore-exceptions", "-Wl,-z,stack-size=1048576"]
        if not shutil.which("node"):
            skip("node, which runs WebAssembly, is not installed")
        start = ["node", "--no-warnings", "--experimental-wasi-unstable-preview1",
                 HERE / "run_wasm.mjs", program]
    else:
        command += openmp_of(command, scratch)
    run([*command, *FLAGS, HERE / "hashes.cpp", "-o", program])
    if not runs_here(processor):
        skip(f"compiled, but not run: this processor does not support {processor}")
    expected = (HERE / "hashes.txt").read_text(encoding="utf-8")
    left_out = "dam_in_space " if command[: len(WASM)] == WASM else "dam_in_space_without"
    expected = "".join(line for line in expected.splitlines(True) if not line.startswith(left_out))
    same = True
    runs = [{"OMP_NUM_THREADS": threads} for threads in ("1", "2")] if "-fopenmp" in command else [{}]
    # The widest instruction set of this processor has run; those below it, in the same program.
    runs += [{"SILT_ISA": name} for name in narrower_sets(processor, command)]
    for environment in runs:
        found = subprocess.run(start, capture_output=True, text=True, check=True,
                               env={**os.environ, **environment}).stdout
        print(f"{environment}:\n{found}", end="")
        same = same and found == expected
    if not same:
        print(f"but hashes.txt has\n{expected}", end="")
    return same


REFUSED = (["-ffast-math"], ["-funsafe-math-optimizations"],
           ["-fassociative-math", "-fno-signed-zeros", "-fno-trapping-math"])
LARGEST_DIFFERENCE = 1e-9  # of energies, relative, by fused operations


def check_arithmetic(variant, includes, scratch):
    command, processor = compiler_of(variant, includes)
    command += openmp_of(command, scratch)
    program = scratch / "program"

    def results(name, *flags):
        """Exit codes and outputs of the program on one and two threads, or of the compiler if it
        was not compiled."""
        command_line = [*command, "-std=c++20", *flags, HERE / name, "-o", program]
        print(" ".join(map(str, command_line)), flush=True)
        ran = [subprocess.run(command_line, capture_output=True, text=True, check=False)]
        if ran[0].returncode == 0:
            ran = [subprocess.run([program], capture_output=True, text=True, check=False,
                                  env={**os.environ, "OMP_NUM_THREADS": threads})
                   for threads in ("1", "2")]
            print(ran[0].stdout, end="", flush=True)
        return [(one.returncode, one.stdout + one.stderr) for one in ran]

    if not runs_here(processor):
        skip(f"this processor does not support {processor}")
    for level in ("-O1", "-O3"):
        for flags in REFUSED:
            # After a refusal, the compiler need not read the rest.
            for code, text in results("one_particle.cpp", level, "-Wfatal-errors", *flags):
                assert code != 0 and ("silt: compiled with -ffast-math" in text or
                                      "Simulation: compiled with -funsafe-math" in text), text
        # What is added for AVX-512 never fuses.
        exact, other_exact = results("few_steps.cpp", level, "-DSILT_NO_DISPATCH", "-ffp-contract=off")
        fused, other_fused = results("few_steps.cpp", level, "-DSILT_NO_DISPATCH", "-ffp-contract=fast")
        assert exact[0] == fused[0] == 0, (exact, fused)
        assert (exact, fused) == (other_exact, other_fused), "other bits on two threads"
        energies = [text.split()[:2] for _, text in (exact, fused)]
        for one, other in zip(*energies, strict=True):
            assert abs(float(one) / float(other) - 1) < LARGEST_DIFFERENCE, (exact, fused)
        hashes = [text.split()[2:] for _, text in (exact, fused)]
        for one, other in zip(*hashes, strict=True):  # -O1 of g++ fuses nothing
            assert one != other or level == "-O1", f"nothing was fused: {exact}"
    return True


def main(arguments):
    checks = {"headers": check_headers, "warnings": check_warnings, "hashes": check_hashes,
              "arithmetic": check_arithmetic}
    if len(arguments) < 3 or arguments[0] not in checks or arguments[1] not in VARIANTS:
        sys.exit(__doc__)
    with tempfile.TemporaryDirectory() as scratch:
        if not checks[arguments[0]](arguments[1], arguments[2:], pathlib.Path(scratch)):
            sys.exit(1)


if __name__ == "__main__":
    main(sys.argv[1:])
