# SPDX-License-Identifier: MIT
"""Tests of the mutation tool that compile nothing."""

import hashlib
import json
import pathlib
import shlex
import sys
import tempfile
import threading

import mutants as generator
from coverage import Coverage
from processes import Ran, Runner, Stopped, cause_of
from programs import MEMBERS, Tree, Workshop
from results import KILLED, NOT_COMPILED, SURVIVED, Results, read_answers, report

HEADER = '''// A comment with 1 + 2 and true.
#pragma once
#include <silt/core/a2.hpp>
static_assert(sizeof(int) >= 4);
template <class T, int Dim = 3>
concept Number = requires(T a) { a + 1; } && Dim > 0;
using Three = std::array<double, 3>;
template <int Dim>
  requires(Dim == 2 || Dim == 3)
double half(const Vec<Dim, 2>& x, int i, int j) {
  if (x[i] < 0) return 0.5;
  fail("half: " + to_text(2 * x[i]) + " < 0");
  shift(i, j);
  const double y = x[j];
  return std::min(-y, y) - 1;
}
'''
EXPECTED = {
    (11, "relation", "<", "<="), (11, "relation", "<", ">="), (11, "constant", "0", "1"),
    (11, "condition", "x[i] < 0", "!(x[i] < 0)"), (11, "return", "return 0.5;", ";"),
    (11, "constant", "0.5", "1.5"), (11, "constant", "0.5", "-0.5"),
    (12, "deletion", 'fail("half: " + to_text(2 * x[i]) + " < 0");', ";"),
    (13, "arguments", "i, j", "j, i"), (13, "deletion", "shift(i, j);", ";"),
    (14, "sign", "x", "-x"),
    (15, "extremum", "min", "max"), (15, "sign", "-", ""), (15, "arithmetic", "-", "+"),
    (15, "constant", "1", "0"), (15, "constant", "1", "2"),
}
# Statements; which of them can be deleted.
STATEMENTS = '''struct A {
  A(int x) : x_{x} { begin(); }
  int size() const { return x_; }
  void run(int n) {
    const int twice = 2;
    for (int k = 0; k < n; ++k) count_ += k;
    const auto add = [&](int k) { count_ = k; };
    for_each(n, [&](int k) {
      values[k] = 0;
    });
    Vec<2> x{};
    double y;
    switch (n) {
      case 1: end(); break;
      default: ++count_;
    }
    if (n > 2) {
      end();
      return;
    } else {
      pair.first = 3;
    }
    return;
  }
  int x_ = 0;
};
'''
DELETED = {"begin();", "count_ += k;", "count_ = k;", "values[k] = 0;", "end();", "++count_;",
           "pair.first = 3;", "for_each(n, [&](int k) {\n      values[k] = 0;\n    });"}


def test_mutants():
    made = generator.mutants_of("core/a.hpp", HEADER)
    found = {(each.line, each.operator, each.old, each.new) for each in made}
    assert found == EXPECTED, found ^ EXPECTED
    for mutant in made:
        changed = mutant.apply(HEADER)
        assert changed != HEADER and len(changed) - len(HEADER) == len(mutant.new) - len(mutant.old)
    made = generator.mutants_of("core/a.hpp", STATEMENTS)
    deleted = {each.old for each in made if each.operator == "deletion"}
    assert deleted == DELETED, deleted ^ DELETED
    assert [each.line for each in made if each.operator == "return"] == [19], made
    assert generator.changed_number("0x1p-26f") == ["0x1p-25f", "0x1p-27f"]
    assert generator.changed_number("1e-14") == ["1e-13", "1e-15"]
    assert generator.changed_number("0u") == ["1u"] and generator.changed_number("2") == ["3", "1"]


def test_choice():
    def keys(text):
        chosen = generator.in_random_order(generator.mutants_of("core/a.hpp", text), 1)
        assert len({mutant.line for mutant in chosen}) == len(chosen)
        return [mutant.key for mutant in chosen]

    assert keys(HEADER) == keys("// one more line\n" + HEADER)
    shorter = keys(HEADER.replace("  shift(i, j);\n", ""))
    assert [key for key in keys(HEADER) if key in shorter] == shorter
    other = generator.in_random_order(generator.mutants_of("core/a.hpp", HEADER), 2)
    assert [mutant.key for mutant in other] != keys(HEADER)


