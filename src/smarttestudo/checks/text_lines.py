# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""Findings at places of trees, and the lines of the text that these are."""

from __future__ import annotations

from collections.abc import Mapping
from typing import NamedTuple

from smarttestudo.domain.dataclass import dataclass
from smarttestudo.domain.finding import Finding, Fix, ProfileFix, Severity
from smarttestudo.domain.source import Span
from smarttestudo.language.parser.line_numbers import LineNumbers


class LineOf(NamedTuple):
    """The line at which ``span`` of a tree starts in the file at ``path``, where a message tells it."""

    path: str
    span: Span


Words = tuple[str | LineOf, ...]
"""A message, with places in the stead of their lines, which move while it stays as it is."""


@dataclass(frozen=True, slots=True, kw_only=True)
class Found:
    """A finding without what all findings of its check share; its places are those of trees."""

    path: str
    span: Span
    message: str | Words
    hint: str = ""
    fix: Fix | None = None
    related: tuple[Span, ...] = ()
    profile_fix: ProfileFix | None = None

    @property
    def words(self) -> Words:
        """The message."""
        return (self.message,) if isinstance(self.message, str) else self.message


@dataclass(frozen=True, slots=True, kw_only=True)
class NumberedFinding:
    """A finding whose places are those of trees."""

    code: str
    severity: Severity
    found: Found

    @staticmethod
    def of(finding: Finding, lines: LineNumbers) -> NumberedFinding:
        """A finding of the parser, which has the lines of the text."""
        return NumberedFinding(
            code=finding.code,
            severity=finding.severity,
            found=Found(
                path=finding.path,
                span=lines.numbered(finding.span),
                message=finding.message,
                hint=finding.hint,
                fix=lines.numbered_fix(finding.fix),
            ),
        )


@dataclass(frozen=True, slots=True, kw_only=True)
class TextLines:
    """The lines of files by their path; a file that is not among them has those of its tree."""

    by_path: Mapping[str, LineNumbers]

    def line(self, place: LineOf) -> int:
        """The line of a place in its file."""
        lines = self.by_path.get(place.path)
        return place.span.line if lines is None else lines.line(place.span.line)

    def told(self, finding: NumberedFinding) -> Finding:
        """``finding`` at its place in the text."""
        found = finding.found
        lines = self.by_path.get(found.path)
        return Finding(
            code=finding.code,
            severity=finding.severity,
            message="".join(one if isinstance(one, str) else str(self.line(one)) for one in found.words),
            path=found.path,
            span=found.span if lines is None else lines.span(found.span),
            hint=found.hint,
            fix=found.fix if lines is None else lines.fix(found.fix),
            related=found.related if lines is None else tuple(map(lines.span, found.related)),
            profile_fix=found.profile_fix,
        )
