# SPDX-License-Identifier: MIT
"""Mutants: small faults that can be put into a header.

Comments, texts, include lines, static_asserts, concepts, requires clauses, type aliases, template
parameters and arguments, and the arguments of fail(), throw and to_text() are not changed.
"""

import dataclasses
import hashlib
import re

from cpp_source import JUMPS, Source

RELATIONS = {"<": ("<=", ">="), "<=": ("<", ">"), ">": (">=", "<="), ">=": (">", "<"),
             "==": ("!=",), "!=": ("==",)}
ARITHMETIC = {"+": "-", "-": "+", "*": "/", "/": "*", "%": "*", "<<": ">>", ">>": "<<", "&": "|",
              "|": "&", "^": "&", "*=": "/=", "/=": "*=", "|=": "&=", "&=": "|=", "^=": "&=",
              "<<=": ">>=", ">>=": "<<=", "%=": "*=", "++": "--", "--": "++"}
LOGICAL = {"&&": "||", "||": "&&"}
SIGNED = {"+=": "-=", "-=": "+="}
EXTREMA = {"min": "max", "cwiseMin": "cwiseMax", "min_element": "max_element",
           "minCoeff": "maxCoeff"}
EXTREMA |= {other: name for name, other in EXTREMA.items()}
BOOLEANS = {"true": "false", "false": "true"}
INDICES = {"i": "j", "j": "i"}
NUMBERS = {"double", "float", "Real"}
KEYWORDS = {"return", "throw", "case", "else", "new", "delete", "goto", "co_return"}
NO_STATEMENT = KEYWORDS | JUMPS | {"using", "static_assert", "typedef", "if", "for", "while",
                                   "do", "switch", "namespace", "template", "friend", "default"}


@dataclasses.dataclass(frozen=True)
class Mutant:
    header: str  # below include/silt/
    line: int
    column: int
    operator: str
    old: str
    new: str
    begin: int  # position of `old` in the header
    key: str  # independent of other lines of the header

    def apply(self, text):
        assert text[self.begin: self.begin + len(self.old)] == self.old
        return text[: self.begin] + self.new + text[self.begin + len(self.old):]


def mutants_of(header, text):
    """All mutants of a header, in the order of their positions."""
    source = Source(text)
    found = {}
    for operator, begin, old, new in _changes(source):
        found.setdefault((begin, old, new), operator)
    lines = text.splitlines()
    starts = [0]
    for line in text.splitlines(keepends=True):
        starts.append(starts[-1] + len(line))
    seen, occurrence = {}, []  # so many equal lines are above this one
    for line in lines:
        occurrence.append(seen.get(line.strip(), 0))
        seen[line.strip()] = occurrence[-1] + 1
    made = []
    for (begin, old, new), operator in sorted(found.items()):
        line = text.count("\n", 0, begin) + 1
        column = begin - starts[line - 1] + 1
        row = lines[line - 1]
        indent = len(row) - len(row.lstrip())
        key = _digest(header, row.strip(), occurrence[line - 1], column - indent, operator, old,
                      new)[:12]
        made.append(Mutant(header, line, column, operator, old, new, begin, key))
    return made


def in_random_order(mutants, seed):
    """One mutant of each line, in an order that depends on the seed, and for each line on its own
    text only: a change elsewhere does not change what is chosen."""
    lines = {}
    for mutant in mutants:
        lines.setdefault((mutant.header, mutant.line), []).append(mutant)
    groups = sorted(lines.values(),
                    key=lambda group: _digest(seed, min(each.key for each in group)))
    return [min(group, key=lambda each: _digest(seed, each.key)) for group in groups]


def _digest(*parts):
    return hashlib.sha256("\n".join(map(str, parts)).encode()).hexdigest()


def _changes(source):
    """Yields (operator, position, old text, new text)."""
    for index, token in enumerate(source.tokens):
        if token.passive:
            continue
        if token.kind == "operator":
            changes = _of_operator(source, index)
        elif token.kind == "number":
            changes = (("constant", new) for new in changed_number(token.text))
        elif token.kind == "name":
            changes = _of_name(source, index)
        else:
            continue
        for operator, new in changes:
            yield operator, token.begin, token.text, new
    yield from _of_conditions(source)
    yield from _of_calls(source)
    for statement in source.statements:
        yield from _of_statement(source, statement)


def _of_operator(source, index):
    token = source.tokens[index]
    text, spaced = token.text, source.spaced(index)
    around = source.tokens[max(index - 1, 0): index + 2]
    if any(each.kind == "string" for each in around):
        return  # composes a text
    if text in RELATIONS and spaced:
        for new in RELATIONS[text]:
            yield "relation", new
    elif text in LOGICAL and spaced:
        yield "logical", LOGICAL[text]
    elif text in SIGNED and spaced:
        yield "sign", SIGNED[text]
    elif text in ("++", "--") or text in ARITHMETIC and spaced:
        yield "arithmetic", ARITHMETIC[text]
    elif text == "-" and _is_prefix(source, index):
        yield "sign", ""
    elif text == "!" and _is_prefix(source, index):
        yield "logical", ""


def _is_prefix(source, index):
    before, after = source.tokens[index - 1], source.tokens[index + 1]
    return after.begin == source.tokens[index].end and (
        before.kind == "operator" and before.text not in (")", "]", "}")
        or before.text in KEYWORDS or before.text == "constexpr")


