# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""What the page asks of a bag: what its rules would have done, and what each rate of a topic loses."""

from __future__ import annotations

from msgspec.structs import replace
from starlette.concurrency import run_in_threadpool
from starlette.requests import Request
from starlette.responses import Response

from smarttestudo.adapters.files.project_folder import ProjectFolder
from smarttestudo.domain.errors import TestudoError
from smarttestudo.domain.names import is_topic_name, resolve_topic
from smarttestudo.use_cases.ruler.checked_text import require_usable
from smarttestudo.use_cases.ruler.child_process import ChildWork
from smarttestudo.use_cases.ruler.curve import CurveRequest
from smarttestudo.use_cases.ruler.trial import TryRequest
from smarttestudo.web.child_work import ChildProcesses, Order
from smarttestudo.web.errors import RequestError
from smarttestudo.web.socket import Listeners

_TIMEOUT_S = 600.0
_BAD_REQUEST = 400


class TryApi:
    """Tries rules on the bags of ``folder``, one at a time, each in a process that can be ended."""

    def __init__(self, folder: ProjectFolder, listeners: Listeners) -> None:
        self._folder = folder
        self._work = ChildProcesses(listeners)

    async def answer(self, request: Request, asked: TryRequest) -> Response:
        """Replay a bag; who leaves ends it."""
        bag = await run_in_threadpool(self._folder.bag, asked.bag)
        await run_in_threadpool(require_usable, asked)
        return await self._work.answer(
            request, _order(ChildWork.TRIAL, replace(asked, bag=str(bag)), asked.bag)
        )


class CurveApi:
    """Measures what topics of the bags of ``folder`` lose at each rate, one at a time."""

    def __init__(self, folder: ProjectFolder, listeners: Listeners) -> None:
        self._folder = folder
        self._work = ChildProcesses(listeners)

    async def answer(self, request: Request, asked: CurveRequest) -> Response:
        """Measure a topic of a bag; who leaves ends it."""
        if not is_topic_name(asked.topic):
            raise RequestError(f"{asked.topic!r} is not a valid ROS 2 topic name", _BAD_REQUEST)
        bag = await run_in_threadpool(self._folder.bag, asked.bag)
        order = replace(asked, bag=str(bag), topic=resolve_topic(asked.topic))
        return await self._work.answer(request, _order(ChildWork.CURVE, order, asked.bag))


def _order(work: ChildWork, asked: TryRequest | CurveRequest, name: str) -> Order:
    return Order(
        work=work,
        asked=asked,
        run=asked.run,
        timeout_s=_TIMEOUT_S,
        too_long=TestudoError("the bag takes longer than ten minutes", remedy="try a shorter one"),
        broken=TestudoError(
            "reading the bag ended without a result", place=name, remedy="try testudo bag info on it"
        ),
    )
