# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""Incidents that a browser saves, piece by piece."""

from __future__ import annotations

from starlette.concurrency import run_in_threadpool
from starlette.requests import Request
from starlette.responses import Response, StreamingResponse

from smarttestudo.ruler.incidents.incidents import KnownIncidents
from smarttestudo.ruler.server.routes import Handler

_ZIP = "application/zip"


def sending_zip(known: KnownIncidents) -> Handler:
    """The incident that the query names as a .zip; where a file cannot be read, the answer breaks off."""

    async def send(request: Request) -> Response:
        # The name of the folder has neither quotes nor slashes.
        name, pieces = await run_in_threadpool(known.zipped, request.query_params.get("name", ""))
        headers = {"Content-Disposition": f'attachment; filename="{name}.zip"'}
        return StreamingResponse(pieces, media_type=_ZIP, headers=headers)

    return send
