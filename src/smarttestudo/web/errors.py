# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""Failures as answers."""

from __future__ import annotations

import msgspec
from starlette.responses import Response

from smarttestudo.adapters.files.project_folder import (
    ChangedFileError,
    ForbiddenPathError,
    MissingFileError,
)
from smarttestudo.composition.ruler.checked_text import RefusedTextError
from smarttestudo.domain.errors import TestudoError
from smarttestudo.domain.remote_parameters import SilentNodeError
from smarttestudo.web.document_json import finding_models
from smarttestudo.web.schemas import ErrorAnswer, Problem
from smarttestudo.web.statement_schemas import FindingModel

JSON = "application/json"
_STATUS: tuple[tuple[type[TestudoError], int], ...] = (
    (MissingFileError, 404),
    (ForbiddenPathError, 403),
    (ChangedFileError, 409),
    (RefusedTextError, 409),
    (SilentNodeError, 504),
)
_UNPROCESSABLE = 422


class RequestError(TestudoError):
    """A request that is refused before anything is done for it; ``status`` is its HTTP status."""

    def __init__(self, cause: str, status: int, *, remedy: str | None = None) -> None:
        super().__init__(cause, remedy=remedy)
        self.status = status


def error_answer(error: TestudoError) -> Response:
    """The answer that says what ``error`` says."""
    findings: tuple[FindingModel, ...] = ()
    if isinstance(error, RefusedTextError):
        findings = finding_models(error.checked.document, error.checked.findings)
    problem = Problem(
        message=error.cause, place=error.place or "", remedy=error.remedy or "", findings=findings
    )
    body = msgspec.json.encode(ErrorAnswer(error=problem))
    return Response(body, _status(error), media_type=JSON)


def _status(error: TestudoError) -> int:
    if isinstance(error, RequestError):
        return error.status
    return next((status for kind, status in _STATUS if isinstance(error, kind)), _UNPROCESSABLE)
