#!/usr/bin/env python3
# SPDX-License-Identifier: MIT
"""Checks what a release says of itself.

    check.py names REPOSITORY      the tables of renamed things in docs/changelog.md: the names in their second
                                   column exist in include/, those in the first do not
    check.py version REPOSITORY    the version in the header is that of the first section of the changelog
                                   and that which the pages and install tests ask for
    check.py citation REPOSITORY   CITATION.cff is valid, with that version and the papers of references.bib;
                                   exits with 77 if Python has no module yaml
    check.py --self-test
"""

import pathlib
import re
import sys
import tempfile

SKIPPED = 77
SECTION = re.compile(r"^(?:[A-Z].*), in `(?P<space>silt(?:::\w+)?::|silt/)`$")
CODE = re.compile(r"`([^`]+)`")
CLASS = re.compile(r"\b(?:class|struct|concept)\s+(?:\[\[.*?\]\]\s*)?(\w+)")


# --- names ---------------------------------------------------------------------------------------

def without_comments(text):
    return re.sub(r'"(?:[^"\\\n]|\\.)*"|//[^\n]*|/\*.*?\*/',
                  lambda match: '""' if match[0].startswith('"') else "", text, flags=re.S)


def body_of(text, begin):
    """The text after the name of a class or concept up to its closing brace; nothing after a declaration or a
    parameter of a template."""
    if re.match(r"\s*[,>;&*]", text[begin:begin + 20]):
        return ""
    depth = 0
    for position in range(begin, len(text)):
        letter = text[position]
        if letter == "{":
            depth += 1
        elif letter == "}":
            depth -= 1
            if depth == 0:
                return text[begin:position]
        elif letter == ";" and depth == 0:
            return text[begin:position]
    return ""


def is_declared(name, text):
    """Whether the text declares the name of a type, function or variable, and does not only use it as that of a
    parameter."""
    return name in text and re.search(rf"\b(?:class|struct|concept|using|enum class|define)\s+{name}\b(?!\s*[,>])|"
                     rf"\bconstexpr\s[^;()=]*\s{name}\s*[={{;]|(?<![\w.>:]){name}\s*[<(]", text) is not None


def is_member(name, text):
    """Whether the body of a class declares the name, apart from parameters of functions."""
    return name in text and re.search(rf"(?<![\w.>:]){name}\s*[(={{;<]", text) is not None


class Headers:
    def __init__(self, include):
        self.include = include
        self.texts = {path.relative_to(include).as_posix(): without_comments(path.read_text(encoding="utf-8"))
                      for path in sorted((include / "silt").rglob("*.hpp"))}
        self.bodies = {}
        for text in self.texts.values():
            for match in CLASS.finditer(text):
                self.bodies.setdefault(match[1], []).append(body_of(text, match.end()))

    def has(self, space, name):
        """Whether the headers of a namespace, such as silt::dem::, use a name or class::member; or, in silt/,
        whether a header or folder exists."""
        if space == "silt/":
            return (self.include / "silt" / name).exists()
        owner, _, member = name.rpartition("::")
        if owner in ("", "file", "checkpoint"):
            folder = "silt/" + "/".join(space.split("::")[1:-1])
            return any(is_declared(member, text) for path, text in self.texts.items() if path.startswith(folder))
        return any(is_member(member, body) for body in self.bodies.get(owner.split("::")[-1], ()))


def names_in(cell):
    """The names in the code of a cell; code that is more than a name, such as set_time(t), is prose."""
    return [code for code in CODE.findall(cell) if re.fullmatch(r"[\w:./]+", code)]


def faults_of_names(changelog, include):
    headers = Headers(include)
    space = None
    rows = 0
    for number, line in enumerate(changelog.splitlines(), 1):
        section = SECTION.match(line)
        if section:
            space = section["space"]
        elif line.startswith("#"):
            space = None
        if not space or not line.startswith("|") or line.startswith(("|---", "| 0.")):
            continue
        before, now = line.strip("|").split("|")
        rows += 1
        old, new = names_in(before), names_in(now)
        if not old or not (new or "–" in now or "struct" in now):
            yield f"{number}: a row needs an old name, and a new one or a dash with the reason"
        for name in old:
            if name not in new and headers.has(space, name):
                yield f"{number}: {space}{name} is still there"
        for name in new:
            if not headers.has(space, name):
                yield f"{number}: there is no {space}{name}"
    if rows == 0:
        yield "0: there are no tables of names"


# --- version and citation --------------------------------------------------------------------------

def version_of(repository):
    text = (repository / "include/silt/version.hpp").read_text(encoding="utf-8")
    return ".".join(re.findall(r"#define SILT_VERSION_(?:MAJOR|MINOR|PATCH) (\d+)", text))


