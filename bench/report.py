#!/usr/bin/env python3
# SPDX-License-Identifier: MIT
"""Writes the results of the benchmarks as tables, with the targets.

    report.py FOLDER         reads FOLDER/*.json, writes FOLDER/report.md and prints it
    report.py FOLDER PAGE    also inserts it in PAGE, between its two comments for that purpose

The file of a benchmark is NAME.THREADS.json; lammps.json is written by against/lammps/compare.py.
"""

import dataclasses
import json
import math
import pathlib
import platform
import re
import statistics
import sys

SECONDS = {"ns": 1e-9, "us": 1e-6, "ms": 1e-3, "s": 1}
FIGURES_OF_THE_RUN = {
    "name", "run_name", "run_type", "family_index", "per_family_instance_index", "repetitions",
    "repetition_index", "threads", "real_time", "cpu_time", "time_unit",
    "items_per_second", "aggregate_name", "aggregate_unit", "label",
}


@dataclasses.dataclass
class Measured:
    """Results for one size of one family with a number of threads."""

    seconds: float
    particles: int
    counters: dict

    @property
    def ns_per_particle(self):
        return 1e9 * self.seconds / self.particles


class Results:
    """families[name][threads][size] → Measured; medians of repeated runs."""

    def __init__(self, folder):
        self.families, self.context, self.lammps = {}, {}, None
        for file in sorted(folder.glob("*.json")):
            text = file.read_text(encoding="utf-8")
            if not text.strip():
                continue  # the filter selected no benchmark
            try:
                content = json.loads(text)
            except json.JSONDecodeError as error:
                sys.exit(f"report.py: {file} is incomplete ({error}); run its benchmark again")
            if file.name == "lammps.json":
                self.lammps = content
                continue
            threads = int(file.suffixes[-2][1:]) if len(file.suffixes) > 1 else 1
            self.context = content["context"]
            for result in content["benchmarks"]:
                self.add(result, threads)

    def add(self, result, threads):
        if result.get("error_occurred") or result.get("aggregate_name", "median") != "median":
            return
        if result.get("run_type") == "iteration" and result.get("repetitions", 1) > 1:
            return  # its median follows
        name = re.fullmatch(r"(.*?)/(\d+)((/\w+:\d+)*)(/real_time)?", result["run_name"])
        if not name:
            return
        # CPU time of one thread, which excludes other load; wall-clock time of several threads.
        clock = "cpu_time" if threads == 1 else "real_time"
        seconds = result[clock] * SECONDS[result["time_unit"]]
        size = int(name[2])
        wall = result["real_time" if name[5] else "cpu_time"] * SECONDS[result["time_unit"]]
        particles = round(result.get("items_per_second", 0) * wall) or size
        counters = {key: value for key, value in result.items()
                    if key not in FIGURES_OF_THE_RUN and isinstance(value, (int, float))}
        family = self.families.setdefault(name[1], {}).setdefault(threads, {})
        family[size] = Measured(seconds, particles, counters)

    def at(self, family, size, threads=1):
        return self.families.get(family, {}).get(threads, {}).get(size)

    def ns(self, family, size, threads=1):
        measured = self.at(family, size, threads)
        return measured and measured.ns_per_particle

    def ms(self, family, size, threads=1):
        measured = self.at(family, size, threads)
        return measured and 1e3 * measured.seconds

    def exponent(self, family, min_size=3000):
        """k of time = c N^k, fitted to sizes of at least `min_size`."""
        points = [(math.log(each.particles), math.log(each.seconds))
                  for each in self.families.get(family, {}).get(1, {}).values()
                  if each.particles >= min_size]
        if len(points) < 2:
            return None
        n, t = (statistics.mean(values) for values in zip(*points))
        return sum((x - n) * (y - t) for x, y in points) / sum((x - n) ** 2 for x, y in points)

    def speed_up(self, family, size):
        one, two = self.at(family, size), self.at(family, size, 2)
        return one and two and one.seconds / two.seconds


def number(value):
    if value is None:
        return ""
    if value == 0:
        return "0"
    digits = max(0, 2 - math.floor(math.log10(abs(value))))
    return f"{value:.{digits}f}" if abs(value) < 1e5 else f"{value:.3g}"


def table(titles, rows):
    yield "| " + " | ".join(titles) + " |"
    yield "|" + "---|" * len(titles)
    for row in rows:
        yield "| " + " | ".join(row) + " |"
    yield ""


def of_program(results, program):
    return [family for family in results.families if family.split("/")[0] == program]


