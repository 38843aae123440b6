# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""Work that takes long, each in a process of its own that ends with who asked for it."""

from __future__ import annotations

import asyncio
import sys
from asyncio.subprocess import DEVNULL, PIPE, Process
from dataclasses import dataclass

import msgspec
from starlette.requests import Request
from starlette.responses import Response

from smarttestudo.domain.errors import TestudoError
from smarttestudo.use_cases.ruler.child_messages import Done, Failure, Share
from smarttestudo.use_cases.ruler.child_process import ChildWork
from smarttestudo.web.errors import GONE, JSON, RequestError
from smarttestudo.web.socket import Listeners, Progress

_MODULE = ChildWork.__module__
_MAX_LINE_BYTES = 50_000_000
_TIMED_OUT = 504


@dataclass(frozen=True, slots=True, kw_only=True)
class Order:
    """What the process that does ``work`` is asked, within ``timeout_s``.

    ``run`` is how the page calls it where it is told how far it is; ``too_long`` and ``broken`` are said of
    work that takes longer, and of a process that ended without a word.
    """

    work: ChildWork
    asked: msgspec.Struct
    run: str
    timeout_s: float
    too_long: TestudoError
    broken: TestudoError


class ChildProcesses:
    """Does one order at a time; ``listeners`` get its progress."""

    def __init__(self, listeners: Listeners) -> None:
        self._listeners = listeners
        self._turn = asyncio.Semaphore(1)

    async def answer(self, request: Request, order: Order) -> Response:
        """The result; ``TestudoError`` where there is none. Who leaves ends the work."""
        work = asyncio.ensure_future(self._done(order))
        leaving = asyncio.ensure_future(_left(request))
        try:
            done, _ = await asyncio.wait(
                {work, leaving}, timeout=order.timeout_s, return_when=asyncio.FIRST_COMPLETED
            )
            if work in done:
                return Response(work.result(), media_type=JSON)
            if leaving in done:
                raise RequestError("the page was closed", GONE)
            raise RequestError(order.too_long.cause, _TIMED_OUT, remedy=order.too_long.remedy)
        finally:
            for one in (work, leaving):
                one.cancel()
            await asyncio.gather(work, leaving, return_exceptions=True)

    async def _done(self, order: Order) -> bytes:
        async with self._turn:
            command = (sys.executable, "-m", _MODULE, order.work.value)
            process = await asyncio.create_subprocess_exec(
                *command, stdin=PIPE, stdout=PIPE, stderr=DEVNULL, limit=_MAX_LINE_BYTES
            )
            try:
                return await self._followed(process, order)
            finally:
                if process.returncode is None:
                    process.kill()
                    await process.wait()

    async def _followed(self, process: Process, order: Order) -> bytes:
        if process.stdin is None or process.stdout is None:
            raise TestudoError("the work has no pipes")
        process.stdin.write(msgspec.json.encode(order.asked))
        process.stdin.write_eof()
        async for line in process.stdout:
            match msgspec.json.decode(line, type=Share | Done | Failure):
                case Share(share=share):
                    self._listeners.tell(Progress(run=order.run, share=share))
                case Done(result=result):
                    return bytes(result)
                case Failure(message=message, place=place, remedy=remedy):
                    raise TestudoError(message, place=place, remedy=remedy)
        raise order.broken


async def _left(request: Request) -> None:
    """Returns once the page that asked has gone."""
    while (await request.receive())["type"] != "http.disconnect":
        pass