def make_tree(folder):
    folder.mkdir(exist_ok=True)
    for name, text in {
        "CMakeLists.txt": "set(quick_folders core dem)\n",
        "core/a_test.cpp": "#include <silt/all.hpp>\n",
        "core/near_test.cpp": "#include <silt/core/a.hpp>\n",
        "core/mention_test.cpp": "#include <silt/all.hpp>\nhalf(x);\n",
        "core/other_test.cpp": "#include <silt/core/b.hpp>\n",
        "dem/far_test.cpp": "#include <silt/all.hpp>\n",
        "dem/farther_test.cpp": '#include "support/all.hpp"\n',
        "dem/run_slow_test.cpp": "#include <silt/core/a.hpp>\n",
        "support/all.hpp": "#include <silt/all.hpp>\n",
    }.items():
        path = folder / "tests" / name
        path.parent.mkdir(parents=True, exist_ok=True)
        path.write_text(text, encoding="utf-8")
    (folder / "include/silt/core").mkdir(parents=True)
    for name, text in {"core/a.hpp": HEADER, "core/b.hpp": "",
                       "all.hpp": "#include <silt/core/a.hpp>\n"}.items():
        (folder / "include/silt" / name).write_text(text, encoding="utf-8")
    return Tree(folder)


def test_order(folder):
    tree = make_tree(folder)
    assert tree.headers(["core"]) == ["core/a.hpp", "core/b.hpp"]

    def order(kills=lambda source: (0, 0), executed=lambda source: 0):
        return [source.removeprefix("tests/")
                for source in tree.tests_of("core/a.hpp", kills, executed)]

    near = ["core/a_test.cpp", "core/near_test.cpp", "core/mention_test.cpp"]
    assert order() == [*near, "dem/far_test.cpp", "dem/farther_test.cpp"], order()
    assert order(lambda source: (0, source.count("farther"))) == order()
    assert order(lambda source: (source.count("farther"), 0)) == [
        near[0], "dem/farther_test.cpp", *near[1:], "dem/far_test.cpp"]
    assert order(executed=lambda source: source.count("farther"))[1] == "dem/farther_test.cpp"
    before = tree.hash_of("tests/core/near_test.cpp")
    (tree.include / "silt/core/a.hpp").write_text(HEADER + "//", encoding="utf-8")
    assert tree.hash_of("tests/core/near_test.cpp") != before


def test_coverage(folder):
    def executing(text, line):
        return Coverage(folder).executing("core/a.hpp", text, line)

    def write(name, value):
        (folder / "coverage" / name).parent.mkdir(parents=True, exist_ok=True)
        (folder / "coverage" / name).write_text(json.dumps(value), encoding="utf-8")

    assert executing(HEADER, 1)("tests/core/a_test.cpp") is None
    (folder / "coverage").mkdir()
    tree = make_tree(folder / "coverage/tree")
    write("calls.json", [])
    write("hashes.json", {"core/a.hpp": hashlib.sha256(HEADER.encode()).hexdigest()[:16]})
    for source, lines in {"a": {"5": 2}, "near": {"5": 0}, "mention": {}}.items():
        program = f"programs/tests_core_{source}_test"
        write(f"{program}/lines.json", {"core/a.hpp": lines})
        (folder / "coverage" / program / "hash.txt").write_text(
            tree.hash_of(f"tests/core/{source}_test.cpp"), encoding="utf-8")
    lines = Coverage(folder).executed_lines("core/a.hpp")
    assert [lines(f"tests/core/{name}_test.cpp") for name in ("a", "near", "far")] == [1, 0, 0]
    executes = executing(HEADER, 6)
    assert [executes(f"tests/core/{name}_test.cpp") for name in ("a", "near", "mention")] == [
        True, False, False]
    assert executes("tests/dem/far_test.cpp") is None  # was not run
    assert executing(HEADER, 4)("tests/core/a_test.cpp") is None  # no instructions
    assert executing(HEADER + " ", 6)("tests/core/a_test.cpp") is None  # has changed since


