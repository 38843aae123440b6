# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""A checked rule file as the page has it: its statements, and the checker's findings."""

from __future__ import annotations

from collections.abc import Iterator, Sequence

import msgspec
from msgspec import Struct
from msgspec.structs import replace

from smarttestudo.domain import finding as checker
from smarttestudo.domain.source import Span
from smarttestudo.editing import CollectionPart, Document, MadeLater, comment_texts
from smarttestudo.ruler.answers.answer_json import JsonList
from smarttestudo.ruler.answers.checked_text import CheckedText
from smarttestudo.ruler.answers.statement_texts import FindingWriter, StatementPlaces, StatementText
from smarttestudo.ruler.answers.statement_trees import StatementWriter, in_line
from smarttestudo.ruler.answers.statements import Statement


class PlacedCollection(Struct, frozen=True, kw_only=True):
    """``begin … end`` with its statements in order.

    ``is_written`` is false for statements and other text that stand outside any ``begin … end``.
    """

    id: str
    is_written: bool
    offset: int
    end_offset: int
    line: int
    comments: tuple[str, ...]
    statements: Sequence[Statement]


class Substitute(Struct, frozen=True, kw_only=True, tag_field="kind", tag="substitute"):
    """An edit: write ``replacement`` in the place of a part of the text."""

    offset: int
    end_offset: int
    replacement: str


class PlacedFix(Struct, frozen=True, kw_only=True):
    """Edit that mends a finding."""

    title: str
    edit: Substitute


class PlacedFinding(Struct, frozen=True, kw_only=True):
    """One finding of the checker.

    ``statement`` is the id of the statement it is about, ``related`` are those of others that it names.
    """

    code: str
    severity: checker.Severity
    message: str
    hint: str
    line: int
    column: int
    end_line: int
    end_column: int
    offset: int
    end_offset: int
    fix: PlacedFix | None
    profile_fix: checker.ProfileFix | None
    statement: str | None
    related: tuple[str, ...]


class RuleDocument(Struct, frozen=True, kw_only=True):
    """A rule file as statements and findings.

    An ``id`` names a statement of exactly this text. A ``key`` comes from the statement's words: it survives
    edits elsewhere and moves, so that block positions can be kept by it.
    """

    collections: tuple[PlacedCollection, ...]
    findings: Sequence[PlacedFinding]
    parses: bool


def rule_document(checked: CheckedText) -> RuleDocument:
    """The statements of a text, and all findings of the checker."""
    document = checked.document
    writer = StatementWriter(document)
    places = StatementPlaces.of(document, writer)
    known = document.recall.each(
        "statements for the page", lambda one: StatementText.of(writer.statement(one)), document.written
    )
    columns = (known, places.names, places.starts, places.lines)
    texts = document.recall.behind_change("texts of statements", StatementText.at, *columns)
    structs = MadeLater(len(texts), lambda: map(_at, *columns))
    return RuleDocument(
        collections=tuple(_collections(document.parts, writer, texts, structs)),
        findings=JsonList(
            list(_finding_texts(checked, writer, places)),
            MadeLater(len(checked.rules.numbered), lambda: placed_findings(document, checked.findings)),
        ),
        parses=document.result.is_valid,
    )


def _at(text: StatementText, name: tuple[str, str], start: int, line: int) -> Statement:
    """A statement with its id and key that starts at an offset, in a line."""
    statement = in_line(text.statement, line)
    end = start + statement.end_offset
    return replace(statement, id=name[0], key=name[1], offset=start, end_offset=end)


def _finding_texts(checked: CheckedText, writer: StatementWriter, places: StatementPlaces) -> Iterator[str]:
    """The findings as JSON."""
    document, findings = checked.document, checked.rules.numbered
    texts = FindingWriter(document, writer, places)
    known = document.recall.each("findings for the page", lambda one: [texts.text(one)], findings)
    for finding, kept in zip(findings, known, strict=True):
        text = None if kept[0] is None else kept[0].at(places)
        if text is None:
            kept[0] = texts.text(finding)
            text = None if kept[0] is None else kept[0].at(places)
        if text is None:
            placed = _finding(checked.rules.lines.told(finding), document, writer)
            text = msgspec.json.encode(placed).decode()
        yield text


def placed_findings(document: Document, findings: Sequence[checker.Finding]) -> tuple[PlacedFinding, ...]:
    """``findings`` of the one file ``document`` in their order."""
    writer = StatementWriter(document)
    return tuple(_finding(one, document, writer) for one in findings)


def _collections(
    parts: Sequence[CollectionPart],
    writer: StatementWriter,
    texts: Sequence[str],
    structs: Sequence[Statement],
) -> Iterator[PlacedCollection]:
    start = 0
    for part in parts:
        end = start + len(part.entries)
        yield PlacedCollection(
            id=part.id,
            is_written=part.begin is not None,
            offset=writer.offset(part.start),
            end_offset=writer.offset(part.end),
            line=part.line,
            comments=() if part.begin is None else tuple(comment_texts(part.begin.comments)),
            statements=JsonList(texts[start:end], MadeLater.part_of(structs, start, end)),
        )
        start = end


def _finding(finding: checker.Finding, document: Document, writer: StatementWriter) -> PlacedFinding:
    span = finding.span
    start, end = writer.range(document.numbered(span))
    statement = _statement(document, span)
    related = {_statement(document, other): None for other in finding.related}
    return PlacedFinding(
        code=finding.code,
        severity=finding.severity,
        message=finding.message,
        hint=finding.hint,
        line=span.line,
        column=span.column,
        end_line=span.end_line,
        end_column=span.end_column,
        offset=start,
        end_offset=end,
        fix=None if finding.fix is None else _fix(finding.fix, document, writer),
        profile_fix=finding.profile_fix,
        statement=statement,
        related=tuple(one for one in related if one is not None and one != statement),
    )


def _statement(document: Document, span: Span) -> str | None:
    entry = document.entry_at(span)
    return None if entry is None else entry.id


def _fix(fix: checker.Fix, document: Document, writer: StatementWriter) -> PlacedFix:
    start, end = writer.range(document.numbered(fix.span))
    edit = Substitute(offset=start, end_offset=end, replacement=fix.replacement)
    return PlacedFix(title=fix.title, edit=edit)
