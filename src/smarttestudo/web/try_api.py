# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""What the page asks of a bag: what its rules would have done."""

from __future__ import annotations

from starlette.requests import Request
from starlette.responses import Response

from smarttestudo.adapters.files.project_folder import ProjectFolder
from smarttestudo.web.errors import RequestError
from smarttestudo.web.socket import Listeners


class TryApi:
    """Tries rules on the bags of ``folder``."""

    def __init__(self, folder: ProjectFolder, listeners: Listeners) -> None:
        self._folder = folder
        self._listeners = listeners

    async def answer(self, request: Request) -> Response:
        """Replay a bag."""
        raise RequestError("not yet", 501)
