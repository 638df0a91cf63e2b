#!/usr/bin/env python3
# SPDX-License-Identifier: MIT
"""Repeats the study of [HwangLeePark2010], draws its figures, and reports which findings are
reproduced.

    paper_figures.py [--only fig5,fig7,…] [--out FOLDER] [--quick] [--jobs N] --programs FOLDER

examples/paper_figures builds the programs and calls this script. Each run has a subfolder of
FOLDER; existing runs with the same options are not repeated. Writes a picture for each figure, and
comparison.md, to FOLDER.
"""

import argparse
import os
import pathlib
import sys

HERE = pathlib.Path(__file__).resolve().parent
sys.path.insert(0, str(HERE))
from support import paper_plots, plot_style as style
from support.paper_results import Results, findings
from support.paper_study import CASES, Study
from support.runs import run_all

FIGURES = tuple(paper_plots.DRAW)


def figures_of(text):
    names = [name.strip() for name in text.split(",")]
    if unknown := [name for name in names if name not in FIGURES]:
        raise argparse.ArgumentTypeError(
            f"{', '.join(unknown)} is none of the figures {', '.join(FIGURES)}")
    return [name for name in FIGURES if name in names]


def options_of(arguments):
    parser = argparse.ArgumentParser(
        prog="paper_figures",
        description="Runs the study of Hwang, Lee and Park (2010), draws its figures, and reports "
                    "which of its findings are reproduced.")
    parser.add_argument("--only", type=figures_of, default=list(FIGURES), metavar="FIGURE,…",
                        help=f"some of {', '.join(FIGURES)}")
    parser.add_argument("--out", type=pathlib.Path, default=pathlib.Path("out/paper"),
                        help="folder (%(default)s)")
    parser.add_argument("--quick", action="store_true", help="coarser and shorter runs, as a trial")
    parser.add_argument("--jobs", type=int, default=os.cpu_count() or 1,
                        help="number of simultaneous runs, of one thread each (%(default)s)")
    parser.add_argument("--check", action="store_true", help=argparse.SUPPRESS)
    parser.add_argument("--programs", type=pathlib.Path, default=None, help=argparse.SUPPRESS)
    options = parser.parse_args(arguments)
    if options.jobs < 1:
        parser.error(f"--jobs {options.jobs} must be at least 1")
    if options.programs is None:
        parser.error("call examples/paper_figures, which builds the programs")
    return options


def table_of_cases(results):
    end = results.common_end()
    lines = ["", f"## The eleven cases, P2 from 0.4 s to {end:.2f} s", "",
             "| case | runs | failed | roughness [kPa] | peak [kPa] | impulse [kPa s] | front, rms "
             "against the experiment | most particles lost |", "|---|---|---|---|---|---|---|---|"]
    for number in CASES:
        case = results.case(number)
        lines.append(
            f"| {number:02d} | {len(case.runs)} | {len(case.failures)} "
            f"| {case.roughness(end).text(1e-3)} | {case.peak(end).text(1e-3, 1)} "
            f"| {case.impulse(end).text(1e-3)} | {case.front_error().text(100)} % "
            f"| {case.lost} |")
    return lines


def comparison(results, figures, runs):
    lines = ["# The paper's findings, in runs of Silt", "",
             "After [HwangLeePark2010]. ± one standard error over runs that differ in their Courant "
             "number only. Roughness: rms of the pressure minus its moving average over 0.02 s; "
             "peak: the maximum of that average. A run that lost more than 1 % of its particles "
             "counts as failed.", "", "| finding | Silt | |", "|---|---|---|"]
    lines += [f"| {found.what} | {found.figures} | {found.verdict()} |"
              for found in findings(results, figures)]
    if "fig12" in figures or "fig13" in figures:
        lines += table_of_cases(results)
    if failed := {run.folder.name: run.failure() for run in runs if run.failure() is not None}:
        lines += ["", "## Runs that failed", "", "| run | |", "|---|---|"]
        lines += [f"| {name} | {sentence} |" for name, sentence in failed.items()]
    return "\n".join(lines) + "\n"


def main(arguments):
    options = options_of(arguments)
    if options.check:
        return
    programs = {name: options.programs / name for name in ("hydrostatic", "dam_break")}
    study = Study(options.out, programs, options.quick)
    runs = [run for figure in options.only for run in study.runs_for(figure)]
    run_all(runs, options.jobs)
    results = Results(study)
    for figure in options.only:
        style.make(options.out / f"{figure}.png", paper_plots.DRAW[figure], results)
    text = comparison(results, options.only, list({run.folder: run for run in runs}.values()))
    (options.out / "comparison.md").write_text(text, encoding="utf-8")
    print(text)
    print("Files written:", *(options.out / f"{figure}.png" for figure in options.only),
          options.out / "comparison.md", sep="\n  ")


if __name__ == "__main__":
    main(sys.argv[1:])
