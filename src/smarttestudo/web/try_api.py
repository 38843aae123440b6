# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""What the page asks of a bag: what its rules would have done, and what each rate of a topic loses."""

from __future__ import annotations

import asyncio
from dataclasses import asdict
from typing import TypeVar

import msgspec
from starlette.concurrency import run_in_threadpool
from starlette.requests import Request
from starlette.responses import Response

from smarttestudo.adapters.files.project_folder import ProjectFolder
from smarttestudo.composition.ruler.checked_text import Draft, require_usable
from smarttestudo.domain.errors import TestudoError
from smarttestudo.domain.names import is_topic_name, resolve_topic
from smarttestudo.web.bodies import read_body
from smarttestudo.web.curve_schemas import CurveAnswer, CurveRequest
from smarttestudo.web.errors import JSON, RequestError
from smarttestudo.web.long_work import while_asked, worked_out
from smarttestudo.web.schemas import Progress
from smarttestudo.web.socket import Listeners
from smarttestudo.web.try_schemas import TryAnswer, TryRequest

_TRIAL = "smarttestudo.composition.ruler.trial_process"
_CURVE = "smarttestudo.composition.ruler.curve_process"
_TIMEOUT_S = 600.0
_BAD_REQUEST = 400
_Answer = TypeVar("_Answer", bound=msgspec.Struct)


class TryApi:
    """Tries rules on the bags of ``folder``, one at a time, each in a process that can be ended."""

    def __init__(self, folder: ProjectFolder, listeners: Listeners) -> None:
        self._folder = folder
        self._work = _BagWork(listeners)

    async def answer(self, request: Request) -> Response:
        """Replay a bag; who leaves ends it."""
        asked = await read_body(request, TryRequest)
        bag = await run_in_threadpool(self._folder.bag, asked.bag)
        draft = Draft(
            text=asked.text,
            name=asked.name,
            profile_text=asked.profile_text,
            profile_name=asked.profile_name,
        )
        await run_in_threadpool(require_usable, draft)
        order: dict[str, object] = {**asdict(draft), "bag": str(bag)}
        return await self._work.answer(request, _TRIAL, order, TryAnswer, asked.run)


class CurveApi:
    """Measures what topics of the bags of ``folder`` lose at each rate, one at a time."""

    def __init__(self, folder: ProjectFolder, listeners: Listeners) -> None:
        self._folder = folder
        self._work = _BagWork(listeners)

    async def answer(self, request: Request) -> Response:
        """Measure a topic of a bag; who leaves ends it."""
        asked = await read_body(request, CurveRequest)
        if not is_topic_name(asked.topic):
            raise RequestError(f"{asked.topic!r} is not a valid ROS 2 topic name", _BAD_REQUEST)
        bag = await run_in_threadpool(self._folder.bag, asked.bag)
        order: dict[str, object] = {"bag": str(bag), "topic": resolve_topic(asked.topic)}
        return await self._work.answer(request, _CURVE, order, CurveAnswer, asked.run)


class _BagWork:
    """Does one order at a time; ``listeners`` are told how far it is."""

    def __init__(self, listeners: Listeners) -> None:
        self._listeners = listeners
        self._turn = asyncio.Semaphore(1)

    async def answer(
        self, request: Request, module: str, order: dict[str, object], kind: type[_Answer], run: str
    ) -> Response:
        """What the process of ``module`` makes of ``order``."""
        too_long = TestudoError("the bag takes longer than ten minutes", remedy="try a shorter one")
        work = self._done(module, order, kind, run)
        answer = await while_asked(request, work, timeout_s=_TIMEOUT_S, too_long=too_long)
        return Response(msgspec.json.encode(answer), media_type=JSON)

    async def _done(self, module: str, order: dict[str, object], kind: type[_Answer], run: str) -> _Answer:
        def report(share: float) -> None:
            self._listeners.tell(Progress(run=run, share=share))

        async with self._turn:
            return await worked_out(module, order, kind, report)
