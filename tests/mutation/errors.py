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
import dataclasses
import hashlib
import json
import pathlib
import re
import shutil
import signal
import subprocess
import sys

from cpp_source import Source
from mutate import ANSWERS, REPOSITORY, copy_of
from programs import HASHES, Runner, Stopped, Tree, Workshop
from results import one_line, read_answers

RAISES = re.compile(r"(fail|fail_\w+|require_\w+)$")
MARK = 'asm volatile("");'
FLAGS = ["--coverage", "-fprofile-update=atomic"]
SECONDS = 1800  # of a test


@dataclasses.dataclass
class Call:
    header: str  # below include/silt/
    line: int
    text: str
    key: str
    before: int  # line of the copy that is executed before the call
    after: int  # and after it; 0 if it is part of an expression or never returns


def _is_raise(source, index):
    token = source.tokens[index]
    if not source.body[index] or token.kind != "name":
        return False
    if token.text == "throw":
        return source.words(index + 1) != [";"]
    if not RAISES.match(token.text) or source.words(index + 1) != ["("]:
        return False
    before = source.tokens[index - 1]
    return before.kind != "name" or before.text in ("return", "else", "do")


def instrumented(header, text):
    """The header with marks around its calls, and the calls."""
    source = Source(text)
    starts = {}  # first token of a statement, after its qualifiers → the statement
    for statement in source.statements:
        at = statement.first
        while source.words(at + 1) in (["::"], ["->"], ["."]):
            at += 2
        starts[at] = statement
    pieces, calls, begin, seen = [], [], 0, collections.Counter()
    rows = text.splitlines()

    def lines():
        return sum(piece.count("\n") for piece in pieces) + 1

    for index, token in enumerate(source.tokens):
        if not _is_raise(source, index) or token.begin < begin:
            continue
        statement = starts.get(index)
        first = source.tokens[statement.first].begin if statement else token.begin
        end = source.tokens[statement.last].end if statement else token.end
        shown = _shown(source, index)
        row = rows[token.line - 1].strip()
        key = hashlib.sha256(f"{header}\n{row}\n{seen[row]}\n{shown}".encode()).hexdigest()[:12]
        seen[row] += 1
        pieces.append(text[begin:first])
        if statement:
            pieces.append(f"{{\n{MARK}\n")
            before = lines() - 1
            pieces.append(text[first:end] + "\n")
            after = 0 if token.text == "throw" or token.text.startswith("fail") else lines()
            pieces.append(f"{MARK}\n}}")
        else:
            pieces.append("\n")
            before, after = lines(), 0
            pieces.append(text[first:end])
        calls.append(Call(header, token.line, shown, key, before, after))
        begin = end
    pieces.append(text[begin:])
    return "".join(pieces), calls


def _shown(source, index):
    """The beginning of the call, for people."""
    last = index + 1
    while last < len(source.tokens) - 1 and source.tokens[last].text not in ("(", ";"):
        last += 1
    last = source.partner.get(last, last)
    text = one_line(source.text[source.tokens[index].begin: source.tokens[last].end])
    return text if len(text) < 90 else text[:87] + "..."


class Coverage:
    """The instrumented copy of the headers, and the runs of the tests with it."""

    def __init__(self, scratch):
        self.folder = scratch / "coverage"
        self.tree_folder = self.folder / "tree"
        self.calls_file = self.folder / "calls.json"

    def copy(self):
        """Copies the repository and instruments its headers."""
        tree = copy_of(REPOSITORY, self.tree_folder)
        silt, calls = tree.include / "silt", []
        for header in tree.headers([""]):
            path = silt / header
            text, found = instrumented(header, path.read_text(encoding="utf-8"))
            path.write_text(text, encoding="utf-8")
            calls += map(dataclasses.asdict, found)
        self.calls_file.write_text(json.dumps(calls, indent=1), encoding="utf-8")
        return tree

    def calls(self):
        return [Call(**call) for call in json.loads(self.calls_file.read_text(encoding="utf-8"))]

    def program_folder(self, source):
        return self.folder / "programs" / source.replace("/", "_").removesuffix(".cpp")

    def was_run(self, tree, source):
        stamp = self.program_folder(source) / "hash.txt"
        return stamp.is_file() and stamp.read_text(encoding="utf-8") == tree.hash_of(source)

    def run(self, tree, source, compiler, runner):
        """Compiles and runs a test, unless this was done; returns a text about it."""
        folder = self.program_folder(source)
        if self.was_run(tree, source):
            return f"{source}: has not changed"
        shutil.rmtree(folder, ignore_errors=True)
        workshop = Workshop(tree, folder, compiler, runner, flags=FLAGS, precompile=False)
        ran = workshop.compile(source, SECONDS)
        if ran.status != "passed":
            return f"{source}: does not compile\n{ran.output[-2000:]}"
        ran = workshop.run(source, SECONDS)
        (folder / "program").unlink()
        (folder / "hash.txt").write_text(tree.hash_of(source), encoding="utf-8")
        return f"{source}: {ran.status} ({ran.seconds:.0f} s)"

    def counts(self):
        """How often each line of each instrumented header was executed by the tests that were run
        with the present headers; lines that were compiled but not executed have 0."""
        total = collections.defaultdict(collections.Counter)
        tree, silt = Tree(self.tree_folder), f"{self.tree_folder}/include/silt/"
        for source in tree.test_sources():
            folder = self.program_folder(source)
            for data in sorted(folder.glob("*.gcda")) if self.was_run(tree, source) else []:
                made = subprocess.run(["gcov", "--json-format", "--stdout", data.name], text=True,
                                      cwd=folder, capture_output=True, check=True)
                for text in made.stdout.splitlines():
                    for file in json.loads(text)["files"]:
                        if file["file"].startswith(silt):
                            lines = total[file["file"].removeprefix(silt)]
                            for line in file["lines"]:
                                lines[line["line_number"]] += line["count"]
        return total


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
    tree = coverage.copy()
    sources = arguments.sources or [each for each in tree.test_sources() if each != HASHES]
    with concurrent.futures.ThreadPoolExecutor(arguments.j) as pool:
        futures = [pool.submit(coverage.run, tree, source, arguments.compiler, runner)
                   for source in sources]
        try:
            for future in futures:
                print(future.result(), flush=True)
        except Stopped:
            print("stopped; run it again to resume", flush=True)


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
    rows = made.splitlines()
    fail, require, throw = calls
    assert rows[fail.before - 1] == MARK and rows[fail.before] == 'fail("x is negative");', made
    assert rows[require.before - 1] == MARK and rows[require.after - 1] == MARK, made
    assert rows[throw.before - 1].startswith("throw 1"), made
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