def test_results(folder):
    path = folder / "results.csv"
    first, second, third = generator.mutants_of("core/a.hpp", HEADER)[:3]
    results = Results(path)
    results.add(first, KILLED, "tests/core/a_test.cpp: A.B", 12.3, "0123abc")
    results.add(second, SURVIVED, "tests/core/a_test.cpp", 300, "0123abc")
    assert results.kills("core/a.hpp")("tests/core/a_test.cpp") == (1, 1)
    assert results.kills("core/b.hpp")("tests/core/a_test.cpp") == (0, 1)
    with path.open("a", encoding="utf-8") as file:
        file.write("an incompl")  # the machine stopped
    results = Results(path)
    assert list(results.rows) == [first.key, second.key]
    results.add(third, NOT_COMPILED, "", 1, "0123abc")
    assert len(Results(path).rows) == 3 and "incompl" not in path.read_text(encoding="utf-8")

    text, kept = report(results, {})
    assert "| core | 1 | 1 | 1 | 50.0 % |" in text and "without an answer: 1" in text and not kept
    answers = folder / "answers.md"
    answers.write_text(f"# Answers\n\n- `{second.key}`: equivalent, because\n  it is.\n",
                       encoding="utf-8")
    assert read_answers(answers) == {second.key: "equivalent, because it is."}
    assert "without an answer: 0" in report(results, read_answers(answers))[0]
    results.add(second, KILLED, "tests/core/a_test.cpp: A.C", 12.3, "0123abc")  # by a new test
    assert "| core | 2 | 0 | 1 | 100.0 % |" in report(Results(path), {})[0]


def test_runner(folder):
    def python(text, seconds=60, runner=None, idle=None):
        return (runner or Runner()).run([sys.executable, "-c", text], seconds, folder, idle=idle)

    assert python("pass").status == "passed"
    failed = python("print('[  FAILED  ] A.B (1 ms)'); raise SystemExit(1)")
    assert failed.status == "failed" and cause_of(failed) == "A.B"
    killed = python("import os; os.kill(os.getpid(), 11)")
    assert killed.status == "failed" and cause_of(killed) == "signal 11"
    child = python("print('g++: internal compiler error: CPU time limit exceeded signal "
                   "terminated program cc1plus'); raise SystemExit(4)")
    assert child.status == "stopped"
    slow = python("while True: pass", seconds=1)
    assert slow.status == "stopped" and slow.seconds < 3 and cause_of(slow) == "too slow"
    assert cause_of(Ran("failed", 1, "other hashes", 1)) == "other hashes"
    if pathlib.Path("/proc/self/task").is_dir():
        hangs = python("import time; time.sleep(60)", idle=1)
        assert hangs.status == "stopped" and hangs.seconds < 1
    runner = Runner()
    threading.Timer(0.5, runner.stop).start()
    try:
        python("import time; time.sleep(60)", runner=runner)
        raise AssertionError("was not stopped")
    except Stopped:
        pass


def test_compiler(folder):
    tree = make_tree(folder / "tree")

    def compiled(text):
        compiler = f"{sys.executable} -c {shlex.quote(text)}"
        return Workshop(tree, folder / "workshop", compiler, Runner(),
                        precompile=False).compile("tests/core/a_test.cpp", 60)

    assert compiled("pass").status == "passed"
    for error in ("a.hpp:1:2: error: no", "a.hpp:1:2: fatal error: none"):
        assert compiled(f"print('{error}'); raise SystemExit(1)").status == "failed"
    for output in ("", "g++: fatal error: Killed signal terminated program cc1plus"):
        try:
            compiled(f"print('{output}'); raise SystemExit(1)")
        except RuntimeError:
            continue
        raise AssertionError("a compiler that was ended is not noticed")

    check = tree.root / MEMBERS
    check.parent.mkdir()
    check.write_text("import pathlib, sys\n"
                     "path = pathlib.Path(sys.argv[1], 'silt/core/b.hpp')\n"
                     "sys.exit('state_' in path.read_text())\n", encoding="utf-8")
    workshop = Workshop(tree, folder / "workshop", "", Runner(), precompile=False)
    assert workshop.check_members(60).status == "passed"
    workshop.put("core/b.hpp", "int state_;")
    assert workshop.check_members(60).status == "failed"
    workshop.take_away("core/b.hpp")
    assert workshop.check_members(60).status == "passed"


def run():
    test_mutants()
    test_choice()
    for test in (test_order, test_coverage, test_results, test_runner, test_compiler):
        with tempfile.TemporaryDirectory() as folder:
            test(pathlib.Path(folder))
