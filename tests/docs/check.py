#!/usr/bin/env python3
# SPDX-License-Identifier: MIT
"""Compiles every ```cpp block of README.md and docs/, and runs those that have a main(). Runs every
```python block.

    check.py [--compile-only] REPOSITORY SCRATCH FLAGS-FILE COMPILER...
    check.py --self-test

With --compile-only, nothing is run, and several programs are compiled at once, with them the examples
that include the library and the standard library only.

A block is a separate file, unless HTML comments directly before it say otherwise:

    <!-- silt: wrap -->          statements: they are put into a main() after
                                 #include <silt/silt.hpp> and using namespace silt;
    <!-- silt: name NAME -->     later blocks of this page can continue this block
    <!-- silt: after NAME -->    continues the block of that name (and those it continues)
    <!-- silt: file PATH -->     must be the text of this file of the repository, except for its
                                 SPDX line; the file itself is compiled and run as an example
    <!-- silt: lines PATH -->    must be consecutive lines of this file of the repository, apart
                                 from their indentation; not compiled
    <!-- silt: skip REASON -->   neither compiled nor run

There may be several comments before a block. A block without wrap that others continue stays
outside of main(), so that it can declare types; #include lines always go to the top.

A ```text block with <!-- silt: prints NAME -->, a block of this page or the path of a program of the
repository, must be what this program prints. Such a program is compiled and run here.

A Python block has `after NAME`, and runs in the folder of that block's program, with the modules of
examples/support. It is skipped if a module that it imports is not installed. Or it has `file` or
`lines`, with the path of a script that other tests run.

All links of the pages to files of the repository, or to headings in them, must be valid. In
changelog.md every bullet must be a complete sentence, and no two may begin with the same words: a
merge of two branches that rewrote it otherwise leaves both versions.
"""

import concurrent.futures
import dataclasses
import os
import pathlib
import re
import subprocess
import sys
import tempfile
import textwrap

COMMENT = re.compile(r"^\s*<!--\s*silt:\s*(\w+)\s*(.*?)\s*-->\s*$")
FENCE = re.compile(r"^\s*```\s*([\w+]*)")
MAIN = re.compile(r"\bint\s+main\s*\(")
SPDX = re.compile(r"\A(//|#) SPDX-License-Identifier: MIT\n")
RUN_SECONDS = 300
PRINTED = "printed.txt"
AT_ONCE = 32  # programs that are compiled together


class PageError(Exception):
    pass


@dataclasses.dataclass
class Program:
    """The program formed by blocks: lines at the top, at namespace scope and inside main()."""

    where: str = ""
    includes: tuple = ()
    outside: str = ""
    inside: str = ""

    def then(self, page, line, text, wrap):
        """This program extended by a block, whose lines keep their numbers in the page."""
        includes, rest = [], []
        for offset, row in enumerate(text.splitlines()):
            is_include = re.match(r"\s*#\s*include\b", row)
            if is_include:
                includes.append(f'#line {line + offset} "{page}"\n{row}\n')
            rest.append("" if is_include else row)
        body = f'#line {line} "{page}"\n' + "\n".join(rest) + "\n"
        return Program(
            where=f"{page}:{line}" if line > 1 else page,
            includes=self.includes + tuple(includes),
            outside=self.outside + ("" if wrap else body),
            inside=self.inside + (body if wrap else ""),
        )

    def source(self):
        if not self.inside:
            return "".join(self.includes) + self.outside
        return (
            "#include <silt/silt.hpp>\n"
            + "".join(self.includes)
            + "using namespace silt;\n"
            + self.outside
            + "int main() {\n"
            + self.inside
            + "}\n"
        )