def by_size(results, program, sizes):
    """Nanoseconds per particle, one column per size."""
    rows = []
    for family in of_program(results, program):
        largest = max(results.families[family].get(1, {0: 0}))
        rows.append([family.removeprefix(program + "/"),
                     *(number(results.ns(family, size)) for size in sizes),
                     number(results.exponent(family)),
                     number(results.speed_up(family, largest))])
    titles = [f"{size:.3g}".replace("e+0", "e") for size in sizes]
    yield from table(["ns per particle and step, N =", *titles, "exponent from 3000 on",
                      "two threads, largest N"], rows)


def by_row(results, program):
    """One row per size, with all counters."""
    rows, counters = [], []
    for family in of_program(results, program):
        for of_threads in results.families[family].values():
            for each in of_threads.values():
                counters += [key for key in each.counters if key not in counters]
    for family in of_program(results, program):
        for size, each in sorted(results.families[family].get(1, {}).items()):
            rows.append([f"{family.removeprefix(program + '/')}/{size}", number(1e3 * each.seconds),
                         number(results.speed_up(family, size)),
                         *(number(each.counters.get(key)) for key in counters)])
    yield from table(["", "ms", "two threads", *(key.replace("_", " ") for key in counters)], rows)


def memory_table(results):
    rows = []
    for family in of_program(results, "memory"):
        for each in results.families[family].get(1, {}).values():
            of = each.counters
            rows.append([family.removeprefix("memory/"), number(of["particles"]),
                         number(of["bytes"]), number(of["peak"]), number(of["allocations"])])
    yield from table(["", "particles", "bytes per particle", "peak", "allocations of warm steps"],
                     rows)


def held_table(results):
    """What grains hold at the peak [bytes per particle], most first."""
    scenes = of_program(results, "held")
    held = {scene: next(iter(results.families[scene][1].values())).counters for scene in scenes}
    names = {name for of in held.values() for name in of} - {"iterations"}
    first = held[scenes[0]]
    rows = [[name, *(number(held[scene].get(name)) for scene in scenes)]
            for name in sorted(names, key=lambda name: -first.get(name, 0))]
    yield from table(["", *(scene.removeprefix("held/") for scene in scenes)], rows)


def lammps_table(content):
    rows = []

    def spread(of, digits):
        return f"{of['median']:.{digits}f} ({of['least']:.{digits}f}–{of['most']:.{digits}f})"

    for result in content["results"]:
        for variant in ("hooke_history", "cundall_strack", "portable"):
            if variant not in result:
                continue
            ours, theirs = result[variant], result["lammps"]
            rows.append([f"{result['scene']}/{result['grains']}", str(result["cores"]), variant,
                         spread(theirs["million_steps_per_second"], 1),
                         spread(ours["million_steps_per_second"], 1),
                         f"**{spread(ours['times_lammps'], 2)}**",
                         f"{theirs['contacts']:.3f} / {ours['contacts']:.3f}",
                         f"{theirs['rebuilds']:.0f} / {ours['rebuilds']:.0f}"])
    yield from table(["", "cores", "variant of Silt", "LAMMPS", "Silt", "times LAMMPS",
                      "contacts per grain", "rebuilds"], rows)
    rows = []
    for result in content["results"]:
        if "physics" not in result:
            continue
        of = result["physics"]
        energies = [of[code]["kinetic"] for code in ("lammps", "silt")]
        heights = [of[code]["height"] for code in ("lammps", "silt")]
        rows.append([f"{result['scene']}/{result['grains']}", str(result["cores"]),
                     str(sum(result["steps"])), f"{energies[0]:.6g}",
                     f"{energies[1] / energies[0] - 1:+.1e}",
                     "" if result["scene"] == "gas" else f"{heights[1] - heights[0]:+.1e}",
                     f"{of['farthest']:.1e}"])
    yield from table(["", "cores", "steps", "kinetic energy of a grain, LAMMPS", "Silt's, relative",
                      "mean height, difference",
                      "maximum distance between corresponding grains"], rows)


# --- targets -------------------------------------------------------------------------------------


def ratio(a, b):
    return a / b if a and b else None


def lammps_ratio(results, scene, grains, cores, variant="hooke_history"):
    for result in results.lammps["results"] if results.lammps else []:
        if (result["scene"], result["grains"], result["cores"]) == (scene, grains, cores):
            return result.get(variant, {}).get("times_lammps", {}).get("median")
    return None


def of_memory(results, kind):
    """Maximum bytes per particle of the simulations of this kind."""
    held = [max(each.counters["bytes"], each.counters["peak"])
            for family in of_program(results, "memory") if family.startswith(f"memory/{kind}")
            for each in results.families[family].get(1, {}).values()]
    return max(held, default=None)


def max_iterations(results, tanks):
    counts = [each.counters["iterations"]
              for tank in tanks
              for each in results.families.get(f"pressure_solve/multigrid/{tank}", {}).get(1, {}).values()
              if each.particles >= 2500]
    return max(counts, default=None)


