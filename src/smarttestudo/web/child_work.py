# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""Work that takes long, each in a process of its own that ends with who asked for it."""

from __future__ import annotations

import asyncio
import sys
from asyncio.subprocess import DEVNULL, PIPE, Process
from dataclasses import dataclass
from typing import TypeVar

import msgspec
from starlette.requests import Request
from starlette.responses import Response

from smarttestudo.domain.errors import TestudoError
from smarttestudo.web.errors import JSON, RequestError
from smarttestudo.web.schemas import Progress
from smarttestudo.web.socket import Listeners

_MAX_LINE_BYTES = 50_000_000
_GONE = 499
_TIMED_OUT = 504
_Result = TypeVar("_Result", bound=msgspec.Struct)


class _Share(msgspec.Struct, tag_field="kind", tag="progress"):
    share: float


class _Done(msgspec.Struct, tag_field="kind", tag="result"):
    result: msgspec.Raw


class _Failure(msgspec.Struct, tag_field="kind", tag="error"):
    message: str
    place: str | None
    remedy: str | None


@dataclass(frozen=True, slots=True, kw_only=True)
class Order:
    """What the process of a module is to do with ``fields``, within ``timeout_s``.

    ``run`` is how the page calls it where it is told how far it is; ``too_long`` and ``broken`` are said of
    work that takes longer, and of a process that ended without a word.
    """

    module: str
    fields: dict[str, object]
    run: str
    timeout_s: float
    too_long: TestudoError
    broken: TestudoError


class ChildWork:
    """Does one order at a time; ``listeners`` are told how far it is."""

    def __init__(self, listeners: Listeners) -> None:
        self._listeners = listeners
        self._turn = asyncio.Semaphore(1)

    async def answer(self, request: Request, order: Order, kind: type[_Result]) -> Response:
        """The result as ``kind``; ``TestudoError`` where there is none. Who leaves ends the work."""
        work = asyncio.ensure_future(self._done(order, kind))
        leaving = asyncio.ensure_future(_left(request))
        try:
            done, _ = await asyncio.wait(
                {work, leaving}, timeout=order.timeout_s, return_when=asyncio.FIRST_COMPLETED
            )
            if work in done:
                return Response(msgspec.json.encode(work.result()), media_type=JSON)
            if leaving in done:
                raise RequestError("the page has gone", _GONE)
            raise RequestError(order.too_long.cause, _TIMED_OUT, remedy=order.too_long.remedy)
        finally:
            for one in (work, leaving):
                one.cancel()
            await asyncio.gather(work, leaving, return_exceptions=True)

    async def _done(self, order: Order, kind: type[_Result]) -> _Result:
        async with self._turn:
            command = (sys.executable, "-m", order.module)
            process = await asyncio.create_subprocess_exec(
                *command, stdin=PIPE, stdout=PIPE, stderr=DEVNULL, limit=_MAX_LINE_BYTES
            )
            try:
                return await self._followed(process, order, kind)
            finally:
                if process.returncode is None:
                    process.kill()
                    await process.wait()

    async def _followed(self, process: Process, order: Order, kind: type[_Result]) -> _Result:
        if process.stdin is None or process.stdout is None:
            raise TestudoError("the work has no pipes")
        process.stdin.write(msgspec.json.encode(order.fields))
        process.stdin.write_eof()
        async for line in process.stdout:
            match msgspec.json.decode(line, type=_Share | _Done | _Failure):
                case _Share(share=share):
                    self._listeners.tell(Progress(run=order.run, share=share))
                case _Done(result=result):
                    return msgspec.json.decode(result, type=kind)
                case _Failure(message=message, place=place, remedy=remedy):
                    raise TestudoError(message, place=place, remedy=remedy)
        raise order.broken


async def _left(request: Request) -> None:
    """Returns once the page that asked has gone."""
    while (await request.receive())["type"] != "http.disconnect":
        pass