def blocks_of(text, languages=("cpp", "c++", "cxx")):
    """Yields (line of the first row, directives, text) of each block of a page in this language."""
    directives, language, rows, first = {}, None, [], 0
    for number, line in enumerate(text.splitlines(), 1):
        fence = FENCE.match(line)
        if language is not None:
            if fence and not fence.group(1):
                if language in languages:
                    yield first, directives, textwrap.dedent("\n".join(rows))
                directives, language = {}, None
            else:
                rows.append(line)
        elif fence:
            language, rows, first = fence.group(1).lower(), [], number + 1
        elif comment := COMMENT.match(line):
            directives[comment.group(1)] = comment.group(2)
        elif line.strip():
            directives = {}
    if language is not None:
        raise PageError(f"line {first - 1}: this block has no end")


def require_same_text(line, block, path):
    """Raises unless a block is the text of a file."""
    if not path.is_file():
        raise PageError(f"line {line}: there is no file {path}")
    if block.strip() != SPDX.sub("", path.read_text(encoding="utf-8")).strip():
        raise PageError(f"line {line}: this block differs from {path}; copy it again")


def require_lines(line, block, path):
    """Raises unless a block consists of consecutive lines of a file."""
    if not path.is_file():
        raise PageError(f"line {line}: there is no file {path}")
    rows = [row.strip() for row in path.read_text(encoding="utf-8").splitlines()]
    wanted = [row.strip() for row in block.strip().splitlines()]
    starts = range(len(rows) - len(wanted) + 1)
    if not wanted or not any(rows[at : at + len(wanted)] == wanted for at in starts):
        raise PageError(f"line {line}: these are not consecutive lines of {path}; copy them again")


def programs_of(page, text, repository=pathlib.Path()):
    """The programs of one page, in order."""
    named, programs = {}, []
    try:
        for line, directives, block in blocks_of(text):
            unknown = set(directives) - {"wrap", "name", "after", "file", "lines", "skip"}
            if unknown:
                raise PageError(f"line {line}: unknown directive {sorted(unknown)[0]}")
            if "skip" in directives:
                if not directives["skip"]:
                    raise PageError(f"line {line}: skip needs a reason")
                continue
            if "file" in directives:
                require_same_text(line, block, repository / directives["file"])
                continue
            if "lines" in directives:
                require_lines(line, block, repository / directives["lines"])
                continue
            start = Program()
            if "after" in directives:
                if directives["after"] not in named:
                    raise PageError(f"line {line}: no block {directives['after']} before this one")
                start = named[directives["after"]]
            program = start.then(page, line, block, "wrap" in directives)
            if "name" in directives:
                named[directives["name"]] = program
            programs.append(program)
    except PageError as error:
        raise PageError(f"{page}: {error}") from None
    return programs


def scripts_of(page, text, repository=pathlib.Path()):
    """The Python blocks of one page that are no copies of files: (location, text, location of the
    block that it continues)."""
    named = {d["name"]: f"{page}:{line}" for line, d, _ in blocks_of(text) if "name" in d}
    scripts = []
    for line, directives, block in blocks_of(text, ("python",)):
        if set(directives) in ({"file"}, {"lines"}):
            try:
                if "file" in directives:
                    require_same_text(line, block, repository / directives["file"])
                else:
                    require_lines(line, block, repository / directives["lines"])
            except PageError as error:
                raise PageError(f"{page}: {error}") from None
            continue
        if set(directives) != {"after"} or directives["after"] not in named:
            raise PageError(f"{page}: line {line}: a Python block needs `after` and a block's name, or `file` or "
                            "`lines`")
        scripts.append((f"{page}:{line}", block, named[directives["after"]]))
    return scripts


def outputs_of(page, text, repository=pathlib.Path()):
    """The ```text blocks that a program must print: (location, text, location of the program)."""
    named = {d["name"]: f"{page}:{line}" for line, d, _ in blocks_of(text) if "name" in d}
    outputs = []
    for line, directives, block in blocks_of(text, ("text",)):
        if "prints" not in directives:
            continue
        program = directives["prints"]
        if program not in named and not (repository / program).is_file():
            raise PageError(f"{page}: line {line}: there is neither a block nor a file {program}")
        outputs.append((f"{page}:{line}", block, named.get(program, program)))
    return outputs


