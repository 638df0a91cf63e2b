# SPDX-License-Identifier: MIT
"""The results of a campaign, one line per mutant, the answers to those that survived, and the
report."""

import collections
import csv
import io
import os
import pathlib
import re

FIELDS = ["key", "header", "line", "column", "operator", "old", "new", "result", "by", "seconds",
          "commit"]
KILLED, SURVIVED, NOT_COMPILED = "killed", "survived", "not compiled"
ANSWER = re.compile(r"^- `([0-9a-f]{12})`:? *(.*(?:\n  .*)*)", re.MULTILINE)
SHARE, COUNT = 0.9, 200  # promised


def one_line(text):
    return " ".join(text.split())


class Results:
    """Results of mutants by key. The last line of a mutant counts."""

    def __init__(self, path):
        self.path = pathlib.Path(path)
        self.rows = {}
        text = self.path.read_text(encoding="utf-8") if self.path.is_file() else ""
        whole = text[: text.rfind("\n") + 1]  # a line may be incomplete if the machine stopped
        self._rewrite = text != whole or not whole
        for row in csv.DictReader(io.StringIO(whole)):
            self.rows[row["key"]] = row

    def add(self, mutant, result, by, seconds, commit):
        row = dict(key=mutant.key, header=mutant.header, line=mutant.line, column=mutant.column,
                   operator=mutant.operator, old=one_line(mutant.old), new=one_line(mutant.new),
                   result=result, by=by, seconds=round(seconds), commit=commit)
        self.rows[mutant.key] = {name: str(value) for name, value in row.items()}
        self._append(row)

    def _append(self, row):
        if self._rewrite:
            text = self.path.read_text(encoding="utf-8") if self.path.is_file() else ""
            self.path.write_text(text[: text.rfind("\n") + 1] or ",".join(FIELDS) + "\n",
                                 encoding="utf-8")
            self._rewrite = False
        line = io.StringIO()
        csv.DictWriter(line, FIELDS, lineterminator="\n").writerow(row)
        with self.path.open("a", encoding="utf-8") as file:
            file.write(line.getvalue())
            file.flush()
            os.fsync(file.fileno())

    def having(self, *results):
        rows = list(self.rows.values())  # another thread may add one
        return [row for row in rows if row["result"] in results]

    def kills(self, header):
        """A function of a test source: how many mutants of the header and of its folder it has
        killed."""
        folder = header.rsplit("/", 1)[0] + "/"
        of_header, of_folder = collections.Counter(), collections.Counter()
        for row in self.having(KILLED):
            source = row["by"].split(":")[0]
            of_header[source] += row["header"] == header
            of_folder[source] += row["header"].startswith(folder)
        return lambda source: (of_header[source], of_folder[source])


def read_answers(path):
    """The answer to each mutant, by key."""
    path = pathlib.Path(path)
    text = path.read_text(encoding="utf-8") if path.is_file() else ""
    return {key: one_line(answer) for key, answer in ANSWER.findall(text)}


def _share(killed, survived):
    return f"{100 * killed / (killed + survived):.1f} %" if killed + survived else "-"


def report(results, answers):
    """Text, and whether what is promised holds."""
    table = collections.defaultdict(collections.Counter)
    for row in results.rows.values():
        for folder in (row["header"].split("/")[0], "all"):
            table[folder][row["result"]] += 1
    lines = ["| folder | killed | survived | not compiled | share killed |",
             "|---|---|---|---|---|"]
    for folder in sorted(table, key=lambda each: (each == "all", each)):
        count = table[folder]
        lines.append(f"| {folder} | {count[KILLED]} | {count[SURVIVED]} | {count[NOT_COMPILED]} | "
                     f"{_share(count[KILLED], count[SURVIVED])} |")
    survivors = sorted(results.having(SURVIVED),
                       key=lambda row: (row["header"], int(row["line"]), int(row["column"])))
    unanswered = [row for row in survivors if row["key"] not in answers]
    for title, rows in (("Survivors with an answer", [row for row in survivors
                                                      if row["key"] in answers]),
                        ("Survivors without an answer", unanswered)):
        lines += ["", f"{title}: {len(rows)}"]
        for row in rows:
            lines.append(f"- `{row['key']}` {row['header']}:{row['line']}:{row['column']} "
                         f"{row['operator']}: {row['old'][:90] or 'nothing'} → "
                         f"{row['new'][:90] or 'nothing'}")
            lines.append(f"  {answers.get(row['key']) or 'passed: ' + row['by']}")
    killed, survived = table["all"][KILLED], table["all"][SURVIVED]
    kept = (not unanswered and killed + survived >= COUNT
            and killed >= SHARE * (killed + survived))
    lines += ["", f"{killed} of {killed + survived} mutants that compile were killed, "
              f"{_share(killed, survived)}; promised: {SHARE:.0%} of {COUNT}, and an answer to "
              "each survivor"]
    return "\n".join(lines), kept
