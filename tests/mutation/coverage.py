# SPDX-License-Identifier: MIT
"""Which lines of the headers each test executes, by gcov, and which calls raise an error.

The tests are compiled with a copy of the headers in which each call that raises errors stands
between two empty asm statements, with numbers of lines of their own; all other lines keep their
numbers."""

import collections
import dataclasses
import hashlib
import json
import re
import shutil
import subprocess

from cpp_source import Source
from programs import Tree, Workshop, copy_of
from results import one_line

RAISES = re.compile(r"(fail|fail_\w+|require_\w+)$")
MARK = 'asm volatile("");'
FLAGS = ["--coverage", "-fprofile-update=atomic"]
SECONDS = 1800  # of a test
FIRST_MARK = 5000  # no header is so long
STATEMENT = 8  # gcov has one line of a statement of so many lines


@dataclasses.dataclass
class Call:
    header: str  # below include/silt/
    line: int
    text: str
    key: str
    before: int  # number of the line that is executed before the call
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

    def line_at(position):
        return text.count("\n", 0, position) + 1

    for index, token in enumerate(source.tokens):
        if not _is_raise(source, index) or token.begin < begin:
            continue
        before = FIRST_MARK + 2 * len(calls)
        never_returns = token.text == "throw" or token.text.startswith("fail")
        if statement := starts.get(index):
            first = source.tokens[statement.first].begin
            end = source.tokens[statement.last].end
            after = 0 if never_returns else before + 1
            marked = (f"{{\n#line {before}\n{MARK}\n#line {line_at(first)}\n{text[first:end]}\n"
                      f"#line {before + 1}\n{MARK}\n#line {line_at(end)}\n}}")
        else:
            first, end, after = token.begin, token.end, 0
            marked = f"\n#line {before}\n{text[first:end]}\n#line {line_at(end)}\n"
        pieces += [text[begin:first], marked]
        begin = end
        shown, row = _shown(source, index), rows[token.line - 1].strip()
        name = f"{header}\n{row}\n{seen[row]}\n{shown}"
        seen[row] += 1
        calls.append(Call(header, token.line, shown, hashlib.sha256(name.encode()).hexdigest()[:12],
                          before, after))
    return "".join([*pieces, text[begin:]]), calls


def _shown(source, index):
    """The beginning of the call, for people."""
    last = index + 1
    while last < len(source.tokens) - 1 and source.tokens[last].text not in ("(", ";"):
        last += 1
    last = source.partner.get(last, last)
    text = one_line(source.text[source.tokens[index].begin: source.tokens[last].end])
    return text if len(text) < 90 else text[:87] + "..."


def _hash(text):
    return hashlib.sha256(text.encode()).hexdigest()[:16]


class Coverage:
    """The instrumented copy of the headers, and the runs of the tests with it."""

    def __init__(self, scratch):
        self.folder = scratch / "coverage"
        self.tree_folder = self.folder / "tree"
        self.calls_file = self.folder / "calls.json"
        self.hashes_file = self.folder / "hashes.json"
        self._runs = None

    def copy(self, repository):
        """Copies the repository and instruments its headers."""
        tree = copy_of(repository, self.tree_folder)
        silt, calls, hashes = tree.include / "silt", [], {}
        for header in tree.headers([""]):
            path = silt / header
            original = path.read_text(encoding="utf-8")
            text, found = instrumented(header, original)
            path.write_text(text, encoding="utf-8")
            calls += map(dataclasses.asdict, found)
            hashes[header] = _hash(original)
        self.calls_file.write_text(json.dumps(calls, indent=1), encoding="utf-8")
        self.hashes_file.write_text(json.dumps(hashes, indent=1), encoding="utf-8")
        return tree

    def calls(self):
        return [Call(**call) for call in json.loads(self.calls_file.read_text(encoding="utf-8"))]

    def _program_folder(self, source):
        return self.folder / "programs" / source.replace("/", "_").removesuffix(".cpp")

    def _was_run(self, tree, source):
        stamp = self._program_folder(source) / "hash.txt"
        return stamp.is_file() and stamp.read_text(encoding="utf-8") == tree.hash_of(source)

    def run(self, tree, source, compiler, runner):
        """Compiles and runs a test, unless this was done; returns a text about it."""
        folder = self._program_folder(source)
        if self._was_run(tree, source):
            return f"{source}: has not changed"
        shutil.rmtree(folder, ignore_errors=True)
        workshop = Workshop(tree, folder, compiler, runner, flags=FLAGS, precompile=False)
        ran = workshop.compile(source, SECONDS)
        if ran.status != "passed":
            return f"{source}: does not compile\n{ran.output[-2000:]}"
        ran = workshop.run(source, SECONDS)
        (folder / "program").unlink()
        (folder / "lines.json").write_text(json.dumps(self._read_lines(folder)), encoding="utf-8")
        (folder / "hash.txt").write_text(tree.hash_of(source), encoding="utf-8")
        return f"{source}: {ran.status} ({ran.seconds:.0f} s)"

    def _read_lines(self, folder):
        """How often each line of each header was executed; lines that were compiled but not
        executed have 0."""
        lines = collections.defaultdict(collections.Counter)
        silt = f"{self.tree_folder}/include/silt/"
        for data in sorted(folder.glob("*.gcda")):
            made = subprocess.run(["gcov", "--json-format", "--stdout", data.name], text=True,
                                  cwd=folder, capture_output=True, check=True)
            for file in json.loads(made.stdout)["files"]:
                if file["file"].startswith(silt):
                    for line in file["lines"]:
                        name = file["file"].removeprefix(silt)
                        lines[name][str(line["line_number"])] += line["count"]
        return lines

    def runs(self):
        """For each test that was run with the present copy, the lines of each header."""
        if self._runs is None:
            tree = Tree(self.tree_folder) if self.calls_file.is_file() else None
            self._runs = {
                source: json.loads((self._program_folder(source) / "lines.json")
                                   .read_text(encoding="utf-8"))
                for source in (tree.test_sources() if tree else [])
                if self._was_run(tree, source)}
        return self._runs

    def counts(self):
        """How often each line of each header was executed by all tests."""
        total = collections.defaultdict(collections.Counter)
        for headers in self.runs().values():
            for header, lines in headers.items():
                for line, count in lines.items():
                    total[header][int(line)] += count
        return total

    def executed_lines(self, header):
        """A function of a test source: how many lines of the header it executed when it was last
        run, perhaps with an earlier version of the header."""
        counts = {source: sum(count > 0 for count in headers.get(header, {}).values())
                  for source, headers in self.runs().items()}
        return lambda source: counts.get(source, 0)

    def executing(self, header, text, line):
        """A function of a test source: whether it executes this line of a header with this text;
        None if that is unknown, as for a line without instructions in any test."""
        hashes = (json.loads(self.hashes_file.read_text(encoding="utf-8"))
                  if self.hashes_file.is_file() else {})
        is_known = hashes.get(header) == _hash(text)
        counts = {source: _count_near(headers.get(header, {}), line)
                  for source, headers in self.runs().items()} if is_known else {}
        if all(count is None for count in counts.values()):
            return lambda source: None
        return lambda source: bool(counts[source]) if source in counts else None


def _count_near(lines, line):
    """How often the statement with this line was executed; None if it has no instructions."""
    for near in range(line, line - STATEMENT, -1):
        if str(near) in lines:
            return lines[str(near)]
    return None
