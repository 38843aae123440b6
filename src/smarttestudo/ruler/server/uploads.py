# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""Recordings that a page sends, piece by piece."""

from __future__ import annotations

import msgspec
from starlette.concurrency import run_in_threadpool
from starlette.requests import Request
from starlette.responses import Response

from smarttestudo.ruler.files.recordings import ReceivedAnswer, Recordings
from smarttestudo.ruler.server.errors import JSON, RequestError
from smarttestudo.ruler.server.routes import Handler

_BYTES = "application/octet-stream"
_WRONG_TYPE = 415


def receiving(recordings: Recordings) -> Handler:
    """Writes the body as the new recording that the query names; whoever leaves early leaves nothing."""

    async def receive(request: Request) -> Response:
        # Only a page of this server can send this type, and a form of another site cannot.
        if request.headers.get("content-type") != _BYTES:
            raise RequestError("the body must be a file", _WRONG_TYPE, remedy=f"send Content-Type: {_BYTES}")
        name = request.query_params.get("name", "")
        with recordings.receiving(name) as write:
            async for piece in request.stream():
                await run_in_threadpool(write, piece)
        return Response(msgspec.json.encode(ReceivedAnswer(bag=name)), media_type=JSON)

    return receive
