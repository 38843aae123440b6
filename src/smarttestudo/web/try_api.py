# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""What the page asks of a bag: what its rules would have done."""

from __future__ import annotations

import asyncio

import msgspec
from starlette.concurrency import run_in_threadpool
from starlette.requests import Request
from starlette.responses import Response

from smarttestudo.adapters.files.project_folder import ProjectFolder
from smarttestudo.composition.ruler.checked_text import Draft, require_usable
from smarttestudo.domain.errors import TestudoError
from smarttestudo.web.bodies import read_body
from smarttestudo.web.errors import JSON
from smarttestudo.web.long_work import while_asked, worked_out
from smarttestudo.web.schemas import Progress, TryAnswer, TryRequest
from smarttestudo.web.socket import Listeners

_PROCESS = "smarttestudo.composition.ruler.trial_process"
_TIMEOUT_S = 600.0


class TryApi:
    """Tries rules on the bags of ``folder``, one at a time, each in a process that can be ended."""

    def __init__(self, folder: ProjectFolder, listeners: Listeners) -> None:
        self._folder = folder
        self._listeners = listeners
        self._turn = asyncio.Semaphore(1)

    async def answer(self, request: Request) -> Response:
        """Replay a bag; who leaves ends it."""
        order = await read_body(request, TryRequest)
        bag = await run_in_threadpool(self._folder.bag, order.bag)
        draft = Draft(
            text=order.text,
            name=order.name,
            profile_text=order.profile_text,
            profile_name=order.profile_name,
        )
        await run_in_threadpool(require_usable, draft)
        too_long = TestudoError("the bag takes longer than ten minutes", remedy="try a shorter one")
        tried = self._tried(draft, str(bag), order.run)
        answer = await while_asked(request, tried, timeout_s=_TIMEOUT_S, too_long=too_long)
        return Response(msgspec.json.encode(answer), media_type=JSON)

    async def _tried(self, draft: Draft, bag: str, run: str) -> TryAnswer:
        order = {
            "text": draft.text,
            "name": draft.name,
            "profile_text": draft.profile_text,
            "profile_name": draft.profile_name,
            "bag": bag,
        }
        async with self._turn:
            return await worked_out(
                _PROCESS,
                order,
                TryAnswer,
                lambda share: self._listeners.tell(Progress(run=run, share=share)),
            )
