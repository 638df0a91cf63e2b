#!/usr/bin/env python3
# SPDX-License-Identifier: MIT
"""Turns the JSON of the benchmarks into a table.

    report.py FOLDER    reads FOLDER/*.json, writes FOLDER/report.md and prints it

Figures that were not measured but follow from a fit are marked with ~.
"""

import json
import pathlib
import platform
import sys

NANOSECONDS = {"ns": 1, "us": 1e3, "ms": 1e6, "s": 1e9}


def processor():
    try:
        lines = pathlib.Path("/proc/cpuinfo").read_text(encoding="utf-8").splitlines()
    except OSError:
        lines = []
    names = [line.split(":", 1)[1].strip() for line in lines if line.startswith("model name")]
    return names[0] if names else platform.processor() or platform.machine()


def times_of(results):
    """{family: {particles: nanoseconds of an iteration}}; the median where runs were repeated."""
    times = {}
    for result in results:
        if result.get("run_type") == "aggregate" and result.get("aggregate_name") != "median":
            continue
        # Wall-clock time where a benchmark asks for it, as those with threads do.
        clock = "real_time" if result["run_name"].endswith("/real_time") else "cpu_time"
        name = result["run_name"].removesuffix("/real_time")
        family, _, particles = name.rpartition("/")
        if particles.isdigit() and "error_occurred" not in result:
            nanoseconds = result[clock] * NANOSECONDS[result["time_unit"]]
            times.setdefault(family, {})[int(particles)] = nanoseconds
    return times


def quadratic(times):
    """c of time = c N², by the largest N, where nothing else counts; and that N."""
    largest = max(times)
    return times[largest] / largest**2, largest


def short(nanoseconds):
    for unit, size in (("s", 1e9), ("ms", 1e6), ("µs", 1e3)):
        if nanoseconds >= size:
            return f"{nanoseconds / size:.3g} {unit}"
    return f"{nanoseconds:.3g} ns"


def number(value):
    return f"{value:.0f}" if value >= 100 else f"{value:.2g}" if value < 10 else f"{value:.1f}"


def search_tables(times):
    kinds = [family.removeprefix("contact_search/uniform_grid/") for family in times
             if family.startswith("contact_search/uniform_grid/")]
    lines = []

    lines += ["## Contact search: time per particle [ns]", "",
              "| | 10³ | 10⁴ | 10⁵ | 10⁶ | 10⁵ over 10³ |", "|---|---|---|---|---|---|"]
    for family, measured in times.items():
        if not family.startswith("contact_search/"):
            continue
        cells = [number(measured[n] / n) if n in measured else "" for n in
                 (1000, 10000, 100000, 1000000)]
        both = 1000 in measured and 100000 in measured
        cells.append(f"{measured[100000] / measured[1000] / 100:.2f}" if both else "")
        lines.append(f"| {family.removeprefix('contact_search/')} | " + " | ".join(cells) + " |")

    lines += ["", "## Contact search: speed-up over O(N²)", "",
              "| | 10³ | 10⁴ | 10⁵ |", "|---|---|---|---|"]
    claims, fits = [], []
    for kind in kinds:
        brute = times.get(f"contact_search/brute_force/{kind}")
        if not brute:
            continue
        c, largest = quadratic(brute)
        fits.append(f"{kind}: {c:.3g} ns N² (from N = {largest})")
        for search in ("uniform_grid", "neighbour_list"):
            measured = times.get(f"contact_search/{search}/{kind}", {})
            cells = []
            for n in (1000, 10000, 100000):
                if n not in measured:
                    cells.append("")
                elif n in brute:
                    cells.append(number(brute[n] / measured[n]))
                else:
                    cells.append("~" + number(c * n**2 / measured[n]))
            lines.append(f"| {search}/{kind} | " + " | ".join(cells) + " |")
        grid = times[f"contact_search/uniform_grid/{kind}"]
        claims += [(kind, n, grid[n] / brute[n]) for n in sorted(grid) if n in brute]
    if fits:
        lines += ["", "~: brute force was not run at 10⁵; its time is extrapolated from its own N², "
                  + "; ".join(fits) + "."]
    if claims:
        sizes = sorted({n for _, n, _ in claims})
        shares = {n: max(share for _, m, share in claims if m == n) for n in sizes}
        broken = [n for n in sizes if shares[n] >= 0.5]
        held = [n for n in sizes if n > max(broken, default=0)]
        verdict = (f"holds in every case from N = {held[0]} on" if held else "does not hold")
        lines += ["", f"The paper claims less than 50 % of the O(M²) time: with the uniform grid this "
                  f"{verdict}. The largest share of all cases is "
                  + ", ".join(f"{100 * shares[n]:.2g} % at {n}" for n in sizes) + "."]
    return lines


def step_table(results, family, title, further):
    """One row a size; further: name of a counter → title of its column."""
    lines = ["", f"## {title}", "",
             "| | particles | a step | per particle [ns] |" + "".join(f" {each} |" for each in
                                                                   further.values()),
             "|---|---|---|---|" + "---|" * len(further)]
    for result in results:
        if not result["name"].startswith(family) or result.get("run_type") == "aggregate":
            continue
        if "items_per_second" not in result:
            continue
        name = "/".join(result["name"].removeprefix(family).split("/")[:2])
        t = result["real_time"] * NANOSECONDS[result["time_unit"]]
        n = round(t * 1e-9 * result["items_per_second"])
        lines.append(f"| {name} | {n} | {short(t)} | {number(t / n)} |"
                     + "".join(f" {number(result[each])} |" for each in further))
    return lines


def main(arguments):
    if len(arguments) != 1:
        sys.exit(__doc__)
    folder = pathlib.Path(arguments[0])
    files = sorted(folder.glob("*.json"))
    if not files:
        sys.exit(f"report.py: {folder} has no *.json; run bench/run first")
    results, context = [], {}
    for file in files:
        text = file.read_text(encoding="utf-8")
        if not text.strip():
            continue  # its benchmark had nothing that the filter wanted
        try:
            content = json.loads(text)
        except json.JSONDecodeError as error:
            sys.exit(f"report.py: {file} is broken off ({error}); run its benchmark again")
        results += content["benchmarks"]
        context = content["context"]
    times = times_of(results)

    lines = ["# Benchmarks", "",
             f"- machine: {processor()}, {context.get('num_cpus', '?')} threads, "
             f"{platform.system()} {platform.machine()}",
             f"- compiler: {context.get('compiler', 'unknown')}",
             f"- flags: `{context.get('flags', 'unknown')}`",
             f"- date: {context.get('date', 'unknown')}", "",
             "Points of a packing's density in random order, fixed seed; an iteration of a contact "
             "search is update() and for_each_pair().", ""]
    if any(family.startswith("contact_search/") for family in times):
        lines += search_tables(times)
    if any(result["name"].startswith("dem_step/") for result in results):
        lines += step_table(results, "dem_step/", "Whole steps of DEM",
                            {"contacts": "contacts per grain", "threads": "threads"})
    if any(result["name"].startswith("mps_step/") for result in results):
        lines += step_table(results, "mps_step/", "Whole steps of MPS",
                            {"iterations": "iterations", "pressure_ms": "in the pressure [ms]",
                             "threads": "threads"})
    text = "\n".join(lines) + "\n"
    (folder / "report.md").write_text(text, encoding="utf-8")
    print(text, end="")


if __name__ == "__main__":
    main(sys.argv[1:])