def headings_of(text):
    """The anchors of the headings of a page."""
    titles = re.findall(r"^#+ +(.*)$", re.sub(r"^```.*?^```", "", text, flags=re.M | re.S), re.M)
    kept = ("".join(c for c in title.lower() if c.isalnum() or c in " -_") for title in titles)
    return {title.replace(" ", "-") for title in kept}


def dead_links(page, text, repository):
    """Faults of the links of a page to files of the repository and their headings."""
    faults = []
    outside_code = re.sub(r"^```.*?^```", "", text, flags=re.M | re.S)
    for link in re.findall(r"\]\(([^)\s]+)\)", outside_code):
        if re.match(r"\w+:", link):
            continue
        name, _, heading = link.partition("#")
        target = (repository / page).parent / name if name else repository / page
        if not target.exists():
            faults.append(f"{page}: the link to {link} is broken: there is no such file")
        elif heading and heading not in headings_of(target.read_text(encoding="utf-8")):
            faults.append(f"{page}: the link to {link} is broken: there is no such heading")
    return faults


def changelog_faults(page, text):
    """Faults of the bullets of the changelog."""
    faults, lines_by_beginning = [], {}
    for match in re.finditer(r"^- (.*(?:\n  .*)*)", text, re.M):
        line = text.count("\n", 0, match.start()) + 1
        words = match[1].split()
        beginning = " ".join(words[:5])
        if not words[-1].endswith("."):
            faults.append(f"{page}:{line}: the bullet '{beginning} …' does not end in a full stop")
        first = lines_by_beginning.setdefault(beginning, line)
        if first != line:
            faults.append(f"{page}:{line}: the bullet '{beginning} …' begins like that of line "
                          f"{first}; merge the two")
    return faults


def longest_programs(programs):
    """The programs that are not the beginning of another one, and thus a part of it."""

    def continues(longer, program):
        return longer is not program and all(
            getattr(longer, part)[: len(getattr(program, part))] == getattr(program, part)
            for part in ("includes", "outside", "inside")
        )

    return [each for each in programs if not any(continues(other, each) for other in programs)]


def merged(programs):
    """The programs, with those of one page that consist of statements only merged into one: each in
    a function of its own, compiled together."""
    apart, pages = [], {}
    for each in programs:
        if each.outside or each.includes:
            apart.append(each)
        else:
            page = each.where.rpartition(":")[0]
            first = pages.setdefault(page, Program(where=each.where))
            body = "[] {\n" + each.inside + "}();\n"
            pages[page] = dataclasses.replace(first, inside=first.inside + body)
    return apart + list(pages.values())


def in_groups(programs, size):
    """Sources of up to `size` programs each, for compiling only, with their programs: each program is
    in a namespace of its own. Most of the time goes into templates that they have in common."""
    for first in range(0, len(programs), size):
        group = programs[first : first + size]
        text = "#include <silt/silt.hpp>\n" + "".join("".join(each.includes) for each in group)
        for number, each in enumerate(group):
            text += f"namespace block_{number} {{\n"
            if each.inside:
                text += "using namespace silt;\n"
            text += each.outside
            if each.inside:
                text += "int main() {\n" + each.inside + "return 0;\n}\n"
            text += "}\n"
        yield text, group


def plain_examples(repository):
    """The programs of examples/ that include the library and the standard library only."""
    for path in sorted((repository / "examples").glob("*.cpp")):
        text = path.read_text(encoding="utf-8")
        if re.search(r'^#include ("|<(?!silt/)\w+[./])', text, re.M):
            continue
        name = path.relative_to(repository).as_posix()
        yield Program().then(name, 1, text, wrap=False)


def folder_of(where, scratch):
    return scratch / re.sub(r"\W+", "_", where)


