# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""What the page asks of the topics of running robots: their sizes and rates."""

from __future__ import annotations

import asyncio
import math

import msgspec
from starlette.requests import Request
from starlette.responses import Response

from smarttestudo.domain.errors import TestudoError, UsageError
from smarttestudo.web.bodies import read_body
from smarttestudo.web.errors import JSON
from smarttestudo.web.long_work import while_asked, worked_out
from smarttestudo.web.robot_schemas import MeasureLiveRequest
from smarttestudo.web.schemas import Progress, TextAnswer
from smarttestudo.web.socket import Listeners

MAX_SECONDS = 60.0
_PROCESS = "smarttestudo.composition.ruler.measuring_process"
# For the first topic to be seen, and for the process to begin and end.
_FIRST_TOPIC_S = 5.0
_MARGIN_S = 30.0


class MeasureApi:
    """Measures one at a time: it subscribes to everything."""

    def __init__(self, listeners: Listeners) -> None:
        self._listeners = listeners
        self._turn = asyncio.Semaphore(1)

    async def answer(self, request: Request) -> Response:
        """A profile of what is published now; who leaves ends it."""
        order = await read_body(request, MeasureLiveRequest)
        if not (math.isfinite(order.seconds) and 1 <= order.seconds <= MAX_SECONDS):
            raise UsageError(f"robots are measured for 1 to {MAX_SECONDS:g} s", place="seconds")
        answer = await while_asked(
            request,
            self._measured(order),
            timeout_s=2 * (order.seconds + _FIRST_TOPIC_S) + _MARGIN_S,
            too_long=TestudoError("measuring does not come to an end", remedy="try fewer seconds"),
        )
        return Response(msgspec.json.encode(answer), media_type=JSON)

    async def _measured(self, order: MeasureLiveRequest) -> TextAnswer:
        async with self._turn:
            return await worked_out(
                _PROCESS,
                {"seconds": order.seconds, "timeout_s": _FIRST_TOPIC_S},
                TextAnswer,
                lambda share: self._listeners.tell(Progress(run=order.run, share=share)),
            )
