# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""Errors as the page is told of them."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from types import MappingProxyType

from msgspec import Struct

from smarttestudo.domain.errors import ProfileError, TestudoError
from smarttestudo.domain.parameter import SilentNodeError
from smarttestudo.optimizer.model import MissingEntryError
from smarttestudo.ruler.rules.document import PlacedFinding

_UNPROCESSABLE, _NO_ANSWER = 422, 504
COLUMNS: Mapping[str, str] = MappingProxyType(
    {
        "message_kb": "Message size (KB)",
        "tiers_hz": "the six levels (Hz)",
        "source_hz": "Source (Hz)",
        "max_hz": "Source (Hz)",
    }
)
"""What the table of topic parameters calls an entry."""


class Problem(Struct, frozen=True, kw_only=True):
    """Why something was refused; ``place`` and ``remedy`` may be empty.

    ``findings`` say why, where rules with errors were refused.
    """

    message: str
    place: str
    remedy: str
    findings: tuple[PlacedFinding, ...]


class ErrorAnswer(Struct, frozen=True, kw_only=True):
    """The body of every answer that is an error."""

    error: Problem


def problem_of(error: TestudoError, shown: Callable[[str], str] = str) -> tuple[int, Problem]:
    """The HTTP status of ``error``, and its words; ``shown`` is a place as the project calls it."""
    said = _in_page_words(error)
    problem = Problem(
        message=said.cause,
        place=shown(said.place or ""),
        remedy=said.remedy or "",
        findings=getattr(error, "findings", ()),
    )
    usual = _NO_ANSWER if isinstance(error, SilentNodeError) else _UNPROCESSABLE
    return getattr(error, "status", usual), problem


def _in_page_words(error: TestudoError) -> TestudoError:
    """``error`` with a remedy that is possible on the page, where a profile is a table and no TOML."""
    if not isinstance(error, MissingEntryError):
        return error
    if error.topic is None:
        cause = "the topic parameters do not say how much the link carries"
        return ProfileError(
            cause, place=error.place, remedy="fill in the budget, Total bandwidth (KB/s), above their table"
        )
    if error.key is None:
        cause = f"{error.topic} is in the rules but not in the chosen profile"
        remedy = f"add a row for {error.topic} to its table, or choose another profile on the right"
        return ProfileError(cause, place=error.place, remedy=remedy)
    cause = f"the topic parameters do not say all that is needed of {error.topic}"
    remedy = f"fill in {COLUMNS[error.key]} in its row of their table"
    return ProfileError(cause, place=error.place, remedy=remedy)
