# SPDX-License-Identifier: MIT
"""Runs programs of this folder, several at a time, and skips runs that exist already.

    runs = [Run("out/a", "build/dam_break", {"case": 10, "until": 1.0}), ...]
    run_all(runs, jobs=2)
    runs[0].is_done(), runs[0].failure()

A run is done if its folder has a summary.json with these options. A run that failed with an error
message has a failed.json with them. A run that was killed has neither, and is repeated.
"""

import concurrent.futures
import json
import pathlib
import subprocess
import sys
import threading
import time


def text_of(value):
    """Command-line text of an option's value: lists are separated by commas."""
    return ",".join(f"{each:g}" for each in value) if isinstance(value, list) else str(value)


def has_options(path, options):
    """Whether the file is from a run with these options, and any others."""
    try:
        there = json.loads(path.read_text(encoding="utf-8"))["options"]
    except (OSError, ValueError, KeyError):
        return False
    return all(there.get(name.replace("-", "_")) == value for name, value in options.items())


class Run:
    """A program, its options without dashes, and its folder; `cost`: relative run time."""

    def __init__(self, folder, program, options, cost=1.0):
        self.folder = pathlib.Path(folder)
        self.program = program
        self.options = options
        self.cost = cost

    def is_done(self):
        return has_options(self.folder / "summary.json", self.options)

    def failure(self):
        """The error message of the run, if it failed."""
        path = self.folder / "failed.json"
        if not has_options(path, self.options):
            return None
        return json.loads(path.read_text(encoding="utf-8"))["sentence"]

    def command(self, further=()):
        options = [f"--{name}={text_of(value)}" for name, value in self.options.items()]
        return [str(self.program), f"--out={self.folder}", *options, *further]

    def run(self):
        """Runs the program. Raises if its options were rejected or it was killed: neither is a
        result of the run."""
        self.folder.mkdir(parents=True, exist_ok=True)
        for name in ("summary.json", "failed.json"):
            (self.folder / name).unlink(missing_ok=True)
        end = subprocess.run(self.command(), stdout=subprocess.DEVNULL, stderr=subprocess.PIPE,
                             text=True)
        said = (end.stderr.strip().splitlines() or ["it said nothing"])[-1]
        if end.returncode == 1:
            failed = {"sentence": said,
                      "options": {name.replace("-", "_"): value
                                  for name, value in self.options.items()}}
            (self.folder / "failed.json").write_text(json.dumps(failed), encoding="utf-8")
        elif end.returncode != 0:
            raise RuntimeError(f"{' '.join(self.command())} ended with {end.returncode}: {said}")


class Progress:
    """Prints a line for every finished run, with the remaining time estimated from the costs."""

    def __init__(self, runs):
        self.cost_left = sum(run.cost for run in runs)
        self.cost_done = 0.0
        self.number = 0
        self.total = len(runs)
        self.begin = time.monotonic()
        self.lock = threading.Lock()

    def ended(self, run):
        with self.lock:
            self.number += 1
            self.cost_done += run.cost
            self.cost_left -= run.cost
            minutes = (time.monotonic() - self.begin) / self.cost_done * self.cost_left / 60
            said = run.failure()
            print(f"{self.number}/{self.total} {run.folder}: "
                  f"{'done' if said is None else 'FAILED: ' + said}; {minutes:.1f} minutes left",
                  flush=True)


def run_all(runs, jobs):
    """Does the runs that are neither done nor failed, `jobs` at a time, in the given order."""
    # Two studies may share a run.
    by_folder = {run.folder: run for run in runs}
    wanted = [run for run in by_folder.values() if not run.is_done() and run.failure() is None]
    print(f"{len(by_folder)} runs, {len(by_folder) - len(wanted)} of them there already", flush=True)
    progress = Progress(wanted)

    def one(run):
        run.run()
        progress.ended(run)

    with concurrent.futures.ThreadPoolExecutor(jobs) as pool:
        ends = [pool.submit(one, run) for run in wanted]
        try:
            for end in concurrent.futures.as_completed(ends):
                end.result()
        except BaseException as error:
            pool.shutdown(cancel_futures=True)
            if isinstance(error, RuntimeError):
                sys.exit(f"{pathlib.Path(sys.argv[0]).name}: {error}")
            raise
