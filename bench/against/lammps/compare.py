#!/usr/bin/env python3
# SPDX-License-Identifier: MIT
"""Runs the same spheres with LAMMPS and with Silt, alternately, and compares speed and physics.

    compare.py PROGRAM FOLDER [--cases CASE,…] [--cores 1,2] [--repeat 5] [--variants VARIANT,…]

PROGRAM is silt_steps; lammps.json and the last states of both codes are written to FOLDER. A CASE
is scene/grains, e.g. bed/32000. Both codes start from the same file and do some warm-up steps, then
the timed steps. LAMMPS uses gran/hooke/history, with as many processes as Silt has threads.
Variants of Silt:
    hooke_history     the same law
    cundall_strack    Silt's own law
    portable          the same law, compiled for any processor of this architecture, like Debian's
                      LAMMPS (PROGRAM_portable)
"""

import argparse
import json
import math
import os
import pathlib
import shutil
import statistics
import subprocess
import sys

HERE = pathlib.Path(__file__).resolve().parent
SLOPE = math.radians(26)
# Between 0.02 and 0.2, LAMMPS's speed varies by a tenth; with 0.1, no list of a bed is rebuilt.
SKIN = 0.1
STEPS = {4000: (1000, 4000), 32000: (1000, 1000), 256000: (300, 100), 1024000: (100, 50)}
CASES = "bed/32000,gas/32000,chute/32000,bed/256000"
VARIANTS = "hooke_history,cundall_strack,portable"


def run(command, threads=1):
    environment = {**os.environ, "OMP_NUM_THREADS": str(threads)}
    done = subprocess.run(command, env=environment, capture_output=True, text=True, check=False)
    if done.returncode != 0:
        sys.exit(f"compare.py: {' '.join(map(str, command))} failed\n{done.stdout[-2000:]}{done.stderr}")
    return done.stdout


def number_after(text, prefix):
    """The number after the prefix, in the last line that begins with it."""
    lines = [line for line in text.splitlines() if line.startswith(prefix)]
    return float(lines[-1].removeprefix(prefix).split()[0])


def lammps(scene, state, steps, cores, final):
    slope = SLOPE if scene == "chute" else 0
    values = {"scene": scene, "file": state, "warm": steps[0], "steps": steps[1],
              "skin": SKIN, "gx": math.sin(slope), "gz": -math.cos(slope), "final": final}
    command = ["lmp", "-log", "none", "-in", HERE / "grains.lammps"]
    for name, value in values.items():
        command += ["-var", name, str(value)]
    if cores > 1:
        as_root = ["--allow-run-as-root"] if os.geteuid() == 0 else []
        command = ["mpirun", *as_root, "-np", str(cores), *command]
    text = run(command)
    loops = [line for line in text.splitlines() if line.startswith("Loop time of")]
    return {"seconds": float(loops[1].split()[3]), "contacts": number_after(text, "contacts "),
            "rebuilds": number_after(text, "Neighbor list builds =")}


def silt(program, scene, grains, variant, steps, cores, final):
    law = "hooke_history" if variant == "portable" else variant
    if variant == "portable":
        program = program.with_name(program.name + "_portable")
    text = run([program, "run", scene, str(grains), law, str(steps[0]), str(steps[1]), final], cores)
    return json.loads(text)


def bodies_of(path):
    """(box, rows x y z vx vy vz wx wy wz) of a dump of LAMMPS or a file of silt_steps."""
    lines = path.read_text(encoding="utf-8").splitlines()
    box = None
    if lines[0].startswith("ITEM"):
        box = [float(side.split()[1]) - float(side.split()[0]) for side in lines[5:8]]
        return box, [list(map(float, line.split()[1:])) for line in lines[9:]]
    return box, [list(map(float, line.split())) for line in lines]


def physics(rows):
    n = len(rows)
    return {"kinetic": sum(sum(u * u for u in row[3:6]) / 2 + sum(w * w for w in row[6:9]) / 20
                           for row in rows) / n,
            "height": sum(row[2] for row in rows) / n}


def farthest(box, ours, theirs):
    """Maximum distance between the two positions of a grain (nearest images)."""
    far = 0
    for a, b in zip(ours, theirs):
        r = [x - y for x, y in zip(a[:3], b[:3])]
        far = max(far, sum((x - side * round(x / side)) ** 2 for x, side in zip(r, box)))
    return math.sqrt(far)