MORE, LESS = True, False  # which is better


def targets(results):
    """(quantity, whether more is better, minimum target, aim, measured)."""
    yield from search_targets(results)
    yield from grain_targets(results)
    for tanks, what, at_least, aim in (
            (["2d"], "2D", 18, 14), (["3d"], "3D", 20, 16),
            (["baffles_2d", "baffles_3d", "closed_2d", "closed_3d"],
             "thin walls or closed tanks", 30, 20)):
        yield (f"solver iterations, 3·10³–10⁶ unknowns, {what}", LESS, at_least, aim,
               max_iterations(results, tanks))
    dams = (("D1", "2d", 3200), ("D2", "2d", 51200), ("D3", "3d", 102400))
    for (name, family, size), at_least, aim in zip(dams, (1.5, 22, 65), (1, 15, 45)):
        measured = results.at(f"mps_step/{family}", size)
        yield (f"pressure solve with its setup, {name} [ms]", LESS, at_least, aim,
               measured and measured.counters["solve_ms"])
    for (name, family, size), at_least, aim in zip(dams, (3, 45, 160), (2, 28, 100)):
        yield (f"MPS step, {name} [ms]", LESS, at_least, aim,
               results.ms(f"mps_step/{family}", size))
    for name, family, size in dams + (("12 800 in 2D", "2d", 12800), ("12 800 in 3D", "3d", 12800)):
        yield (f"MPS step, {name}, recommended scheme, times that of case 10", LESS, 1.3, 1.0,
               ratio(results.ms(f"mps_step/recommended/{family}", size),
                     results.ms(f"mps_step/{family}", size)))
    yield ("MPS 2D, exponent", LESS, 1.10, 1.03, results.exponent("mps_step/2d"))
    for (name, family, size), at_least, aim in zip(dams, (1.5, 1.8, 1.8), (1.8, 1.9, 1.9)):
        yield (f"speed-up with two threads, MPS step, {name}", MORE, at_least, aim,
               results.speed_up(f"mps_step/{family}", size))
    yield ("MPS, bytes per particle", LESS, 1200, 700, of_memory(results, "mps"))
    yield from two_thread_targets(results)


def grain_targets(results):
    # For one core and two. The aims are what a loop written for these cases alone reached on an AMD
    # server.
    for scene, all_at_least, aims in (("bed", (2.2, 2.0), (2.6, 2.35)),
                                      ("gas", (2.56, 2.08), (3.2, 2.7)),
                                      ("chute", (2.4, 2.0), (3.0, 2.6))):
        for grains in (32000, 256000):
            for cores, at_least, aim in zip((1, 2), all_at_least, aims):
                yield (f"DEM {scene} {grains}, {cores} core(s), times LAMMPS", MORE, at_least, aim,
                       lammps_ratio(results, scene, grains, cores))
    yield ("DEM bed 32000, 1 core(s), `CundallStrack`, times LAMMPS", MORE, 1.8, 2.5,
           lammps_ratio(results, "bed", 32000, 1, "cundall_strack"))
    yield ("DEM bed, exponent", LESS, 1.10, 1.04, results.exponent("dem_step/bed"))
    yield ("DEM, a grain added in each step, times a step without", LESS, 1.5, 1.1,
           ratio(results.ms("dem_step/rain", 97336), results.ms("dem_step/lattice", 97336)))
    yield ("DEM bed, bytes per particle", LESS, 800, 500, of_memory(results, "dem_bed"))
    for search in ("neighbour_list", "list_over_levels"):
        for size_ratio in (10, 20):
            times = [results.at(f"size_ratio/{search}", each) for each in (size_ratio, 1)]
            yield (f"DEM, {search}, radii 1:{size_ratio}, times the time per contact of 1:1", LESS,
                   2.5, 1.5, ratio(*(each and each.counters.get("per_contact") for each in times)))


def search_targets(results):
    def ns(search, size=1000000, kind="3d/double/dense"):
        return results.ns(f"contact_search/{search.replace('/', '/' + kind + '/')}", size)

    grid, half, nanoflann = "uniform_grid/full", "uniform_grid/half", "nanoflann/full"
    mps = {"kind": "3d/double/mps"}
    yield "full list, 3D, 10⁶, dense [ns per particle]", LESS, 60, 30, ns(grid)
    yield "full list, 3D, 10⁶, MPS radius [ns per particle]", LESS, 200, 120, ns(grid, **mps)
    yield "half list, 3D, 10⁶, dense [ns per particle]", LESS, 35, 16, ns(half)
    yield "times nanoflann, 10⁶, dense", MORE, 10, 20, ratio(ns(nanoflann), ns(grid))
    yield ("times nanoflann, 10⁶, MPS radius", MORE, 10, 20,
           ratio(ns(nanoflann, **mps), ns(grid, **mps)))
    for size, at_least, aim in ((10000, 120, 180), (100000, 1000, 1600)):
        yield (f"times O(N²), every pair once, {size}", MORE, at_least, aim,
               ratio(ns("brute_force/pairs", size), ns(half, size)))


