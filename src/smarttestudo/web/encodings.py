# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""How answers are compressed on their way to the browser."""

from __future__ import annotations

import gzip
import re

from starlette.requests import Request
from starlette.responses import Response

from smarttestudo.web.errors import JSON

_LEAST_BYTES = 1000
_LEVEL = 5
_NEVER = re.compile(r"q=0(\.0*)?")


def taken_encodings(accepted: str) -> frozenset[str]:
    """The encodings that an ``Accept-Encoding`` allows."""
    parts = (each.strip().lower().partition(";") for each in accepted.split(","))
    return frozenset(name.strip() for name, _, weight in parts if not _NEVER.fullmatch(weight.strip()))


def json_answer(request: Request, body: bytes) -> Response:
    """JSON, compressed where that is worth it and the browser takes it."""
    vary = {"Vary": "Accept-Encoding"}
    if len(body) < _LEAST_BYTES or "gzip" not in taken_encodings(request.headers.get("accept-encoding", "")):
        return Response(body, media_type=JSON, headers=vary)
    packed = gzip.compress(body, _LEVEL, mtime=0)
    return Response(packed, media_type=JSON, headers={**vary, "Content-Encoding": "gzip"})
