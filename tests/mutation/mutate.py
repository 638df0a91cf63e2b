#!/usr/bin/env python3
# SPDX-License-Identifier: MIT
"""Puts random small faults (mutants) into headers of the library, one at a time, and counts those
that the tests notice.

    mutate.py run [-j N] [--count 200]  tries mutants until so many have compiled, and appends a
                                        line for each to results.csv. Those that are there are not
                                        tried again: it can be stopped at any time, and resumed
    mutate.py report                    the share of killed mutants per folder, and the survivors
                                        with their answers; fails unless promise 14 is kept
    mutate.py again [KEY...]            tries survivors again, after a test was added; by default
                                        all
    mutate.py try KEY...                tries any mutants, and records nothing
    mutate.py list [HEADER[:LINE]]      the mutants of a header or line; by default those that `run`
                                        chooses
    mutate.py show KEY...               mutants as differences
    mutate.py --self-test

Options of run, again and try: -j N, so many at a time; --seconds S, the processor time that a
mutant has, by default 300; --compiler COMMAND, by default g++; --scratch FOLDER, by default
build/mutation. Of again and try: --first SOURCE, a test source that is tried before the others,
whatever lines it executes. Of run and list: --count, and --seed, which determines the choice.

A mutant is a change of one line of core/, search/, dem/, mps/, solve/, integrate/ or io/: a sign, a
relation, an arithmetic or logical operator, a negated condition, a constant, a deleted statement,
min and max, exchanged arguments, true and false, or an early return that is left out. Lines are
chosen at random, then one of the mutants of each line; the choice in a line does not change if
other lines do.

A mutant is in a copy of the tree. If a member of a part with state is then missing in checkpoints,
as tests/restart_members/check.py finds, it is killed. Else the test sources that include its
header, directly or not, are compiled and run, the nearest first (see tests_of in programs.py),
until one fails or crashes, twice, or hangs or takes too long, or the mutant's time is up: then it
has survived. A source that also fails without the mutant is not used. A mutant that does not
compile is not counted. After `errors.py run`, tests that do not execute the line of the mutant are
left out.

answers.md says of each survivor why it is equivalent, or what is done about it.
"""

import argparse
import concurrent.futures
import difflib
import fcntl
import json
import pathlib
import signal
import subprocess
import sys
import threading

import mutants as generator
from coverage import Coverage
from processes import Runner, Stopped, cause_of
from programs import MEMBERS, NOT_TESTED, Tree, Workshop, copy_of
from results import KILLED, NOT_COMPILED, SURVIVED, Results, one_line, read_answers, report

HERE = pathlib.Path(__file__).resolve().parent
REPOSITORY = HERE.parents[1]
FOLDERS = ("core", "search", "dem", "mps", "solve", "integrate", "io")
RESULTS, ANSWERS = HERE / "results.csv", HERE / "answers.md"
LEAST = 5  # no test is begun with less time than this [s]
SLOWER = 3  # a test that takes so many times longer than without the mutant is too slow


def commit_of(repository):
    """The commit, with a + if files were changed since."""
    def git(*arguments):
        return subprocess.run(["git", "-C", repository, *arguments], capture_output=True, text=True,
                              check=False).stdout.strip()
    changed = git("status", "--porcelain", "--", "include", "tests", "examples",
                  ":!tests/mutation")
    return git("rev-parse", "--short", "HEAD") + ("+" if changed else "")


def all_mutants(tree):
    found = []
    for header in tree.headers(FOLDERS):
        if header not in NOT_TESTED:
            text = (tree.include / "silt" / header).read_text(encoding="utf-8")
            found += generator.mutants_of(header, text)
    return found


def described(mutant):
    return (f"{mutant.key} {mutant.header}:{mutant.line}:{mutant.column} {mutant.operator}: "
            f"{one_line(mutant.old) or 'nothing'} → {one_line(mutant.new) or 'nothing'}")


def difference(tree, mutant):
    text = (tree.include / "silt" / mutant.header).read_text(encoding="utf-8")
    return "".join(difflib.unified_diff(
        text.splitlines(keepends=True), mutant.apply(text).splitlines(keepends=True),
        mutant.header, f"{mutant.header} with {mutant.key}"))


