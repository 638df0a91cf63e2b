#!/usr/bin/env python3
# SPDX-License-Identifier: MIT
"""Stops and resumes an example at random steps, and compares its files with those of an
uninterrupted run.

    resume.py SCRATCH STOPS PROGRAM ARGUMENTS...

STOPS is how often in all, in as many runs as necessary: a run may end before it is stopped. Of a
program that takes seconds until its first step, fewer, and at least twelve. The program must have --out, --resume and --checkpoint-every. It is stopped by SIGINT, like by Ctrl-C,
and killed by SIGKILL, in turns. At least a quarter of all must be orderly, with the
exit code of SIGINT. In summary.json, wall-clock times are ignored.
"""

import pathlib
import random
import shutil
import signal
import subprocess
import sys
import time

sys.path.insert(0, str(pathlib.Path(__file__).resolve().parent.parent / "same_bits"))
from check import differences, files_in

def last_checkpoint(folder):
    """When the last checkpoint in a folder was written [ns]; 0 if there is none."""
    times = [0]
    for path in folder.glob("checkpoint*.silt"):
        try:
            times.append(path.stat().st_mtime_ns)
        except FileNotFoundError:  # removed at the end of the run
            pass
    return max(times)


def wait_for_checkpoint(process, folder, before):
    """Until a checkpoint is written that is newer than `before`, or the process ends."""
    while process.poll() is None and last_checkpoint(folder) <= before:
        time.sleep(0.005)


def run_uninterrupted(program, arguments, folder):
    """Returns the duration [s], and that until the first checkpoint, which is soon after the first
    step [s]."""
    begin = time.monotonic()
    process = subprocess.Popen([program, *arguments, "--out", str(folder)], stdout=subprocess.DEVNULL,
                               stderr=subprocess.DEVNULL)
    wait_for_checkpoint(process, folder, 0)
    prepared = time.monotonic() - begin
    assert process.wait() == 0, f"{program} ended with {process.returncode}"
    return time.monotonic() - begin, prepared


def run_for(command, seconds, how, folder):
    """Runs a program, sends it a signal some seconds after its first checkpoint, and returns its exit
    code and the last line of its stderr."""
    before = last_checkpoint(folder)
    process = subprocess.Popen(command, stdout=subprocess.DEVNULL, stderr=subprocess.PIPE, text=True)
    try:
        if seconds is not None:
            wait_for_checkpoint(process, folder, before)
        said = process.communicate(timeout=seconds)[1]
    except subprocess.TimeoutExpired:
        process.send_signal(how)
        said = process.communicate()[1]
    return process.returncode, (said.strip().splitlines() or [""])[-1]


def run_in_parts(program, arguments, folder, durations, most):
    """Returns how many times it was stopped and killed, after the time that the next of `durations`
    gives, at most so many times."""
    new = [program, *arguments, "--out", str(folder)]
    resumed = [program, "--resume", str(folder)]
    command, stops, kills = new, 0, 0
    while True:
        how = signal.SIGKILL if stops > kills else signal.SIGINT
        patience = next(durations) if stops + kills < most else None
        code, said = run_for(command, patience, how, folder)
        # It may have been killed after it had written everything.
        if code == 0 or (kills > 0 and said.endswith("is complete")):
            return stops, kills
        if code == 128 + signal.SIGINT:
            assert said.endswith(f"{program} --resume {folder}"), said
            assert not (folder / "summary.json").exists(), "a stopped run must not have a summary"
            stops += 1
        elif code in (-signal.SIGKILL, -signal.SIGINT):  # SIGINT before the handler was installed
            kills += 1
        else:
            sys.exit(f"{' '.join(command)} ended with {code}: {said}")
        if list(folder.glob("checkpoint*.silt")):
            command = resumed
            # As if it had been killed while it wrote that of an earlier stage.
            (folder / "checkpoint_of_a_stage.silt.computer.1-1.part").touch()


def durations(mean):
    """Random ones [s]."""
    numbers = random.Random(1)
    while True:
        yield numbers.uniform(0, 2 * mean)


def main(arguments):
    if len(arguments) < 3:
        sys.exit(__doc__)
    scratch, wanted, program = pathlib.Path(arguments[0]), int(arguments[1]), arguments[2]
    arguments = [*arguments[3:], "--checkpoint-every", "0.01"]
    shutil.rmtree(scratch, ignore_errors=True)
    whole, part = scratch / "whole", scratch / "part"
    seconds, prepared = run_uninterrupted(program, arguments, whole)
    wanted = min(wanted, max(12, round(100 / prepared)))
    waits = durations(max(0.05, (seconds - prepared) / wanted))
    runs, stops, kills, different = 0, 0, 0, []
    while stops + kills < wanted and not different:
        if runs > 20 and runs > 4 * (stops + kills):
            sys.exit("more than three of four runs ended before they could be stopped; make them longer")
        shutil.rmtree(part, ignore_errors=True)
        more = run_in_parts(program, arguments, part, waits, wanted - stops - kills)
        runs, stops, kills = runs + 1, stops + more[0], kills + more[1]
        different = differences(whole, part)
    print(f"{len(files_in(whole))} files of {program}, stopped {stops} times and killed {kills} times in {runs} runs")
    for name in different:
        print(f"{name} differs from that of an uninterrupted run")
    # A program without a handler dies of every SIGINT.
    if not different and 4 * stops < stops + kills:
        sys.exit(f"only {stops} of {stops + kills} stops were orderly, less than a quarter; does {program} handle SIGINT?")
    ended = subprocess.run([program, "--resume", str(part)], capture_output=True, text=True)
    assert ended.returncode == 2 and "is complete" in ended.stderr, "resuming a complete run must be rejected"
    other = subprocess.run([program, "--resume", str(part), *arguments], capture_output=True, text=True)
    assert other.returncode == 2 and "cannot be given with --resume" in other.stderr, other.stderr
    sys.exit(1 if different else 0)


if __name__ == "__main__":
    main(sys.argv[1:])
