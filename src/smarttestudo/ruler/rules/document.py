# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""A rule file as statements and findings, for the page."""

from __future__ import annotations

from collections.abc import Callable, Iterable
from dataclasses import dataclass
from functools import lru_cache
from pathlib import Path

from msgspec import Struct

from smarttestudo.checks import CheckContext, check_rules
from smarttestudo.domain import finding as checker
from smarttestudo.domain.errors import RuleFileError
from smarttestudo.domain.finding import Finding, Severity, Span
from smarttestudo.domain.profile import Profile
from smarttestudo.domain.units import counted
from smarttestudo.editing import CollectionPart, Document, comment_texts, read_document
from smarttestudo.ruler.job import job
from smarttestudo.ruler.rules.statement_trees import StatementWriter
from smarttestudo.ruler.rules.statements import Statement
from smarttestudo.rules.profile_file import parse_profile
from smarttestudo.rules.rule_sets import known_types

_TEXTS_KEPT = 4
WAY_TO_PROFILE = "choose or create a profile: its topic parameters say what each quality level is in Hz"


class Draft(Struct, frozen=True, kw_only=True):
    """A rule file as an editor holds it, with the text of its profile; findings call them by the names.

    Texts come and go whole.
    """

    text: str
    name: str = "rules.adirf"
    profile_text: str | None = None
    profile_name: str = "profile.toml"

    def profile(self) -> Profile | None:
        """The profile; ``ProfileError`` for one that cannot be read."""
        return (
            None if self.profile_text is None else parse_profile(self.profile_text, Path(self.profile_name))
        )


@dataclass(frozen=True, slots=True, kw_only=True)
class CheckedText:
    """The statements of a text, and the checker's findings."""

    document: Document
    findings: tuple[Finding, ...]

    @property
    def has_errors(self) -> bool:
        """Whether a finding stops the file from being used."""
        return any(finding.severity is Severity.ERROR for finding in self.findings)


class RefusedTextError(RuleFileError):
    """Rules with errors, which stay where they are."""

    status = 409

    def __init__(self, checked: CheckedText) -> None:
        errors = [one for one in checked.findings if one.severity is Severity.ERROR]
        super().__init__(
            f"the rules have {counted(len(errors), 'error')}: {errors[0].message}",
            place=f"{errors[0].path}:{errors[0].span.line}:{errors[0].span.column}",
            remedy="fix them first",
        )
        self.findings = placed_findings(checked.document, checked.findings)


def check_text(draft: Draft) -> CheckedText:
    """Read and check ``draft``; ``ProfileError`` for a profile that cannot be read."""
    document = read_document(draft.text, draft.name)
    profile = draft.profile()
    context = CheckContext(profile=profile, types=known_types(None, profile), way_to_profile=WAY_TO_PROFILE)
    return CheckedText(document=document, findings=tuple(check_rules([document.result], context)))


class CheckedTexts:
    """Texts of rule files, read and checked once however often the page asks about the last few."""

    def __init__(self) -> None:
        self._check: Callable[[Draft], CheckedText] = lru_cache(maxsize=_TEXTS_KEPT)(check_text)

    def checked(self, draft: Draft, text: str | None = None) -> CheckedText:
        """Checked text of a draft, or another ``text`` where one is given."""
        return self._check(
            Draft(
                text=draft.text if text is None else text,
                name=draft.name,
                profile_text=draft.profile_text,
                profile_name=draft.profile_name,
            )
        )


def require_usable(draft: Draft) -> CheckedText:
    """``check_text``, but ``RefusedTextError`` for rules with errors."""
    checked = check_text(draft)
    if checked.has_errors:
        raise RefusedTextError(checked)
    return checked


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


@job("POST /api/document", reads=True)
def document(draft: Draft, texts: CheckedTexts) -> RuleDocument:
    """Statements and findings of a text."""
    return rule_document(texts.checked(draft))


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