class Baselines:
    """Whether test sources pass without a mutant, and how long they run [s]; kept in a file."""

    def __init__(self, path, tree):
        self.path, self.tree, self.lock = path, tree, threading.Lock()
        self.known = json.loads(path.read_text(encoding="utf-8")) if path.is_file() else {}

    def seconds(self, source, workshop, limit):
        """Processor time of the test; None if it does not pass."""
        name = f"{source} {self.tree.hash_of(source)}"
        with self.lock:
            if name not in self.known:
                ran = workshop.compile(source, limit)
                if ran.status == "passed":
                    ran = workshop.run(source, limit)
                self.known[name] = ran.seconds if ran.status == "passed" else None
                if ran.status != "passed":
                    print(f"{source} is not used, as it fails without a mutant: {cause_of(ran)}\n"
                          f"{ran.output[-2000:]}", flush=True)
                new = self.path.with_suffix(".new")
                new.write_text(json.dumps(self.known, indent=1), encoding="utf-8")
                new.replace(self.path)
            return self.known[name]


class Campaign:
    def __init__(self, arguments, tree, results, runner):
        self.tree, self.results, self.limit = tree, results, arguments.seconds
        self.first = getattr(arguments, "first", ())
        self.runner = runner
        self.coverage = Coverage(arguments.scratch)
        self.baselines = Baselines(arguments.scratch / "baselines.json", tree)
        self.idle = [Workshop(tree, arguments.scratch / f"workshop_{n}", arguments.compiler, runner)
                     for n in range(arguments.j)]

    def try_mutant(self, mutant):
        """Result, by what, and processor time."""
        workshop = self.idle.pop()
        try:
            return self._try(mutant, workshop)
        finally:
            workshop.take_away(mutant.header)
            self.idle.append(workshop)

    def _try(self, mutant, workshop):
        text = (self.tree.include / "silt" / mutant.header).read_text(encoding="utf-8")
        used, passed, checked = 0, [], False
        executes = self.coverage.executing(mutant.header, text, mutant.line)
        sources = self.tree.tests_of(mutant.header, self.results.kills(mutant.header),
                                     self.coverage.executed_lines(mutant.header))
        for source in sorted(sources, key=lambda each: each not in self.first):
            if executes(source) is False and source not in self.first:
                continue
            if self.limit - used < LEAST:
                break
            workshop.put(mutant.header, mutant.apply(text))
            ran, result = workshop.compile(source, self.limit - used), NOT_COMPILED
            used += ran.seconds
            if ran.status == "passed" and not checked:
                checked = True
                members = workshop.check_members(self.limit - used)
                used += members.seconds
                folder = f"{workshop.include}/silt/"
                if members.status == "failed" and folder in members.output:
                    found = members.output.split(folder)[-1].splitlines()[0]
                    return KILLED, f"{MEMBERS}: {found}", used
            if ran.status == "passed":
                given = self.limit - used
                ran, result = workshop.run(source, given), KILLED
                used += ran.seconds
                if ran.status == "failed":  # not by chance
                    ran = workshop.run(source, given)
            if ran.status == "passed":
                passed.append(source)
                continue
            if result == NOT_COMPILED and ran.status == "stopped":
                break
            workshop.take_away(mutant.header)
            baseline = self.baselines.seconds(source, workshop, self.limit)
            if baseline is None:
                continue
            if result == NOT_COMPILED:
                return result, "", used
            if ran.status == "failed" or SLOWER * baseline < given:
                return result, f"{source}: {cause_of(ran)}", used
            break
        return SURVIVED, " ".join(passed) or "no test", used


def in_parallel(campaign, chosen, finished):
    """Tries mutants, and calls finished(mutant, result, by, seconds) for each."""
    at_a_time = len(campaign.idle)
    with concurrent.futures.ThreadPoolExecutor(at_a_time) as pool:
        waiting, source = {}, iter(chosen)
        try:
            while True:
                while len(waiting) < at_a_time and (mutant := next(source, None)):
                    waiting[pool.submit(campaign.try_mutant, mutant)] = mutant
                if not waiting:
                    return
                done, _ = concurrent.futures.wait(
                    waiting, return_when=concurrent.futures.FIRST_COMPLETED)
                for future in done:
                    finished(waiting.pop(future), *future.result())
        except Stopped:
            print("stopped; run it again to resume", flush=True)
        except BaseException:
            campaign.runner.stop()
            raise