def spread(values):
    return {"median": statistics.median(values), "least": min(values), "most": max(values)}


def compare(program, folder, scene, grains, cores, repeat, variants):
    state = pathlib.Path(run([program, "make", scene, str(grains)]).strip())
    steps = STEPS[grains]
    theirs_at, ours_at = folder / f"lammps_{scene}.txt", folder / f"silt_{scene}.txt"
    theirs, ours = [], {variant: [] for variant in variants}
    result = {"scene": scene, "grains": grains, "cores": cores, "steps": steps}
    for _ in range(repeat):
        theirs.append(lammps(scene, state, steps, cores, theirs_at))
        for variant in variants:
            ours[variant].append(silt(program, scene, grains, variant, steps, cores, ours_at))
            if variant == "hooke_history" and "physics" not in result:
                box, their_rows = bodies_of(theirs_at)
                _, our_rows = bodies_of(ours_at)
                result["physics"] = {"lammps": physics(their_rows), "silt": physics(our_rows),
                                     "farthest": farthest(box, our_rows, their_rows)}

    def of_all(runs):
        speeds = [1e-6 * grains * steps[1] / each["seconds"] for each in runs]
        return {"million_steps_per_second": spread(speeds), "contacts": runs[-1]["contacts"],
                "rebuilds": runs[-1]["rebuilds"]}

    result["lammps"] = of_all(theirs)
    for variant in variants:
        result[variant] = of_all(ours[variant])
        ratios = [them["seconds"] / us["seconds"] for them, us in zip(theirs, ours[variant])]
        medians = [result[each]["million_steps_per_second"]["median"]
                   for each in (variant, "lammps")]
        result[variant]["times_lammps"] = {**spread(ratios), "median": medians[0] / medians[1]}
    return result


def lines_of(result, variants):
    def speed(of):
        s = of["million_steps_per_second"]
        return f"{s['median']:.1f} ({s['least']:.1f}–{s['most']:.1f})"

    physics_of = result.get("physics")
    yield (f"{result['scene']} of {result['grains']}, {result['cores']} core(s): LAMMPS "
           f"{speed(result['lammps'])} million grain-steps/s, {result['lammps']['contacts']:.3f} "
           f"contacts per grain, {result['lammps']['rebuilds']:.0f} rebuilds")
    for variant in variants:
        ratio = result[variant]["times_lammps"]
        yield (f"  {variant}: {speed(result[variant])}, "
               f"{result[variant]['contacts']:.3f} contacts, "
               f"{result[variant]['rebuilds']:.0f} rebuilds: {ratio['median']:.2f} times LAMMPS "
               f"({ratio['least']:.2f}–{ratio['most']:.2f})")
    if physics_of:
        yield "  after the same steps, LAMMPS and Silt: " + ", ".join(
            f"{what} {physics_of['lammps'][key]:.8g} and {physics_of['silt'][key]:.8g}"
            for what, key in (("kinetic energy of a grain", "kinetic"), ("mean height", "height"))
        ) + ("; maximum distance between corresponding grains "
             f"{physics_of['farthest']:.1e} diameters")


def main():
    parser = argparse.ArgumentParser(description=__doc__,
                                     formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("program", type=pathlib.Path)
    parser.add_argument("folder", type=pathlib.Path)
    parser.add_argument("--cases", default=CASES)
    parser.add_argument("--cores", default="1,2")
    parser.add_argument("--repeat", type=int, default=5)
    parser.add_argument("--variants", default=VARIANTS)
    arguments = parser.parse_args()
    if not shutil.which("lmp") or subprocess.run(["lmp", "-help"], capture_output=True, check=False).returncode:
        print("LAMMPS (Debian's package lammps) is not installed, or does not run: Silt is not compared with it.")
        return
    arguments.folder.mkdir(parents=True, exist_ok=True)
    variants = arguments.variants.split(",")
    version = run(["lmp", "-help"]).strip().splitlines()[0].split(" - ", 1)[1]
    results = []
    for case in arguments.cases.split(","):
        scene, grains = case.split("/")
        for cores in map(int, arguments.cores.split(",")):
            results.append(compare(arguments.program.resolve(), arguments.folder, scene,
                                   int(grains), cores, arguments.repeat, variants))
            print("\n".join(lines_of(results[-1], variants)), flush=True)
    (arguments.folder / "lammps.json").write_text(
        json.dumps({"lammps": version, "results": results}, indent=1), encoding="utf-8")


if __name__ == "__main__":
    main()