def errors_of_compiling(text, folder, compile_command, mode=("-fsyntax-only",)):
    """Compiles a source, written to a folder; returns None, or the errors."""
    folder.mkdir(parents=True, exist_ok=True)
    source = folder / "block.cpp"
    source.write_text(text, encoding="utf-8")
    # The file of flags comes last, because it also names libraries.
    made = subprocess.run(
        [compile_command[1], *compile_command[2:], str(source), *mode, f"@{compile_command[0]}"],
        capture_output=True,
        text=True,
    )
    return made.stderr if made.returncode != 0 else None


def compile_group(text, group, scratch, compile_command):
    """Compiles programs at once, and each separately if that fails; returns the faults."""
    folder = folder_of(group[0].where, scratch)
    if errors_of_compiling(text, folder, compile_command) is None:
        return []
    faults = []
    for each in group:
        errors = errors_of_compiling(each.source(), folder_of(each.where, scratch), compile_command)
        if errors is not None:
            faults.append(f"{each.where}: does not compile\n{errors}")
    return faults


def run_program(program, scratch, compile_command):
    """Compiles and runs one program; returns the fault, or an empty string."""
    folder = folder_of(program.where, scratch)
    text = program.source()
    is_run = MAIN.search(text) is not None
    mode = ["-Og", "-o", str(folder / "block")] if is_run else ["-fsyntax-only"]
    errors = errors_of_compiling(text, folder, compile_command, mode)
    if errors is not None:
        return f"{program.where}: does not compile\n{errors}"
    if not is_run:
        return ""
    try:
        ran = subprocess.run(
            [str(folder / "block")],
            cwd=folder,
            env={"OMP_NUM_THREADS": "1", **os.environ},
            capture_output=True,
            text=True,
            errors="replace",
            timeout=RUN_SECONDS,
        )
    except subprocess.TimeoutExpired:
        return f"{program.where}: still running after {RUN_SECONDS} s"
    if ran.returncode != 0:
        return f"{program.where}: ended with {ran.returncode}\n{ran.stdout}{ran.stderr}"
    (folder / PRINTED).write_text(ran.stdout, encoding="utf-8")
    return ""


def wrong_output(where, text, folder):
    """The fault if a program, run in this folder, has not printed this text."""
    printed = folder / PRINTED
    if not printed.is_file():
        return f"{where}: the program of this output is not a separate one, or failed"
    found = printed.read_text(encoding="utf-8")
    if found.rstrip("\n") == text.rstrip("\n"):
        return ""
    return f"{where}: this is not what the program prints, which is\n{found}"


def run_script(where, text, folder, repository):
    """Runs a Python block with the first interpreter that has its modules; returns the fault, or an
    empty string."""
    if not folder.is_dir():
        return f"{where}: the block that this one continues is not a separate program"
    (folder / "block.py").write_text(text, encoding="utf-8")
    modules = {"PYTHONPATH": str(repository / "examples" / "support"), "MPLBACKEND": "Agg"}
    for python in (sys.executable, "/usr/bin/python3"):
        if not os.access(python, os.X_OK):
            continue
        ran = subprocess.run(
            [python, "block.py"],
            cwd=folder,
            env={**os.environ, **modules},
            capture_output=True,
            text=True,
            timeout=RUN_SECONDS,
        )
        missing = re.search(r"ModuleNotFoundError: (.*)", ran.stderr)
        if not missing:
            return f"{where}: ended with {ran.returncode}\n{ran.stderr}" if ran.returncode else ""
    print(f"{where} is skipped: {missing.group(1)}")
    return ""


