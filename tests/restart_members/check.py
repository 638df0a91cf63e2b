#!/usr/bin/env python3
# SPDX-License-Identifier: MIT
"""Checks that no state of a run is missing in checkpoints, or when a failed step is rolled back.

    check.py FOLDER...    include/ and examples/; prints each fault as file:line and exits with 1
    check.py --self-test  checks that a member that is added and forgotten is found

A part of a run is a class with transfer(archive), with save() and restore(), with one of the functions PART_FUNCTIONS,
or named in members.py. Each of its data members must
  be named in its transfer(), or be in NOT_STORED in members.py, with the reason;
  if it has save() and restore(), be named in one of them, or be in NOT_SAVED.
If only members of a member are named there (state_.displacement), all of them must be, in the same way. A base class
counts as its members. A function that returns an element of an array (list() { return lists_[…]; }) names the array. members.py must not name members that do not exist.
"""

import dataclasses
import pathlib
import re
import sys
import tempfile

from members import NOT_SAVED, NOT_STORED

# What a search, an interaction, an integrator, an observer or a solver has.
PART_FUNCTIONS = {"update", "accelerate", "predict", "before_step", "after_step", "between_steps",
                  "stop_requested", "solve", "prepare"}
CLASS = re.compile(r"(?<!enum )\b(?:class|struct)\s+(?:alignas\([^)]*\)\s*)?([A-Za-z_]\w*)"
                   r"\s*(<[^{};]*>)?\s*(?:final\s*)?(:[^:{};][^{};]*)?\{")
# Comments, strings, characters and directives.
TEXT = re.compile(r'//[^\n]*|/\*.*?\*/|"(?:\\.|[^"\\\n])*"|\'(?:\\.|[^\'\\\n])\'|^[ \t]*#(?:\\\n|[^\n])*',
                  re.DOTALL | re.MULTILINE)
NO_MEMBER = re.compile(r"(using|typedef|friend|static|static_assert|template|enum|class|struct|explicit|constexpr|"
                       r"inline|operator|public|private|protected)\b")


@dataclasses.dataclass
class Class:
    name: str           # with those of the classes around it
    where: str          # file:line
    bases: str
    body: str           # without comments and strings
    members: list       # (name, type)
    functions: dict     # name -> bodies


def blank(match):
    """As many lines, without the text."""
    return re.sub(r"[^\n]", " ", match.group())


def end_of(text, begin, brackets="{}"):
    """The place after the bracket that closes the one at `begin`."""
    depth = 0
    for at in range(begin, len(text)):
        depth += (text[at] == brackets[0]) - (text[at] == brackets[1])
        if depth == 0:
            return at + 1
    return len(text)


def statements_of(body):
    """Yields the declarations of a class, with the bodies of functions and classes as separate texts."""
    text, inner, at = "", [], 0
    while at < len(body):
        if body[at] in "({":
            end = end_of(body, at, "()" if body[at] == "(" else "{}")
            inner.append((body[at], body[at:end]))
            text += "()" if body[at] == "(" else "{}"
            is_body = body[at] == "{"
            at = end
            following = body[at:].lstrip()[:1]
            if is_body and following not in (";", ",", "(", ")", "=", ".", "{"):
                yield text.strip(), [each for kind, each in inner if kind == "{"]
                text, inner = "", []
            continue
        if body[at] == ";":
            yield text.strip(), [each for kind, each in inner if kind == "{"]
            text, inner = "", []
        else:
            text += body[at]
        at += 1


def split_outside_angles(text, separator):
    parts, depth = [""], 0
    for char in text:
        depth += (char == "<") - (char == ">")
        if char == separator and depth == 0:
            parts.append("")
        else:
            parts[-1] += char
    return parts


def outside_angles(text):
    result, depth = "", 0
    for char in text:
        depth -= char == ">"
        if depth == 0:
            result += char
        depth += char == "<"
    return result


def members_in(statement):
    """The (name, type) of the data members that a declaration declares."""
    statement = re.sub(r"^((public|private|protected)\s*:\s*)+", "", statement)
    statement = re.sub(r"\[\[.*?\]\]\s*|\bmutable\s+", "", statement).strip()
    if not statement or NO_MEMBER.match(statement) or re.search(r"\boperator\b", statement):
        return []
    declarators = [re.split(r"=|\{", each, maxsplit=1)[0] for each in split_outside_angles(statement, ",")]
    if "(" in outside_angles(declarators[0]):
        return []  # a function
    first = re.match(r"(.*?)([A-Za-z_]\w*)\s*((?:\[[^\]]*\])*)\s*$", declarators[0], re.DOTALL)
    if not first or not first.group(1).strip():
        return []
    kind = " ".join(first.group(1).split())
    names = [first.group(2)] + [re.sub(r"[\s*&]|\[.*", "", each) for each in declarators[1:]]
    return [(name, kind) for name in names]


