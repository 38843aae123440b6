# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""JSON of statements and findings, made once; an edit elsewhere only moves their places."""

from __future__ import annotations

import re
from collections.abc import Mapping, Sequence
from itertools import count, repeat

import msgspec

from smarttestudo.checks.text_lines import LineOf, NumberedFinding
from smarttestudo.domain.dataclass import dataclass
from smarttestudo.domain.source import Span
from smarttestudo.editing import Document, WrittenStatement
from smarttestudo.language.syntax import unnamed_label
from smarttestudo.ruler.answers.statement_trees import StatementWriter
from smarttestudo.ruler.answers.statements import RuleStatement, Statement

_LINE = re.compile(r'("line":)(\d+)')
_LINE_OR_LABEL = re.compile(rf'("line":|"label":"{unnamed_label(0)[:-1]})(\d+)')
"""A quote within a word has a backslash before it, so that no word looks like this."""


def json_form(value: object) -> str:
    """``value`` as JSON, to be formatted."""
    return msgspec.json.encode(value).decode().replace("%", "%%")


@dataclass(frozen=True, slots=True, kw_only=True)
class StatementText:
    """The JSON of a ``statement`` whose id, key and place are given later.

    ``lines`` are those that ``form`` tells behind them, counted from its own.
    """

    statement: Statement
    form: str
    lines: tuple[int, ...]

    @staticmethod
    def of(statement: Statement) -> StatementText:
        """The text of a statement without id and key, at the start of the text."""
        place = f',"id":"","key":"","offset":0,"end_offset":{statement.end_offset},"line":{statement.line}'
        head, _, rest = json_form(statement).partition(place)
        is_unnamed = (
            isinstance(statement, RuleStatement)
            and statement.name is None
            and statement.label == unnamed_label(statement.line)
        )
        between = (_LINE_OR_LABEL if is_unnamed else _LINE).split(rest)
        names = ',"id":"%s","key":"%s","offset":%d,"end_offset":%d,"line":%d'
        lines = (f"{name}%d{behind}" for name, behind in zip(between[1::3], between[3::3], strict=True))
        return StatementText(
            statement=statement,
            form="".join((head, names, between[0], *lines)),
            lines=tuple(int(line) - statement.line for line in between[2::3]),
        )

    def at(self, name: tuple[str, str], start: int, line: int) -> str:
        """The JSON of the statement with this id and key that starts at an offset, in a line."""
        end = start + self.statement.end_offset
        return self.form % (*name, start, end, line, *[line + one for one in self.lines])


@dataclass(frozen=True, slots=True, kw_only=True)
class StatementPlaces:
    """Where the statements of a text stand: ``numbers`` are those of the objects, ``ids`` their ids."""

    numbers: Mapping[int, int]
    names: Sequence[tuple[str, str]]
    starts: Sequence[int]
    lines: Sequence[int]

    @staticmethod
    def of(document: Document, writer: StatementWriter) -> StatementPlaces:
        """The places of a document's statements."""
        return StatementPlaces(
            numbers=dict(zip(map(id, document.written), count(), strict=False)),
            names=document.names,
            starts=writer.starts(document.starts),
            lines=document.result.lines.lines_of([line for line, _ in document.starts]),
        )


@dataclass(frozen=True, slots=True, kw_only=True)
class FindingText:
    """The JSON of a finding about the statement ``home``, whose places are counted from its start.

    ``told`` are the statements whose lines the message tells, ``related`` those that the finding names.
    """

    form: str
    home: WrittenStatement
    lines: tuple[int, int]
    offsets: tuple[int, ...]
    told: tuple[tuple[WrittenStatement, int], ...]
    related: tuple[WrittenStatement, ...]

    def at(self, places: StatementPlaces) -> str | None:
        """The JSON where the statements are now; ``None`` where one of them is another."""
        numbers, lines, names = places.numbers, places.lines, places.names
        try:
            home = numbers[id(self.home)]
            told = [lines[numbers[id(one)]] + by for one, by in self.told]
            related = [names[numbers[id(one)]][0] for one in self.related]
        except KeyError:
            return None
        line, start = lines[home], places.starts[home]
        first, last = self.lines
        offsets = [start + one for one in self.offsets]
        return self.form % (*told, line + first, line + last, *offsets, names[home][0], *related)


class FindingWriter:
    """Makes texts of findings about one document."""

    def __init__(self, document: Document, writer: StatementWriter, places: StatementPlaces) -> None:
        self._document = document
        self._path = document.result.numbered.path
        self._writer = writer
        self._places = places

    def text(self, finding: NumberedFinding) -> FindingText | None:
        """The text of a finding; ``None`` for one that speaks of other places than statements of the file."""
        found = finding.found
        home = self._number_of(found.path, found.span)
        told = [(self._number_of(*one), one) for one in found.words if isinstance(one, LineOf)]
        fixed = () if found.fix is None else self._writer.range(found.fix.span)
        is_fix_elsewhere = found.fix is not None and self._number_of(found.path, found.fix.span) != home
        if home is None or is_fix_elsewhere or any(at is None for at, _ in told):
            return None
        line, start = self._places.lines[home], self._places.starts[home]
        span = self._document.result.lines.span(found.span)
        others = dict.fromkeys(self._number_of(found.path, one) for one in found.related)
        related = [at for at in others if at is not None and at != home]
        return FindingText(
            form=_finding_form(finding, len(related)),
            home=self._written(home),
            lines=(span.line - line, span.end_line - line),
            offsets=tuple(one - start for one in (*self._writer.range(found.span), *fixed)),
            told=tuple((self._written(at), self._line_in(at, one)) for at, one in told if at is not None),
            related=tuple(map(self._written, related)),
        )

    def _number_of(self, path: str, span: Span) -> int | None:
        return self._document.number_of(span) if path == self._path else None

    def _written(self, number: int) -> WrittenStatement:
        return self._document.written[number]

    def _line_in(self, number: int, place: LineOf) -> int:
        return self._document.result.lines.line(place.span.line) - self._places.lines[number]


def _finding_form(finding: NumberedFinding, related: int) -> str:
    found = finding.found
    message = "".join(json_form(one)[1:-1] if isinstance(one, str) else "%d" for one in found.words)
    fix, name = "null", '"%s"'
    if found.fix is not None:
        replacement = json_form(found.fix.replacement)
        edit = f'{{"kind":"substitute","offset":%d,"end_offset":%d,"replacement":{replacement}}}'
        fix = f'{{"title":{json_form(found.fix.title)},"edit":{edit}}}'
    parts = {
        "code": json_form(finding.code),
        "severity": json_form(finding.severity),
        "message": f'"{message}"',
        "hint": json_form(found.hint),
        "line": "%d",
        "column": str(found.span.column),
        "end_line": "%d",
        "end_column": str(found.span.end_column),
        "offset": "%d",
        "end_offset": "%d",
        "fix": fix,
        "profile_fix": json_form(found.profile_fix),
        "statement": name,
        "related": f"[{','.join(repeat(name, related))}]",
    }
    entries = (f'"{key}":{part}' for key, part in parts.items())
    return f"{{{','.join(entries)}}}"
