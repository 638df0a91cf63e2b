#!/usr/bin/env python3
# SPDX-License-Identifier: MIT
"""Gives wrong values to every option of an example, which must then end with code 2 and one
sentence that names the option.

    options.py [--extreme] SCRATCH PROGRAM

With --extreme, also gives 0 and very small and large numbers. The program may then run; if it ends
soon, it must have succeeded or rejected the value.
"""

import pathlib
import re
import shutil
import subprocess
import sys

NEVER_NUMBERS = ["nan", "-nan", "inf", "-inf", "1e400", "", "one", "1 2", "0x"]
EXTREME = ["0", "1e-310", "1e300", "-1e300", "1e18"]
# Options for which -1 is a valid value.
WITH_SIGN = {"--offset", "--case"}
PATIENCE = 0.5  # [s]


def options_of(program):
    """Pairs of the name of an option and the type of its values."""
    text = subprocess.run([program, "--help"], capture_output=True, text=True, check=True).stdout
    found = re.findall(r"^ +(?:-\w,)?(--[\w-]+) ([A-Z]+)", text, re.MULTILINE)
    assert len(found) > 3, text
    return found


def fault_of(end, name):
    """What is wrong with the end of a program that rejects an option; None if nothing is."""
    lines = end.stderr.splitlines()
    if end.returncode != 2:
        return f"ends with code {end.returncode}"
    if len(lines) != 1:
        return f"prints {len(lines)} lines"
    if name not in lines[0]:
        return "does not name the option"
    if lines[0].endswith(".") or len(lines[0]) >= 400:
        return "prints something else than one sentence"
    return None


def check_rejected(program, folder, name, value, faults):
    arguments = [f"{name}={value}"] + ([] if name == "--out" else ["--out", str(folder / "out")])
    try:
        end = subprocess.run([program, *arguments], capture_output=True, text=True, cwd=folder,
                             timeout=60)
    except subprocess.TimeoutExpired:
        faults.append(f"{name}={value}: runs")
        return
    fault = fault_of(end, name)
    if fault:
        faults.append(f"{name}={value}: {fault}: {end.stderr.strip()}")


def check_extreme(program, folder, name, value, faults):
    command = [program, f"{name}={value}", "--out", str(folder / "out")]
    try:
        end = subprocess.run(command, capture_output=True, text=True, cwd=folder, timeout=PATIENCE)
    except subprocess.TimeoutExpired:
        return
    # The name of another option may be given, if both do not fit together.
    fault = fault_of(end, "") if end.returncode != 0 else None
    if fault:
        faults.append(f"{name}={value}: {fault}: {end.stderr.strip()}")


def main(arguments):
    extreme = arguments[:1] == ["--extreme"]
    if len(arguments) != 2 + extreme:
        sys.exit(__doc__)
    folder = pathlib.Path(arguments[-2])
    program = str(pathlib.Path(arguments[-1]).resolve())
    shutil.rmtree(folder, ignore_errors=True)
    folder.mkdir(parents=True)
    (folder / "file").write_text("")
    faults = []
    check_rejected(program, folder, "--no-such-option", "1", faults)
    check_rejected(program, folder, "--out", str(folder / "file"), faults)
    check_rejected(program, folder, "--out", str(folder / "file" / "below"), faults)
    for name, kind in options_of(program):
        if kind in ("INT", "UINT", "FLOAT"):
            for value in NEVER_NUMBERS + ([] if name in WITH_SIGN else ["-1"]):
                check_rejected(program, folder, name, value, faults)
            for value in EXTREME if extreme else []:
                check_extreme(program, folder, name, value, faults)
        elif name not in ("--out", "--only"):
            check_rejected(program, folder, name, "no/such", faults)
    sys.exit("\n".join(faults) if faults else 0)


if __name__ == "__main__":
    main(sys.argv[1:])
