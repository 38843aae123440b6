# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""How little of an answer travels to the browser."""

from __future__ import annotations

import gzip
import hashlib
import re

from starlette.requests import Request
from starlette.responses import Response

from smarttestudo.ruler.server.errors import JSON

_LEAST_BYTES = 1000
_LEVEL = 5
_TAG_BYTES = 12
_NOT_MODIFIED = 304
_ASK_AGAIN = "private, no-cache"
_NEVER = re.compile(r"q=0(\.0*)?")


def taken_encodings(accepted: str) -> frozenset[str]:
    """The encodings that an ``Accept-Encoding`` allows."""
    parts = (each.strip().lower().partition(";") for each in accepted.split(","))
    return frozenset(name.strip() for name, _, weight in parts if not _NEVER.fullmatch(weight.strip()))


def json_answer(request: Request, body: bytes) -> Response:
    """JSON, compressed where that is worth it and the browser takes it; what it has of a GET is not sent."""
    headers = {"Vary": "Accept-Encoding"}
    if request.method == "GET":
        headers |= {"ETag": _tag(body), "Cache-Control": _ASK_AGAIN}
        if request.headers.get("if-none-match") == headers["ETag"]:
            return Response(status_code=_NOT_MODIFIED, headers=headers)
    if len(body) < _LEAST_BYTES or "gzip" not in taken_encodings(request.headers.get("accept-encoding", "")):
        return Response(body, media_type=JSON, headers=headers)
    packed = gzip.compress(body, _LEVEL, mtime=0)
    return Response(packed, media_type=JSON, headers={**headers, "Content-Encoding": "gzip"})


def _tag(body: bytes) -> str:
    """A weak tag, for the compressed answer has the same."""
    return f'W/"{hashlib.blake2b(body, digest_size=_TAG_BYTES).hexdigest()}"'
