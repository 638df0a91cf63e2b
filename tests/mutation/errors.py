#!/usr/bin/env python3
# SPDX-License-Identifier: MIT
"""Lists every call that raises an error, and whether a test makes it do so.

    errors.py run [-j N] [SOURCE...]  compiles and runs test sources with --coverage, by default all
                                      that run without --all; those that were run and have not
                                      changed are skipped, so that it can be stopped and resumed
    errors.py list [FILE]             the calls, from these runs; fails unless each was reached or
                                      has an answer in answers.md; also writes the table into FILE
    errors.py branches                branch coverage of each header by gcovr, if it is installed
    errors.py --self-test

Options of run: -j N, so many at a time; --compiler COMMAND, by default g++. Of all commands:
--scratch FOLDER, by default build/mutation.

Calls are throw, fail(), and functions whose names begin with fail_ or require_. The runs use a copy
of the headers in which each call that is a statement stands between two empty asm statements. If
the line of the first one was executed more often than that of the second one, the call has raised
an error. Of a call inside an expression only whether it was executed is known.
"""

import argparse
import collections
import concurrent.futures
import pathlib
import shutil
import signal
import subprocess
import sys

from coverage import MARK, Coverage, instrumented
from mutate import ANSWERS, REPOSITORY
from processes import Runner, Stopped
from programs import HASHES
from results import read_answers


def state_of(call, counts):
    lines = counts.get(call.header, {})
    executed = lines.get(call.before, 0)
    if not executed:
        return "not executed" if call.before in lines else "not compiled"
    if call.after and lines.get(call.after, 0) >= executed:
        return "never failed"
    return "reached"


def listing(calls, counts, answers):
    """A table of all calls, and whether each was reached or has an answer."""
    states = [(call, state_of(call, counts)) for call in calls]
    count = collections.Counter(state for _, state in states)
    open_ones = [call for call, state in states if state != "reached" and call.key not in answers]
    others = len(calls) - count["reached"] - len(open_ones)
    lines = ["# Calls that raise errors", "",
             f"Made by `tests/mutation/errors.py list`. Of {len(calls)} calls, {count['reached']} "
             f"were reached by a test, {others} others have an answer, {len(open_ones)} have none.",
             "", "| call | state | key |", "|---|---|---|"]
    for call, state in states:
        shown = call.text.replace("|", "\\|")
        answer = answers.get(call.key) if state != "reached" else None
        note = f"{state}: {answer}" if answer else state
        lines.append(f"| {call.header}:{call.line} `{shown}` | {note} | `{call.key}` |")
    return "\n".join(lines) + "\n", not open_ones


def run_tests(arguments):
    runner, coverage = Runner(), Coverage(arguments.scratch)
    for number in (signal.SIGINT, signal.SIGTERM):
        signal.signal(number, lambda *_: runner.stop())
    tree = coverage.copy(REPOSITORY)
    sources = arguments.sources or [each for each in tree.test_sources() if each != HASHES]
    with concurrent.futures.ThreadPoolExecutor(arguments.j) as pool:
        futures = [pool.submit(coverage.run, tree, source, arguments.compiler, runner)
                   for source in sources]
        try:
            for future in futures:
                print(future.result(), flush=True)
        except Stopped:
            print("stopped; run it again to resume", flush=True)
        except BaseException:
            runner.stop()
            raise


def show_branches(coverage):
    if not shutil.which("gcovr"):
        sys.exit("gcovr is not installed (Debian: gcovr)")
    subprocess.run(["gcovr", "--root", coverage.tree_folder, "--filter",
                    f"{coverage.tree_folder}/include/silt/", "--branches",
                    "--exclude-throw-branches", "--exclude-unreachable-branches",
                    coverage.folder / "programs"], check=True)


def self_test():
    text = """void f(int x) {
  if (x < 0) fail("x is negative");
  require_positive("x", x);
  const int y = x > 3 ? throw 1 : 2;
  try {
  } catch (...) {
    throw;
  }
}
inline void require_even(int x);
"""
    made, calls = instrumented("core/a.hpp", text)
    assert [(call.line, call.text) for call in calls] == [
        (2, 'fail("x is negative")'), (3, 'require_positive("x", x)'), (4, "throw 1 : 2;")], calls
    fail, require, throw = calls
    rows = made.splitlines()

    def line_after(number):
        return rows[rows.index(f"#line {number}") + 1]

    assert line_after(fail.before) == MARK and line_after(2) == 'fail("x is negative");', made
    assert line_after(require.before) == line_after(require.after) == MARK, made
    assert line_after(throw.before) == "throw" and line_after(4) == " 1 : 2;", made
    assert "throw;" in made and len({call.key for call in calls}) == 3
    passed = {"core/a.hpp": {fail.before: 0, require.before: 2, require.after: 2}}
    assert [state_of(call, passed) for call in calls] == [
        "not executed", "never failed", "not compiled"]
    failed = {"core/a.hpp": {fail.before: 1, require.before: 2, require.after: 1, throw.before: 1}}
    assert [state_of(call, failed) for call in calls] == 3 * ["reached"]
    assert listing(calls, failed, {})[1] and not listing(calls, passed, {})[1]
    assert listing(calls, passed, {call.key: "cannot happen" for call in calls})[1]


def main(arguments):
    if arguments == ["--self-test"]:
        self_test()
        return
    parser = argparse.ArgumentParser(description=__doc__,
                                     formatter_class=argparse.RawDescriptionHelpFormatter)
    commands = parser.add_subparsers(dest="command", required=True)
    for name in ("run", "list", "branches"):
        command = commands.add_parser(name)
        command.add_argument("--scratch", type=pathlib.Path, default=REPOSITORY / "build/mutation")
        if name == "run":
            command.add_argument("-j", type=int, default=1)
            command.add_argument("--compiler", default="g++")
            command.add_argument("sources", nargs="*", metavar="SOURCE")
        if name == "list":
            command.add_argument("file", nargs="?", type=pathlib.Path)
    arguments = parser.parse_args(arguments)
    arguments.scratch = arguments.scratch.resolve()
    coverage = Coverage(arguments.scratch)
    if arguments.command == "run":
        run_tests(arguments)
    elif arguments.command == "branches":
        show_branches(coverage)
    else:
        text, complete = listing(coverage.calls(), coverage.counts(), read_answers(ANSWERS))
        print(text)
        if arguments.file:
            arguments.file.write_text(text, encoding="utf-8")
        sys.exit(0 if complete else 1)


if __name__ == "__main__":
    main(sys.argv[1:])