def functions_in(body):
    functions = {}
    for statement, bodies in statements_of(body):
        statement = re.sub(r"\[\[.*?\]\]|noexcept\(\)|requires\s*\(\)", "", statement)
        name = re.search(r"(\w+)\s*\(\)", statement)
        if name and bodies:
            functions.setdefault(name.group(1), []).append(bodies[-1])
    return functions


def classes_of(text, where, around=""):
    """All classes in a text, those within others after them."""
    classes, at = [], 0
    while match := CLASS.search(text, at):
        end = end_of(text, match.end() - 1)
        body = text[match.end():end - 1]
        special = re.sub(r"\s", "", match.group(2) or "")
        name = around + match.group(1) + special
        line = where[1] + text[:match.start()].count("\n")
        members = [each for statement, _ in statements_of(body) for each in members_in(statement)]
        classes.append(Class(name, f"{where[0]}:{line}", (match.group(3) or "")[1:], body, members, functions_in(body)))
        inside = where[1] + text[:match.end()].count("\n")
        classes += classes_of(body, (where[0], inside), name + "::")
        at = end
    return classes


def with_arrays_named(text, one):
    """The text with the names of arrays instead of calls of functions that return one of their elements."""
    for function, member in re.findall(r"(\w+)\(\)[^{};]*\{\s*return (\w+)\[", one.body):
        text = re.sub(rf"(?<![\w.]){function}\(\)", member, text)
    return text


def resolve(classes, kind, around):
    """The class of the library that a type names, seen from within a class; None if there is none."""
    kind = re.sub(r"^std::array<(.*),[^,]*>$", r"\1", kind)
    name = re.sub(r"<.*", "", kind.removeprefix("const ").replace("typename ", "").replace("detail::", ""))
    if name.startswith("std::"):
        return None
    scopes = around.split("::")
    for number in range(len(scopes), -1, -1):
        if found := classes.get("::".join([*scopes[:number], name])):
            return found
    return classes.get(name.split("::")[-1])


def bases_of(classes, one):
    for base in split_outside_angles(one.bases, ","):
        base = re.sub(r"^\s*(public|private|virtual)\s+", "", base).strip()
        if base and (found := resolve(classes, base, one.name)):
            yield found


def all_members(classes, one):
    for base in bases_of(classes, one):
        yield from all_members(classes, base)
    yield from one.members


def missing_in(classes, one, text, reasons, used, path="", owner=None):
    """Yields the members of a part, as state_.displacement, that neither the text nor the reasons name."""
    for name, kind in all_members(classes, owner or one):
        member = path + name
        if member in reasons:
            used.add(member)
            continue
        whole = r"(?<![\w.])" + re.escape(member) + r"\b"
        if re.search(whole + r"(?!\s*(\.|->)\s*\w)|" + whole + r"\s*\.\s*(transfer|save|restore)\s*\(", text):
            continue
        inner = resolve(classes, kind, (owner or one).name)
        inner_names = [each for each, _ in all_members(classes, inner)] if inner else []
        named = {*re.findall(whole + r"\s*\.\s*(\w+)", text),
                 *(each.removeprefix(member + ".").split(".")[0] for each in reasons if each.startswith(member + "."))}
        if named & set(inner_names):
            yield from missing_in(classes, one, text, reasons, used, member + ".", inner)
        elif not named:
            yield member


def advice(function, table, name):
    return (f"add it to {function}, or to {table}[\"{name}\"] in tests/restart_members/members.py with the reason "
            f"why it need not be")


def check(folders, not_stored=NOT_STORED, not_saved=NOT_SAVED):
    found = []
    for source in sorted(path for folder in folders for path in pathlib.Path(folder).rglob("*.[ch]pp")):
        text = TEXT.sub(blank, source.read_text(encoding="utf-8"))
        found += classes_of(text, (source, 1))
    classes = {}
    for each in found:
        classes.setdefault(each.name, each)
    faults = []
    used = {"NOT_STORED": {}, "NOT_SAVED": {}}
    for one in found:
        is_part = one.name in not_stored or bool(PART_FUNCTIONS & one.functions.keys())
        stores = "transfer" in one.functions
        rolls_back = "save" in one.functions and "restore" in one.functions
        # Bases such as Contacts have no state of their own.
        if stores or rolls_back or (is_part and one.members):
            text = with_arrays_named(" ".join(one.functions.get("transfer", [])), one)
            reasons = not_stored.get(one.name, {})
            named = used["NOT_STORED"].setdefault(one.name, set())
            if re.search(r"::transfer\s*\(\s*archive", text):  # of the base
                one = dataclasses.replace(one, bases="")
            for member in missing_in(classes, one, text, reasons, named):
                faults.append(f"{one.where}: {one.name}: {member} is not in a checkpoint: "
                              f"{advice('transfer()', 'NOT_STORED', one.name)}")
        if rolls_back:
            text = with_arrays_named(" ".join(one.functions["save"] + one.functions["restore"]), one)
            reasons = not_saved.get(one.name, {})
            named = used["NOT_SAVED"].setdefault(one.name, set())
            for member in missing_in(classes, one, text, reasons, named):
                faults.append(f"{one.where}: {one.name}: {member} is not rolled back after a failed step: "
                              f"{advice('save() and restore()', 'NOT_SAVED', one.name)}")
    for table, entries in (("NOT_STORED", not_stored), ("NOT_SAVED", not_saved)):
        for name, reasons in entries.items():
            for member in sorted(reasons.keys() - used[table].get(name, set())):
                faults.append(f"members.py: {table}[\"{name}\"] has {member}, which does not exist; remove it")
    return faults


