# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""A checked rule file as the page has it: its statements, and the checker's findings."""

from __future__ import annotations

from collections.abc import Iterable

from msgspec import Struct

from smarttestudo.domain import finding as checker
from smarttestudo.domain.finding import Span
from smarttestudo.editing import CollectionPart, Document, comment_texts
from smarttestudo.ruler.rules.checked_text import CheckedText
from smarttestudo.ruler.rules.statement_trees import StatementWriter
from smarttestudo.ruler.rules.statements import Statement


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
    statements: tuple[Statement, ...]


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
    findings: tuple[PlacedFinding, ...]
    parses: bool


def rule_document(checked: CheckedText) -> RuleDocument:
    """The statements of a text, and all findings of the checker."""
    document = checked.document
    writer = StatementWriter(document)
    return RuleDocument(
        collections=tuple(_collection(part, writer) for part in document.parts),
        findings=placed_findings(document, checked.findings),
        parses=document.result.is_valid,
    )


def placed_findings(document: Document, findings: Iterable[checker.Finding]) -> tuple[PlacedFinding, ...]:
    """``findings`` of the one file ``document`` in their order."""
    writer = StatementWriter(document)
    return tuple(_finding(one, document, writer) for one in findings)


def _collection(part: CollectionPart, writer: StatementWriter) -> PlacedCollection:
    begin = part.begin
    comments = begin.comments if begin is not None else ()
    return PlacedCollection(
        id=part.id,
        is_written=begin is not None,
        offset=writer.offset(part.start),
        end_offset=writer.offset(part.end),
        line=part.line,
        comments=tuple(comment_texts(comments)),
        statements=tuple(writer.entry(entry) for entry in part.entries),
    )


def _finding(finding: checker.Finding, document: Document, writer: StatementWriter) -> PlacedFinding:
    span = finding.span
    start, end = writer.range(span)
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
        fix=None if finding.fix is None else _fix(finding.fix, writer),
        profile_fix=finding.profile_fix,
        statement=statement,
        related=tuple(one for one in related if one is not None and one != statement),
    )


def _statement(document: Document, span: Span) -> str | None:
    entry = document.entry_at(document.places.range(span)[0])
    return None if entry is None else entry.id


def _fix(fix: checker.Fix, writer: StatementWriter) -> PlacedFix:
    start, end = writer.range(fix.span)
    edit = Substitute(offset=start, end_offset=end, replacement=fix.replacement)
    return PlacedFix(title=fix.title, edit=edit)
