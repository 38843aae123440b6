# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""Failures as answers."""

from __future__ import annotations

from collections.abc import Callable

import msgspec
from starlette.responses import Response

from smarttestudo.domain.errors import TestudoError
from smarttestudo.domain.parameter import SilentNodeError
from smarttestudo.ruler.files.project_folder import (
    ChangedFileError,
    ForbiddenPathError,
    MissingFileError,
)
from smarttestudo.ruler.page_words import in_page_words
from smarttestudo.ruler.robots.watched_robots import UnknownRobotError
from smarttestudo.ruler.rules.document import PlacedFinding, RefusedTextError, placed_findings

JSON = "application/json"
GONE = 499
_STATUS: tuple[tuple[type[TestudoError], int], ...] = (
    (MissingFileError, 404),
    (UnknownRobotError, 404),
    (ForbiddenPathError, 403),
    (ChangedFileError, 409),
    (RefusedTextError, 409),
    (SilentNodeError, 504),
)
_UNPROCESSABLE = 422


class Problem(msgspec.Struct, frozen=True, kw_only=True):
    """Why something was refused; ``place`` and ``remedy`` may be empty.

    ``findings`` say why, where rules with errors were refused.
    """

    message: str
    place: str
    remedy: str
    findings: tuple[PlacedFinding, ...]


class ErrorAnswer(msgspec.Struct, frozen=True, kw_only=True):
    """The body of every answer that is an error."""

    error: Problem


class RequestError(TestudoError):
    """A request that is refused before anything is done for it; ``status`` is its HTTP status."""

    def __init__(self, cause: str, status: int, *, remedy: str | None = None) -> None:
        super().__init__(cause, remedy=remedy)
        self.status = status


def error_answer(error: TestudoError, shown: Callable[[str], str] = str) -> Response:
    """The response for ``error``; ``shown`` is a place as the project calls it."""
    findings: tuple[PlacedFinding, ...] = ()
    if isinstance(error, RefusedTextError):
        findings = placed_findings(error.checked.document, error.checked.findings)
    said = in_page_words(error)
    place = shown(said.place or "")
    problem = Problem(message=said.cause, place=place, remedy=said.remedy or "", findings=findings)
    body = msgspec.json.encode(ErrorAnswer(error=problem))
    return Response(body, _status(error), media_type=JSON)


def _status(error: TestudoError) -> int:
    if isinstance(error, RequestError):
        return error.status
    return next((status for kind, status in _STATUS if isinstance(error, kind)), _UNPROCESSABLE)