def self_test():
    part = """
#pragma once
class Part {
 public:
  template <class Archive>
  void transfer(Archive& archive) {
    archive("number", number_);
    archive("length", state_.length);
    archive.within("inner", [&] { inner_.transfer(archive); });
  }
  void save() noexcept { saved_ = state_; }
  void restore() noexcept { state_ = saved_; }
 private:
  struct State {
    double length = 0;  // in [m]; not a member: double width_ = 0;
    PLACE_IN_STATE
  };
  State state_;
  State saved_;
  int number_ = 0;
  Inner inner_;
  std::vector<double> scratch_, more_;
  PLACE
};
struct Inner {
  double a = 0, b = 0;
  PLACE_IN_INNER
  template <class Archive>
  void transfer(Archive& archive) { archive("a", a); archive("b", b); }
};
struct Derived : Inner {
  double c = 0;
  template <class Archive>
  void transfer(Archive& archive) { Inner::transfer(archive); archive("c", c); }
};
class Observer {
 public:
  void after_step(int) {}
  PLACE_IN_OBSERVER
};
"""
    stored = {"Part": {"saved_": "x", "scratch_": "x", "more_": "x"}}
    saved = {"Part": {"number_": "x", "inner_": "x", "scratch_": "x", "more_": "x"}}
    cases = {
        "nothing": ({}, []),
        "a member": ({"PLACE": "double added_ = 0;"}, ["Part: added_", "Part: added_"]),
        "an array": ({"PLACE": "std::array<bool, 2> added_{};"}, ["Part: added_", "Part: added_"]),
        "a mutable member": ({"PLACE": "mutable std::function<int(int)> added_;"}, ["Part: added_", "Part: added_"]),
        "a second declarator": ({"PLACE": "int* more_of_it_ = nullptr, *added_;"},
                                ["Part: more_of_it_", "Part: added_", "Part: more_of_it_", "Part: added_"]),
        "a member of the state": ({"PLACE_IN_STATE": "std::optional<int> added = {};"}, ["Part: state_.added"]),
        "a member of a struct": ({"PLACE_IN_INNER": "double added = 0;"}, ["Inner: added"]),
        "an observer with state": ({"PLACE_IN_OBSERVER": "int added_ = 0;"}, ["Observer: added_"]),
        "functions and constants": ({"PLACE": "static constexpr int most = 2;\n  int f() const { return number_; }\n"
                                              "  template <class T> struct Deep { };\n  using Name = int;\n"
                                              "  friend class Inner;\n  bool operator==(const Part&) const = default;"},
                                    []),
    }
    wrong = []
    for what, (planted, expected) in cases.items():
        text = part
        for place in ("PLACE_IN_STATE", "PLACE_IN_INNER", "PLACE_IN_OBSERVER", "PLACE"):
            text = re.sub(rf"\b{place}\b", planted.get(place, ""), text)
        with tempfile.TemporaryDirectory() as folder:
            (pathlib.Path(folder) / "part.hpp").write_text(text, encoding="utf-8")
            found = [re.sub(r".*?:\d+: | is not.*", "", fault) for fault in check([folder], stored, saved)]
        if found != expected:
            wrong.append(f"planted {what}, found {found}")
    needless = {"Part": {**stored["Part"], "number_": "x", "gone_": "x"}}
    with tempfile.TemporaryDirectory() as folder:
        (pathlib.Path(folder) / "part.hpp").write_text(re.sub(r"\bPLACE\w*", "", part), encoding="utf-8")
        found = check([folder], needless, saved)
    if len(found) != 1 or "gone_" not in found[0]:
        wrong.append(f"a reason for a member that does not exist: found {found}")
    return wrong


def main(arguments):
    if not arguments:
        sys.exit(__doc__)
    faults = self_test() if arguments == ["--self-test"] else check(arguments)
    for fault in faults:
        print(fault)
    sys.exit(1 if faults else 0)


if __name__ == "__main__":
    main(sys.argv[1:])