def two_thread_targets(results):
    """Minimum and median of each program, for more than 3·10⁴ particles."""
    for program in ("contact_search", "dem_step", "mps_step", "pressure_solve"):
        gains = {}
        for family in of_program(results, program):
            if any(word in family for word in ("brute_force", "nanoflann", "hypre", "/ic/")):
                continue  # single-threaded
            for size, each in results.families[family].get(1, {}).items():
                if each.particles > 30000 and results.speed_up(family, size):
                    gains[f"{family}/{size}"] = results.speed_up(family, size)
        if gains:
            lowest = min(gains, key=gains.get)
            yield (f"minimum speed-up with two threads, {program} "
                   f"({lowest.removeprefix(program + '/')})", MORE, 1.7, 1.9, gains[lowest])
            yield (f"median speed-up with two threads, {program}", MORE, 1.7, 1.9,
                   statistics.median(gains.values()))


def target_table(results):
    rows = []
    for what, more, at_least, aim, measured in targets(results):
        if measured is None:
            continue
        reached = "missed"
        for word, bound in (("at least", at_least), ("aim", aim)):
            if (measured >= bound) if more else (measured <= bound):
                reached = word
        rows.append([what, number(at_least), number(aim), number(measured), reached])
    yield from table(["", "at least", "aim", "measured", "reached"], rows)


def processor():
    try:
        lines = pathlib.Path("/proc/cpuinfo").read_text(encoding="utf-8").splitlines()
    except OSError:
        lines = []
    names = [line.split(":", 1)[1].strip() for line in lines if line.startswith("model name")]
    return names[0] if names else platform.processor() or platform.machine()


def lines_of(results):
    context = results.context
    yield from ["# Benchmarks", "",
                f"- machine: {processor()}, {context.get('num_cpus', '?')} cores, "
                f"{platform.system()} {platform.machine()}",
                f"- compiler: {context.get('compiler', 'unknown')}",
                f"- flags: `{context.get('flags', 'unknown')}`",
                f"- date: {context.get('date', 'unknown')}", "",
                "One thread unless stated otherwise; \"two threads\" is the speed-up with "
                "two threads.", "", "## Targets", ""]
    yield from target_table(results)
    if of_program(results, "contact_search"):
        yield from ["## Contact search", ""]
        yield from by_size(results, "contact_search", (1000, 10000, 100000, 1000000))
    if of_program(results, "dem_step"):
        yield from ["## Whole steps of DEM", ""]
        yield from by_size(results, "dem_step", (4000, 32000, 256000, 1024000))
    if results.lammps:
        yield from ["## DEM against LAMMPS", "",
                    f"LAMMPS {results.lammps['lammps']}; million grain-steps per second, median "
                    "(minimum–maximum) of alternating runs.", ""]
        yield from lammps_table(results.lammps)
    for program, title in (("mps_step", "Whole steps of MPS"), ("pressure_solve", "Pressure solve")):
        if of_program(results, program):
            yield from [f"## {title}", ""]
            yield from by_row(results, program)
    if of_program(results, "memory"):
        yield from ["## Memory", ""]
        yield from memory_table(results)
    if of_program(results, "held"):
        yield from ["Of grains, bytes per particle that are held at the peak:", ""]
        yield from held_table(results)


def put_into_page(text, page, program):
    """Replaces the text between the two comments of a program in a page."""
    begin, end = f"<!-- {program}: from here -->\n", f"<!-- {program}: to here -->\n"
    before, _, rest = page.read_text(encoding="utf-8").partition(begin)
    _, found, after = rest.partition(end)
    if not found:
        sys.exit(f"{program}: {page} lacks the comments {begin.strip()} and {end.strip()}")
    page.write_text(before + begin + "\n" + text.rstrip() + "\n\n" + end + after, encoding="utf-8")


def main(arguments):
    if len(arguments) not in (1, 2):
        sys.exit(__doc__)
    folder = pathlib.Path(arguments[0])
    results = Results(folder)
    if not results.families and not results.lammps:
        sys.exit(f"report.py: {folder} has no *.json with results; run bench/run first")
    text = "\n".join(lines_of(results))
    (folder / "report.md").write_text(text, encoding="utf-8")
    print(text, end="")
    if len(arguments) == 2:
        body = text.partition("\n")[2].lstrip().replace("\n## ", "\n### ")  # one level lower
        put_into_page(body, pathlib.Path(arguments[1]), "bench/report.py")


if __name__ == "__main__":
    main(sys.argv[1:])
