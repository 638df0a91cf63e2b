# SPDX-License-Identifier: MIT
"""Tokens of a C++ header, its brackets and statements. Relies on the layout of clang-format:
a binary operator has white space on both sides, the bracket of a template argument list has none
before it."""

import dataclasses
import re

TOKEN = re.compile(
    r"""
      (?P<comment>//[^\n]*|/\*.*?\*/)
    | (?P<directive>^[ \t]*\#(?:\\\n|[^\n])*)
    | (?P<string>R"(?P<mark>[^(\s]*)\(.*?\)(?P=mark)"|"(?:\\.|[^"\\\n])*")
    | (?P<char>'(?:\\.|[^'\\\n])+')
    | (?P<number>0[xX][\da-fA-F']*(?:\.[\da-fA-F]*)?(?:[pP][+-]?\d+)?[a-zA-Z]*
        |(?:\d[\d']*\.?[\d']*|\.\d+)(?:[eE][+-]?\d+)?[a-zA-Z]*)
    | (?P<name>[A-Za-z_]\w*)
    | (?P<operator><=>|<<=|>>=|\.\.\.|->|::|\+\+|--|&&|\|\||[-+*/%&|^<>=!]=|<<|>>|[^\s\w])
    """,
    re.VERBOSE | re.DOTALL | re.MULTILINE,
)
CLOSING = {"(": ")", "[": "]", "{": "}"}
# Calls and declarations whose parentheses contain nothing to be mutated.
PASSIVE_CALLS = {"static_assert", "noexcept", "decltype", "alignas", "to_text",
                 "fail", "fail_as_unstable"}
CONTROL = {"if", "for", "while", "switch", "catch"}
JUMPS = {"return", "continue", "break"}


@dataclasses.dataclass
class Token:
    kind: str
    text: str
    begin: int
    line: int
    column: int
    passive: bool = False  # not to be mutated
    bracket: bool = False  # < or > of a template argument list

    @property
    def end(self):
        return self.begin + len(self.text)


@dataclasses.dataclass
class Statement:
    """Tokens [first, last] of the function body, the last one being the semicolon."""

    first: int
    last: int
    after_if: bool  # executed only if the condition of an if statement holds


class Source:
    def __init__(self, text):
        self.text = text
        self.tokens = list(self._scan())
        self.partner = {}  # index of an opening bracket → of the closing one, and vice versa
        self.body = [False] * len(self.tokens)  # whether a token is in the body of a function
        self.statements = []
        self._find_template_brackets()
        self._match()
        self._mark_passive()
        _Bodies(self).read()

    def _scan(self):
        line, start = 1, 0  # of the line
        position = 0
        for match in TOKEN.finditer(self.text):
            line += self.text.count("\n", position, match.start())
            position = match.start()
            start = self.text.rfind("\n", 0, position) + 1
            if match.lastgroup in ("comment", "directive"):
                continue
            kind = "string" if match["string"] is not None else match.lastgroup
            yield Token(kind, match.group(), position, line, position - start + 1)

    def spaced(self, index):
        """Whether the token has white space on both sides."""
        token = self.tokens[index]
        return (self.text[token.begin - 1: token.begin].isspace()
                and self.text[token.end: token.end + 1].isspace())

    def words(self, index, count=1):
        """The texts of the tokens from this index on."""
        return [token.text for token in self.tokens[max(index, 0): index + count]]

    def _find_template_brackets(self):
        for index, token in enumerate(self.tokens):
            if token.text != "<" or token.bracket or index == 0:
                continue
            before = self.tokens[index - 1]
            directly = before.end == token.begin and before.kind == "name" or before.text == "]"
            if before.text == "template" or directly and before.text != "operator":
                self._mark_angles(index)

    def _mark_angles(self, index):
        """Marks the tokens of a template argument list, which are passive."""
        depth, round_ones, first = 0, 0, index
        for at in range(index, len(self.tokens)):
            text = self.tokens[at].text
            if text in ("(", "{", "["):
                round_ones += 1
            elif text in (")", "}", "]"):
                round_ones -= 1
                if round_ones < 0:
                    return  # no template argument list
            elif round_ones == 0 and text == "<":
                depth += 1
            elif round_ones == 0 and text in (">", ">>", ">="):
                depth -= text.count(">")
            if depth <= 0:
                for token in self.tokens[first: at + 1]:
                    token.passive = True
                    token.bracket = token.bracket or token.text in ("<", ">", ">>")
                return

    def _match(self):
        open_ones = []
        for index, token in enumerate(self.tokens):
            if token.kind != "operator":
                continue
            if token.text in CLOSING:
                open_ones.append(index)
            elif token.text in CLOSING.values() and open_ones:
                self.partner[index] = open_ones.pop()
                self.partner[self.partner[index]] = index

    def _mark(self, first, last):
        for token in self.tokens[first: last + 1]:
            token.passive = True

    def _mark_passive(self):
        for index, token in enumerate(self.tokens):
            following = self.words(index + 1)
            if token.text in PASSIVE_CALLS and following == ["("]:
                self._mark(index + 1, self.partner.get(index + 1, index))
            elif token.text == "[" and following == ["["]:
                self._mark(index, self.partner.get(index, index))
            elif token.text == "operator":
                self._mark(index, index + 1)
            elif token.text in ("using", "typedef", "concept", "throw"):
                self._mark(index, self._end_of_statement(index))
            elif token.text == "requires":
                self._mark(index, self._end_of_constraint(index))

    def _end_of_statement(self, index):
        while index < len(self.tokens) - 1 and self.tokens[index].text != ";":
            index = self.partner.get(index, index) if self.tokens[index].text in CLOSING else index
            index += 1
        return index

    def _end_of_constraint(self, index):
        """Last token of a requires clause or expression."""
        at = index + 1
        while at < len(self.tokens):
            while self.words(at) in (["!"], ["requires"]):
                at += 1
            if self.words(at) == ["("]:
                at = self.partner.get(at, at) + 1
            if self.words(at) == ["{"] and "requires" in self.words(index, at - index):
                if index == at - 1 or self.tokens[index + 1].text == "(":  # an expression
                    return self.partner.get(at, at)
            while at < len(self.tokens) and (self.tokens[at].kind == "name" or
                                             self.tokens[at].text == "::"):
                at += 1
                if self.words(at) == ["<"] and self.tokens[at].bracket:
                    while self.tokens[at].passive and not self._closes_list(at):
                        at += 1
                    at += 1
            if self.words(at) in (["&&"], ["||"]):
                at += 1
                continue
            return at - 1
        return len(self.tokens) - 1

    def _closes_list(self, index):
        """Whether this ends a template argument list that is not inside another one."""
        return self.tokens[index].text.startswith(">") and (
            index + 1 >= len(self.tokens) or not self.tokens[index + 1].passive)


