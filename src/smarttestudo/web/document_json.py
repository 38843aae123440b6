# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""A checked rule file as JSON."""

from __future__ import annotations

from collections.abc import Iterable

from smarttestudo.adirf.document import Document, Part, comment_texts
from smarttestudo.composition.ruler.checked_text import CheckedText
from smarttestudo.domain.finding import Finding, Fix
from smarttestudo.domain.source import Span
from smarttestudo.web.statement_json import StatementWriter
from smarttestudo.web.statement_schemas import CollectionModel, DocumentModel, FindingModel, FixModel


def document_model(checked: CheckedText) -> DocumentModel:
    """The statements of a text, and all that the checker says."""
    document = checked.document
    writer = StatementWriter(document)
    return DocumentModel(
        collections=tuple(_collection(part, writer) for part in document.parts),
        findings=finding_models(document, checked.findings),
        parses=document.result.is_valid,
    )


def finding_models(document: Document, findings: Iterable[Finding]) -> tuple[FindingModel, ...]:
    """``findings`` of the one file ``document``, numbered in their order."""
    writer = StatementWriter(document)
    return tuple(_finding(index, one, document, writer) for index, one in enumerate(findings))


def _collection(part: Part, writer: StatementWriter) -> CollectionModel:
    begin = part.begin
    comments = begin.comments if begin is not None else ()
    return CollectionModel(
        id=part.id,
        is_written=begin is not None,
        offset=writer.offset(part.start),
        end_offset=writer.offset(part.end),
        line=part.line,
        comments=tuple(comment_texts(comments)),
        statements=tuple(writer.entry(entry) for entry in part.entries),
    )


def _finding(index: int, finding: Finding, document: Document, writer: StatementWriter) -> FindingModel:
    span = finding.span
    start, end = writer.range(span)
    statement = _statement(document, span)
    related = {_statement(document, other): None for other in finding.related}
    return FindingModel(
        index=index,
        code=finding.code,
        severity=finding.severity.value,
        message=finding.message,
        hint=finding.hint,
        line=span.line,
        column=span.column,
        end_line=span.end_line,
        end_column=span.end_column,
        offset=start,
        end_offset=end,
        fix=None if finding.fix is None else _fix(finding.fix, writer),
        statement=statement,
        related=tuple(one for one in related if one is not None and one != statement),
    )


def _statement(document: Document, span: Span) -> str | None:
    entry = document.entry_at(document.places.range(span)[0])
    return None if entry is None else entry.id


def _fix(fix: Fix, writer: StatementWriter) -> FixModel:
    start, end = writer.range(fix.span)
    return FixModel(title=fix.title, offset=start, end_offset=end, replacement=fix.replacement)