def check(repository, scratch, compile_command, compile_only):
    pages = {
        page.relative_to(repository).as_posix(): page.read_text(encoding="utf-8")
        for page in [repository / "README.md", *sorted((repository / "docs").rglob("*.md"))]
        if page.is_file()
    }
    programs = [
        program for page, text in pages.items() for program in programs_of(page, text, repository)
    ]
    scripts = [script for page, text in pages.items() for script in scripts_of(page, text, repository)]
    outputs = [
        output for page, text in pages.items() for output in outputs_of(page, text, repository)
    ]
    for path in sorted({path for _, _, path in outputs if (repository / path).is_file()}):
        text = (repository / path).read_text(encoding="utf-8")
        programs.append(Program().then(path, 1, text, wrap=False))
    if compile_only:
        programs += plain_examples(repository)
    with concurrent.futures.ThreadPoolExecutor(os.cpu_count()) as workers:
        whole = merged(longest_programs(programs))
        if compile_only:
            compiled = workers.map(
                lambda group: compile_group(*group, scratch, compile_command),
                in_groups(whole, AT_ONCE))
            faults = [fault for each in compiled for fault in each]
        else:
            outcomes = workers.map(lambda p: run_program(p, scratch, compile_command), whole)
            faults = [fault for fault in outcomes if fault]
    for page, text in pages.items():
        faults += dead_links(page, text, repository)
        if page == "docs/changelog.md":
            faults += changelog_faults(page, text)
    for where, text, program in [] if compile_only else scripts:
        folder = folder_of(program, scratch)
        if fault := run_script(where, text, folder, repository):
            faults.append(fault)
    for where, text, program in [] if compile_only else outputs:
        if fault := wrong_output(where, text, folder_of(program, scratch)):
            faults.append(fault)
    for fault in faults:
        print(fault)
    print(f"{len(programs) + len(scripts)} blocks, {len(faults)} with faults")
    return not faults