def changed_number(text):
    """One more and one less; 1 instead of 0 and 0 instead of 1; ten times as much or a tenth."""
    suffix = re.search(r"[uUlLzZfF]*$", text).group()
    if text[:2].lower() == "0x" and "p" not in text.lower():
        suffix = re.search(r"[uUlLzZ]*$", text).group()
        value = int(text[: len(text) - len(suffix)].replace("'", ""), 16)
        return [f"{value + 1:#x}{suffix}", f"{value - 1:#x}{suffix}"] if value else [f"0x1{suffix}"]
    body = text[: len(text) - len(suffix)].replace("'", "")
    if power := re.fullmatch(r"(.*[eEpP])([+-]?\d+)", body):
        return [f"{power[1]}{int(power[2]) + step}{suffix}" for step in (1, -1)]
    if body.isdigit():
        value = int(body)
        others = {0: [1], 1: [0, 2]}.get(value, [value + 1, value - 1])
        return [f"{other}{suffix}" for other in others]
    try:
        value = float(body)
    except ValueError:
        return []  # a literal with a suffix of its own
    others = {0.0: [1.0], 1.0: [0.0, 2.0]}.get(value, [value + 1, value - 1])
    return [f"{other:.12g}{'' if '.' in f'{other:.12g}' else '.0'}{suffix}" for other in others]


def _of_name(source, index):
    token = source.tokens[index]
    before, after = source.words(index - 1) if index else [""], source.words(index + 1, 2)
    if token.text in BOOLEANS and source.body[index]:
        yield "boolean", BOOLEANS[token.text]
    elif token.text in BOOLEANS and before == ["="]:
        yield "boolean", BOOLEANS[token.text]
    elif token.text in EXTREMA and after[:1] == ["("] and (after != ["(", ")"] or "Coeff" in
                                                           token.text):
        yield "extremum", EXTREMA[token.text]
    elif token.text in INDICES and before[0] in ("[", "(") and after[:1] in (["]"], [")"]):
        line = [each.text for each in source.tokens if each.line == token.line]
        if INDICES[token.text] in line and source.body[index]:
            yield "arguments", INDICES[token.text]


def _text(source, first, last):
    return source.text[source.tokens[first].begin: source.tokens[last].end]


def _of_conditions(source):
    """Negated conditions of if and while."""
    for index, token in enumerate(source.tokens):
        if token.text not in ("if", "while") or source.words(index + 1) != ["("] or token.passive:
            continue
        first, last = index + 2, source.partner.get(index + 1, 0) - 1
        if first <= last and ";" not in source.words(first, last - first + 1):
            old = _text(source, first, last)
            yield "condition", source.tokens[first].begin, old, f"!({old})"


def _of_calls(source):
    """Exchanged neighbouring arguments that are single names."""
    for index, token in enumerate(source.tokens):
        if (token.text != "(" or token.passive or not source.body[index] or index == 0
                or source.tokens[index - 1].kind != "name"):
            continue
        first, last = index + 1, source.partner.get(index, 0) - 1
        arguments, start, at = [], first, first
        while at <= last:
            if source.tokens[at].text == ",":
                arguments.append((start, at - 1))
                start = at + 1
            at = source.partner[at] + 1 if source.tokens[at].text in "([{" else at + 1
        arguments.append((start, last))
        for one, other in zip(arguments, arguments[1:]):
            if _is_simple(source, *one) and _is_simple(source, *other):
                first_text, second_text = _text(source, *one), _text(source, *other)
                if first_text != second_text:
                    old = _text(source, one[0], other[1])
                    between = old[len(first_text): len(old) - len(second_text)]
                    yield ("arguments", source.tokens[one[0]].begin, old,
                           second_text + between + first_text)


def _is_simple(source, first, last):
    """A name, perhaps a member, such as i or bodies.i."""
    tokens = source.tokens[first: last + 1]
    return (len(tokens) % 2 == 1 and all(each.kind == "name" for each in tokens[::2])
            and all(each.text == "." for each in tokens[1::2]))


def _of_statement(source, statement):
    first, last = statement.first, statement.last
    tokens = source.tokens[first: last + 1]
    if len(tokens) < 2 or tokens[0].passive:
        return
    old, begin = _text(source, first, last), tokens[0].begin
    if tokens[0].text in JUMPS:
        if statement.after_if:
            yield "return", begin, old, ";"
        return
    if tokens[0].text in ("const", "constexpr", "static") or tokens[0].text in NUMBERS:
        yield from _of_declaration(source, first, last)
    if _is_expression(source, first, last):
        yield "deletion", begin, old, ";"


def _is_expression(source, first, last):
    """An assignment, an increment or a call, not a declaration."""
    at, previous = first, None
    if source.tokens[first].text in NO_STATEMENT:
        return False
    acts = False
    while at < last:
        token = source.tokens[at]
        if previous is not None and token.kind == "name" and (
                previous.kind == "name" or previous.bracket or previous.text in ("*", "&", "&&")
                and not acts):
            return False  # two names: a type and a variable
        if re.fullmatch(r"[-+*/%&|^]?=|<<=|>>=|\+\+|--", token.text):
            return True
        if token.text == "(":
            acts = True
        previous = token
        if token.text in "([{":
            at = source.partner.get(at, at)
            previous = source.tokens[at]
        at += 1
    return acts


def _of_declaration(source, first, last):
    """The sign of the initial value of a number."""
    words = source.words(first, last - first + 1)
    if not NUMBERS & set(words[:3]) or "=" not in words:
        return
    at = first + words.index("=") + 1
    value = source.tokens[at]
    if value.kind == "name" and value.text not in BOOLEANS and not value.passive:
        yield "sign", value.begin, value.text, f"-{value.text}"