def still_to_try(chosen, results, count):
    """Those mutants without a result, until enough have one."""
    for mutant in chosen:
        if len(results.having(KILLED, SURVIVED)) >= count:
            return
        if mutant.key not in results.rows:
            yield mutant


def with_keys(mutants, keys):
    by_key = {mutant.key: mutant for mutant in mutants}
    for key in keys:
        if key not in by_key:
            print(f"{key} is no mutant of the present headers: its line has changed")
    return [by_key[key] for key in keys if key in by_key]


def try_all(arguments):
    """The commands run, again and try."""
    arguments.scratch.mkdir(parents=True, exist_ok=True)
    lock = (arguments.scratch / "lock").open("w", encoding="utf-8")
    try:
        fcntl.flock(lock, fcntl.LOCK_EX | fcntl.LOCK_NB)
    except BlockingIOError:
        sys.exit(f"another campaign is running in {arguments.scratch}")
    runner = Runner()
    for number in (signal.SIGINT, signal.SIGTERM):
        signal.signal(number, lambda *_: runner.stop())

    for source in getattr(arguments, "first", ()):
        if not (REPOSITORY / source).is_file():
            sys.exit(f"{source} is no test source")
    tree, commit = copy_of(REPOSITORY, arguments.scratch / "tree"), commit_of(REPOSITORY)
    results = Results(RESULTS)
    campaign = Campaign(arguments, tree, results, runner)
    members = campaign.idle[0].check_members(600)
    if members.status != "passed":
        sys.exit(f"{MEMBERS} fails without a mutant:\n{members.output}")
    mutants = all_mutants(tree)
    if arguments.command == "run":
        chosen = still_to_try(generator.in_random_order(mutants, arguments.seed), results,
                              arguments.count)
    else:
        survivors = [row["key"] for row in results.having(SURVIVED)]
        chosen = with_keys(mutants, arguments.keys or survivors)

    def finished(mutant, result, by, seconds):
        print(f"{described(mutant)}\n  {result} {by} ({seconds:.0f} s)", flush=True)
        if arguments.command != "try":
            results.add(mutant, result, by, seconds, commit)

    in_parallel(campaign, chosen, finished)


def list_mutants(arguments):
    tree = Tree(REPOSITORY)
    mutants = all_mutants(tree)
    if arguments.where:
        header, _, line = arguments.where.partition(":")
        chosen = [each for each in mutants
                  if each.header == header and line in ("", str(each.line))]
    else:
        chosen = generator.in_random_order(mutants, arguments.seed)[: arguments.count]
    for mutant in chosen:
        print(described(mutant))


def parsed(arguments):
    parser = argparse.ArgumentParser(description=__doc__,
                                     formatter_class=argparse.RawDescriptionHelpFormatter)
    commands = parser.add_subparsers(dest="command", required=True)
    for name in ("run", "again", "try", "list", "show", "report"):
        command = commands.add_parser(name)
        if name in ("again", "try", "show"):
            command.add_argument("keys", nargs="*" if name == "again" else "+", metavar="KEY")
        if name in ("again", "try"):
            command.add_argument("--first", action="append", default=[], metavar="SOURCE")
        if name in ("run", "again", "try"):
            command.add_argument("-j", type=int, default=1)
            command.add_argument("--seconds", type=float, default=300)
            command.add_argument("--compiler", default="g++")
            command.add_argument("--scratch", type=pathlib.Path,
                                 default=REPOSITORY / "build/mutation")
        if name in ("run", "list"):
            command.add_argument("--count", type=int, default=200)
            command.add_argument("--seed", type=int, default=1)
        if name == "list":
            command.add_argument("where", nargs="?", metavar="HEADER[:LINE]")
    return parser.parse_args(arguments)


def main(arguments):
    if arguments == ["--self-test"]:
        import self_test
        self_test.run()
        return
    arguments = parsed(arguments)
    if arguments.command == "report":
        text, kept = report(Results(RESULTS), read_answers(ANSWERS))
        print(text)
        sys.exit(0 if kept else 1)
    if arguments.command == "list":
        list_mutants(arguments)
    elif arguments.command == "show":
        tree = Tree(REPOSITORY)
        for mutant in with_keys(all_mutants(tree), arguments.keys):
            print(difference(tree, mutant))
    else:
        arguments.scratch = arguments.scratch.resolve()
        try_all(arguments)


if __name__ == "__main__":
    main(sys.argv[1:])