def self_test():
    page = textwrap.dedent(
        """\
        ```cpp
        int main() { return 0; }
        ```
        <!-- silt: name law -->

        ```cpp
        #include <cmath>
        struct Law {};
        ```
        Words.
        <!-- silt: after law -->
        <!-- silt: wrap -->
        <!-- silt: name use -->
        ```cpp
        #include <vector>
        Law law;
        ```
        <!-- silt: after use -->
        <!-- silt: wrap -->
        ```cpp
        use(law);
        ```
        <!-- silt: skip not C++ yet -->
        ```cpp
        ...
        ```
        ```sh
        cmake
        ```
        <!-- silt: wrap -->
        Text in between: the comment above does not apply to this block.
        1. In a list:
           ```cpp
           struct Indented {};
           ```
        """
    )
    whole, law, use, both, indented = programs_of("p.md", page)
    assert longest_programs([whole, law, use, both, indented]) == [whole, both, indented]
    assert whole.source() == '#line 2 "p.md"\nint main() { return 0; }\n'
    assert law.source() == '#line 7 "p.md"\n#include <cmath>\n#line 7 "p.md"\n\nstruct Law {};\n'
    assert use.source().splitlines()[0] == "#include <silt/silt.hpp>"
    assert use.source().index("<vector>") < use.source().index("struct Law")
    assert use.source().index("struct Law") < use.source().index("int main() {")
    assert both.source().index("Law law;") < both.source().index("use(law);")
    assert indented.source().endswith("\nstruct Indented {};\n") and not indented.inside
    assert indented.where == "p.md:34"
    statements = [Program(where=f"p.md:{line}", inside="int i;\n") for line in (1, 5)]
    law_alone, one = merged([law, *statements])
    assert law_alone == law and one.where == "p.md:1"
    assert one.inside == "[] {\nint i;\n}();\n" * 2
    scripts = scripts_of(
        "p.md",
        "<!-- silt: name run -->\n```cpp\nint main() {}\n```\n"
        "<!-- silt: after run -->\n```python\nimport sys\n```\n",
    )
    assert scripts == [("p.md:7", "import sys", "p.md:3")]
    try:
        scripts_of("p.md", "```python\nimport sys\n```\n")
        raise AssertionError("no error for a Python block without a name")
    except PageError:
        pass
    [(text, group)] = in_groups([whole, both], 8)
    assert group == [whole, both] and text.index("<vector>") < text.index("namespace block_0 {")
    assert text.count("int main() {") == 2
    assert [len(group) for _, group in in_groups([whole] * 5, 2)] == [2, 2, 1]
    printing = "<!-- silt: name run -->\n```cpp\nint main() {}\n```\n<!-- silt: prints %s -->\n"
    printing += "```text\na\n\n b\n```\n```text\nother\n```\n"
    assert outputs_of("p.md", printing % "run") == [("p.md:7", "a\n\n b", "p.md:3")]
    try:
        outputs_of("p.md", printing % "walk")
        raise AssertionError("no error for the output of a program that is not there")
    except PageError:
        pass
    with tempfile.TemporaryDirectory() as folder:
        folder = pathlib.Path(folder)
        assert wrong_output("p.md:7", "a", folder)
        (folder / PRINTED).write_text("a\n b\n")
        assert not wrong_output("p.md:7", "a\n b", folder) and wrong_output("p.md:7", "a\nb", folder)
        for text, fault in (("", False), ("import no_such_module", False), ("1/0", True)):
            assert bool(run_script("p.md:1", text, folder, folder)) == fault
        assert run_script("p.md:1", "", folder / "none", folder)
        page = "# A *good* page, `code`\n[a](p.md) [b](#a-good-page-code) [c](https://a.b) %s"
        for link, count in (("", 0), ("[d](none.md)", 1), ("[d](p.md#none)", 1)):
            (folder / "p.md").write_text(page % link, encoding="utf-8")
            assert len(dead_links("p.md", page % link, folder)) == count
        assert not changelog_faults("c.md", "# C\n- One bullet\n  of two lines.\n- Another.\n")
        broken = "- The first five words are equal; rand\n- Other.\n- The first five words are old.\n"
        assert [fault.split(":")[1] for fault in changelog_faults("c.md", broken)] == ["1", "3"]
        copied = folder
        spdx = " SPDX-License-Identifier: MIT\n"
        (copied / "copied.cpp").write_text("//" + spdx + "int main() {}\n", encoding="utf-8")
        (copied / "copied.py").write_text("#" + spdx + "import sys\n", encoding="utf-8")
        copy = "<!-- silt: file copied.py -->\n```python\nimport %s\n```"
        assert not scripts_of("p.md", copy % "sys", copied)
        try:
            scripts_of("p.md", copy % "os", copied)
            raise AssertionError("no error for a script that differs from its file")
        except PageError:
            pass
        copy = "<!-- silt: file copied.cpp -->\n```cpp\nint main() {%s}\n```"
        assert not programs_of("p.md", copy % "", copied)
        assert outputs_of("p.md", printing % "copied.cpp", copied)[0][2] == "copied.cpp"
        try:
            programs_of("p.md", copy % " return 1; ", copied)
            raise AssertionError("no error for a text that differs from its file")
        except PageError:
            pass
        (copied / "lines.cpp").write_text("a;\n  b;\nc;\n", encoding="utf-8")
        lines = "<!-- silt: lines lines.cpp -->\n```cpp\n%s\n```"
        assert not programs_of("p.md", lines % "b;\n  c;", copied)
        try:
            programs_of("p.md", lines % "a;\nc;", copied)
            raise AssertionError("no error for lines that are not consecutive")
        except PageError:
            pass
    for wrong in (
        "<!-- silt: file nowhere.cpp -->\n```cpp\n```",
        "<!-- silt: after nothing -->\n```cpp\n```",
        "<!-- silt: skip -->\n```cpp\n```",
        "<!-- silt: warp -->\n```cpp\n```",
        "```cpp\nint main() {}",
    ):
        try:
            programs_of("p.md", wrong)
        except PageError:
            continue
        raise AssertionError(f"no error for {wrong!r}")


def main(arguments):
    if arguments == ["--self-test"]:
        self_test()
        return
    compile_only = arguments[:1] == ["--compile-only"]
    arguments = arguments[compile_only:]
    if len(arguments) < 4:
        sys.exit(__doc__)
    repository, scratch = map(pathlib.Path, arguments[:2])
    try:
        sound = check(repository, scratch, arguments[2:], compile_only)
    except PageError as error:
        sys.exit(str(error))
    sys.exit(0 if sound else 1)


if __name__ == "__main__":
    main(sys.argv[1:])
