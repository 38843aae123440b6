# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""What the page asks of a bag: what its rules would have done, and what each rate of a topic loses."""

from __future__ import annotations

from dataclasses import asdict

from starlette.concurrency import run_in_threadpool
from starlette.requests import Request
from starlette.responses import Response

from smarttestudo.adapters.files.project_folder import ProjectFolder
from smarttestudo.composition.ruler.checked_text import Draft, require_usable
from smarttestudo.domain.errors import TestudoError
from smarttestudo.domain.names import is_topic_name, resolve_topic
from smarttestudo.web.bodies import read_body
from smarttestudo.web.child_work import ChildWork, Order
from smarttestudo.web.curve_schemas import CurveAnswer, CurveRequest
from smarttestudo.web.errors import RequestError
from smarttestudo.web.socket import Listeners
from smarttestudo.web.try_schemas import TryAnswer, TryRequest

_TRIAL = "smarttestudo.composition.ruler.trial_process"
_CURVE = "smarttestudo.composition.ruler.curve_process"
_TIMEOUT_S = 600.0
_BAD_REQUEST = 400


class TryApi:
    """Tries rules on the bags of ``folder``, one at a time, each in a process that can be ended."""

    def __init__(self, folder: ProjectFolder, listeners: Listeners) -> None:
        self._folder = folder
        self._work = ChildWork(listeners)

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
        fields: dict[str, object] = {**asdict(draft), "bag": str(bag)}
        return await self._work.answer(request, _order(_TRIAL, fields, asked), TryAnswer)


class CurveApi:
    """Measures what topics of the bags of ``folder`` lose at each rate, one at a time."""

    def __init__(self, folder: ProjectFolder, listeners: Listeners) -> None:
        self._folder = folder
        self._work = ChildWork(listeners)

    async def answer(self, request: Request) -> Response:
        """Measure a topic of a bag; who leaves ends it."""
        asked = await read_body(request, CurveRequest)
        if not is_topic_name(asked.topic):
            raise RequestError(f"{asked.topic!r} is not a valid ROS 2 topic name", _BAD_REQUEST)
        bag = await run_in_threadpool(self._folder.bag, asked.bag)
        fields: dict[str, object] = {"bag": str(bag), "topic": resolve_topic(asked.topic)}
        return await self._work.answer(request, _order(_CURVE, fields, asked), CurveAnswer)


def _order(module: str, fields: dict[str, object], asked: TryRequest | CurveRequest) -> Order:
    return Order(
        module=module,
        fields=fields,
        run=asked.run,
        timeout_s=_TIMEOUT_S,
        too_long=TestudoError("the bag takes longer than ten minutes", remedy="try a shorter one"),
        broken=TestudoError(
            "reading the bag ended without a result", place=asked.bag, remedy="try testudo bag info on it"
        ),
    )
