# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""Places in a text file, findings of the checker there, and fixes for them."""

from __future__ import annotations

from dataclasses import dataclass
from enum import Enum
from typing import Annotated, NamedTuple

from smarttestudo.domain.record import JsonEntry


class Span(NamedTuple):
    """A stretch of text; lines and columns count from 1, the end column is one past the last character.

    A tuple, because reading a file makes one for each of its words.
    """

    line: int
    column: int
    end_line: int
    end_column: int

    def to(self, last: Span) -> Span:
        """The stretch from the start of this span to the end of ``last``."""
        return Span(self.line, self.column, last.end_line, last.end_column)


class Severity(Enum):
    """How much a finding matters; only errors stop a file from being used."""

    ERROR = "error"
    WARNING = "warning"
    INFO = "info"


@dataclass(frozen=True, slots=True, kw_only=True)
class Fix:
    """A change of text that mends a finding: replace what ``span`` covers by ``replacement``."""

    span: Annotated[Span, JsonEntry(is_merged=True)]
    replacement: str
    title: str


@dataclass(frozen=True, slots=True, kw_only=True)
class ProfileFix:
    """Fix of a finding in the profile: ``value`` for ``key`` of ``topic``; ``None`` takes it out."""

    topic: str
    key: str
    value: str | None
    title: str


@dataclass(frozen=True, slots=True, kw_only=True)
class Finding:
    """One thing the checker has to say about one place of a rule file.

    ``code`` is the finding's stable kebab-case name, ``path`` the file as the user named it,
    ``hint`` one sentence on what to do, or empty, ``related`` other places of the file that it speaks of.
    Of ``fix`` and ``profile_fix`` it has at most one.
    """

    code: str
    severity: Severity
    message: str
    path: str
    span: Annotated[Span, JsonEntry(is_merged=True)]
    hint: str = ""
    fix: Fix | None = None
    related: Annotated[tuple[Span, ...], JsonEntry(is_absent=True)] = ()
    profile_fix: Annotated[ProfileFix | None, JsonEntry(is_absent=True)] = None

    def line_of_text(self) -> str:
        """``file:line:column: severity[code]: message``, the form that editors understand."""
        place = f"{self.path}:{self.span.line}:{self.span.column}"
        return f"{place}: {self.severity.value}[{self.code}]: {self.message}"
