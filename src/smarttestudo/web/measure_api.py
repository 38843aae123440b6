# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""What the page asks of the topics of running robots: their sizes and rates."""

from __future__ import annotations

import math

from starlette.requests import Request
from starlette.responses import Response

from smarttestudo.domain.errors import TestudoError, UsageError
from smarttestudo.use_cases.ruler.child_process import ChildWork, MeasureOrder
from smarttestudo.use_cases.ruler.profiles import MeasureLiveRequest
from smarttestudo.web.child_work import ChildProcesses, Order
from smarttestudo.web.socket import Listeners

MAX_SECONDS = 60.0
# For the first topic to be seen, and for the process to begin and end.
_FIRST_TOPIC_S = 5.0
_MARGIN_S = 30.0


class MeasureApi:
    """Measures one at a time: it subscribes to everything."""

    def __init__(self, listeners: Listeners) -> None:
        self._work = ChildProcesses(listeners)

    async def answer(self, request: Request, order: MeasureLiveRequest) -> Response:
        """A profile of what is published now; who leaves ends it."""
        if not (math.isfinite(order.seconds) and 1 <= order.seconds <= MAX_SECONDS):
            raise UsageError(f"robots are measured for 1 to {MAX_SECONDS:g} s", place="seconds")
        work = Order(
            work=ChildWork.MEASURE,
            asked=MeasureOrder(seconds=order.seconds, timeout_s=_FIRST_TOPIC_S),
            run=order.run,
            timeout_s=2 * (order.seconds + _FIRST_TOPIC_S) + _MARGIN_S,
            too_long=TestudoError("measuring did not finish", remedy="try fewer seconds"),
            broken=TestudoError("measuring ended without a result", remedy="try testudo profile --seconds"),
        )
        return await self._work.answer(request, work)
