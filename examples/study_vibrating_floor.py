#!/usr/bin/env python3
# SPDX-License-Identifier: MIT
"""Runs vibrating_floor for Figs 5 to 8 of [SahChoi2004] and for additional checks.

    study_vibrating_floor.py PROGRAM FOLDER [further options of the program]

Each run has a subfolder of FOLDER; existing runs with the same options are not repeated. Then
plot_vibrating_floor.py draws and compares all runs. examples/run --study vibrating_floor builds the
program and calls this script.
"""

import pathlib
import subprocess
import sys
import time

HERE = pathlib.Path(__file__).resolve().parent
sys.path.insert(0, str(HERE))
from support.runs import has_options

# The runs of the paper: five runs give its six curves, twice.
SPHERES = {
    "m1_v2": {"mass-holdup": 1, "boundary-velocity": 2, "until": 44},
    "m2.5_v2": {"mass-holdup": 2.5, "boundary-velocity": 2, "until": 34},
    "m5_v2": {"mass-holdup": 5, "boundary-velocity": 2, "until": 24},
    "m5_v0.25": {"mass-holdup": 5, "boundary-velocity": 0.25, "until": 16},
    "m5_v5": {"mass-holdup": 5, "boundary-velocity": 5, "until": 24},
}
# A tenth of K_1 is sufficient, as the first two runs show.
SOFT = {"loading-stiffness": 2.7e7}
CHECKS = {
    "m1_v2_soft": {**SPHERES["m1_v2"], **SOFT},
    "m2.5_v2_soft": {**SPHERES["m2.5_v2"], **SOFT},
    "m5_v2_soft": {**SPHERES["m5_v2"], **SOFT},
    "m1_v2_soft_wide": {**SPHERES["m1_v2"], **SOFT, "cell-width": 16, "until": 24},
    "m2.5_v2_soft_wide": {**SPHERES["m2.5_v2"], **SOFT, "cell-width": 16, "until": 20},
}
DISCS = {f"discs_{name}": {**options, **SOFT, "dimension": 2, "cell-width": 40}
         for name, options in SPHERES.items()}
DISCS["discs_m1_v2"]["until"] = 204  # few discs: the temperature hardly decreases with height
RUNS = {**SPHERES, **CHECKS, **DISCS}


def main(arguments):
    if len(arguments) < 2:
        sys.exit(__doc__)
    program, folder, further = arguments[0], pathlib.Path(arguments[1]), arguments[2:]
    begin = time.monotonic()
    for number, (name, options) in enumerate(RUNS.items(), 1):
        if has_options(folder / name / "summary.json", options):
            print(f"{number}/{len(RUNS)} {name}: there already", flush=True)
            continue
        print(f"{number}/{len(RUNS)} {name}, after {(time.monotonic() - begin) / 60:.0f} minutes",
              flush=True)
        (folder / name).mkdir(parents=True, exist_ok=True)
        numbers = [f"--{option}={value}" for option, value in options.items()]
        run = subprocess.run([program, "--out", str(folder / name), *numbers, *further])
        if run.returncode != 0:
            sys.exit(f"study_vibrating_floor.py: {name} failed")
    drawn = subprocess.run([sys.executable, str(HERE / "plot_vibrating_floor.py"), str(folder)])
    if drawn.returncode != 0:
        sys.exit(drawn.returncode)  # it has printed the reason
    print((folder / "comparison.md").read_text())


if __name__ == "__main__":
    main(sys.argv[1:])