@dataclasses.dataclass
class _Frame:
    kind: str  # code: statements; declarations: members or names; other: an expression
    start: int  # first token of the present statement
    after_if: bool = False  # the whole block
    conditional: bool = False  # the present statement


class _Bodies:
    """Finds the bodies of functions and their statements."""

    def __init__(self, source):
        self.source = source
        self.tokens = source.tokens
        self.frames = [_Frame("declarations", 0)]

    def read(self):
        for index, token in enumerate(self.tokens):
            frame = self.frames[-1]
            self.source.body[index] = any(each.kind == "code" for each in self.frames)
            if token.kind == "operator":
                self._step(index, token.text, frame)
            elif frame.kind == "code" and frame.start == index:
                if token.text in ("else", "do", "try"):
                    frame.start = index + 1
                    frame.conditional = token.text == "else"

    def _step(self, index, text, frame):
        if text in "([":
            self.frames.append(_Frame("other", index + 1))
        elif text == "{":
            kind = self._kind_of_block(index, frame)
            self.frames.append(_Frame(kind, index + 1, after_if=frame.conditional))
        elif text in ")]}" and len(self.frames) > 1:
            closed = self.frames.pop()
            self._after_bracket(index, text, closed)
        elif text == ";":
            if frame.kind == "code":
                self.source.statements.append(
                    Statement(frame.start, index, frame.conditional or frame.after_if))
            if frame.kind != "other":
                self._begin(frame, index + 1)
        elif text == ":" and frame.kind == "code":
            if self.tokens[frame.start].text in ("case", "default"):
                self._begin(frame, index + 1)
        elif text == ":" and frame.kind == "declarations":
            if self.tokens[index - 1].text in ("public", "private", "protected"):
                self._begin(frame, index + 1)

    def _begin(self, frame, index, conditional=False):
        frame.start, frame.conditional = index, conditional

    def _after_bracket(self, index, text, closed):
        frame = self.frames[-1]
        opening = self.source.partner.get(index, index)
        if text == ")" and frame.kind == "code":
            head = self.source.words(opening - 2, 2)
            if head and head[-1] in CONTROL or head == ["if", "constexpr"]:
                if self._is_head(frame, opening):
                    self._begin(frame, index + 1, conditional="if" in head)
        elif text == "}":
            block = closed.kind == "declarations" or closed.kind == "code" and (
                frame.kind == "declarations" or frame.start == opening)
            if block and frame.kind != "other":
                self._begin(frame, index + 1)

    def _is_head(self, frame, opening):
        """Whether the parenthesis belongs to the first word of the statement."""
        return self.tokens[frame.start].text in CONTROL and opening - frame.start <= 2

    def _kind_of_block(self, index, frame):
        head = self.tokens[frame.start: index]
        texts = [token.text for token in head]
        if frame.kind == "code" and not head:
            return "code"
        if frame.kind == "declarations":
            if not _before_parenthesis(texts) & {"="} and "enum" in texts:
                return "other"
            plain = [token.text for token in head if not token.passive]
            if "(" not in plain and set(plain) & {"class", "struct", "union", "namespace"}:
                return "declarations"
        before = texts[-1] if texts else ""
        if before in (")", "]", "const", "mutable", "noexcept", "override", "}"):
            return "code"
        if "->" in texts[-10:] or before == ">" and frame.kind == "declarations" and "(" in texts:
            return "code"
        return "other"


def _before_parenthesis(texts):
    return set(texts[: texts.index("(")] if "(" in texts else texts)