def faults_of_version(repository):
    version = version_of(repository)
    changelog = (repository / "docs/changelog.md").read_text(encoding="utf-8")
    first = re.search(r"^## (\S+)", changelog, re.M)[1]
    if first != version:
        yield f"docs/changelog.md begins with {first}, but include/silt/version.hpp has {version}"
    minor = version.rpartition(".")[0]
    pages = [repository / "README.md", *(repository / "docs").rglob("*.md"),
             *(repository / "tests/install").rglob("CMakeLists.txt")]
    count = 0
    for page in pages:
        for asked in re.findall(r"find_package\(silt (\d[\d.]*)", page.read_text(encoding="utf-8")):
            count += 1
            if asked != minor:
                yield f"{page.relative_to(repository)} asks for version {asked}, not {minor}"
        for asked in re.findall(r"libsilt-dev_(.*?)_all", page.read_text(encoding="utf-8")):
            if asked != version:
                yield f"{page.relative_to(repository)} has the package of version {asked}, not {version}"
    if count < 4:
        yield "README, building.md or the install tests ask for no version"


def entry_of(bibliography, key):
    entry = re.search(rf"@\w+{{{key},(.*?)\n}}", bibliography, re.S)[1]
    return {name: re.sub(r"[{}]", "", value) for name, value in re.findall(r"(\w+)\s*=\s*{(.*)}", entry)}


def faults_of_citation(repository, yaml):
    citation = yaml.safe_load((repository / "CITATION.cff").read_text(encoding="utf-8"))
    for key in ("cff-version", "message", "title", "authors", "version", "license", "type", "date-released"):
        if not citation.get(key):
            yield f"{key} is missing"
    if str(citation.get("cff-version")) != "1.2.0":
        yield "cff-version is not 1.2.0"
    if str(citation.get("version")) != version_of(repository):
        yield f"version is {citation.get('version')}, but that of the library {version_of(repository)}"
    licence = (repository / "LICENSE").read_text(encoding="utf-8")
    if citation.get("license") != "MIT" or not licence.startswith("MIT License"):
        yield "license is not that of LICENSE"
    for author in citation.get("authors", ()):
        if not (author.get("name") or author.get("family-names")):
            yield f"an author without a name: {author}"

    bibliography = (repository / "docs/references.bib").read_text(encoding="utf-8")
    papers = citation.get("references", [])
    for key in ("SahChoi2004", "HwangLeePark2010"):
        entry = entry_of(bibliography, key)
        match = [paper for paper in papers if paper.get("title") == entry["title"]]
        if not match:
            yield f"the paper {key} of docs/references.bib is missing"
            continue
        names = [f"{author['family-names']}, {author['given-names']}" for author in match[0]["authors"]]
        if names != entry["author"].split(" and ") or str(match[0].get("year")) != entry["year"]:
            yield f"the paper {key} has other authors or another year than in docs/references.bib"
        if not match[0].get("type"):
            yield f"the paper {key} has no type"


# --- self-test ---------------------------------------------------------------------------------------

def self_test():
    with tempfile.TemporaryDirectory() as name:
        include = pathlib.Path(name)
        (include / "silt/dem").mkdir(parents=True)
        (include / "silt/dem/wall.hpp").write_text(
            "// the old Pillar\nclass Wall;\ntemplate <class Other>\nstruct Wall : Base {\n  int torque; struct A {};\n"
            "};\ninline int moment;\nstruct Grain { int force; };\n", encoding="utf-8")
        begin = "Grains, in `silt::dem::`\n\n| 0.1.0 | 0.2.0 |\n|---|---|\n"
        headers = "Headers, in `silt/`\n| `wall.hpp` | `dem/wall.hpp` |\n"
        sound = ("| `Pillar` | `Wall` |\n", "| `Wall::moment` | `Wall::torque`, as in `a(b)` |\n", "| `Post` | – (gone) |\n")
        faults = list(faults_of_names(begin + "".join(sound) + headers, include))
        assert not faults, faults
        for row in ("| `Wall` | `Grain` |\n", "| `Pillar` | `Post` |\n", "| `Wall::torque` | `Wall::torque_of` |\n",
                    "| `Pillar` | `Wall::force` |\n", "| `Pillar` | gone |\n", "| nothing | `Wall` |\n"):
            assert list(faults_of_names(begin + row, include)), row
        assert list(faults_of_names("Headers, in `silt/`\n| `dem/wall.hpp` | `wall.hpp` |\n", include))
        assert list(faults_of_names("", include))


def main(arguments):
    if arguments == ["--self-test"]:
        self_test()
        return
    if len(arguments) != 2:
        sys.exit(__doc__)
    what, repository = arguments[0], pathlib.Path(arguments[1])
    if what == "names":
        page = (repository / "docs/changelog.md").read_text(encoding="utf-8")
        faults = [f"docs/changelog.md:{fault}" for fault in faults_of_names(page, repository / "include")]
    elif what == "version":
        faults = list(faults_of_version(repository))
    elif what == "citation":
        try:
            import yaml
        except ImportError:
            print("Python has no module yaml (Debian: python3-yaml)")
            sys.exit(SKIPPED)
        faults = [f"CITATION.cff: {fault}" for fault in faults_of_citation(repository, yaml)]
    else:
        sys.exit(__doc__)
    print(*faults, sep="\n")
    sys.exit(1 if faults else 0)


if __name__ == "__main__":
    main(sys.argv[1:])
