# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""Work that takes seconds or minutes: each in a process that ends with the page that asked for it."""

from __future__ import annotations

import asyncio
import sys
from asyncio.subprocess import DEVNULL, PIPE, Process
from collections.abc import Callable, Coroutine
from typing import Any, TypeVar

import msgspec
from starlette.requests import Request

from smarttestudo.domain.errors import TestudoError
from smarttestudo.web.errors import RequestError

_MAX_LINE_BYTES = 50_000_000
_GONE = 499
_TIMED_OUT = 504
_Result = TypeVar("_Result")


class _Share(msgspec.Struct, tag_field="kind", tag="progress"):
    share: float


class _Done(msgspec.Struct, tag_field="kind", tag="result"):
    result: msgspec.Raw


class _Failure(msgspec.Struct, tag_field="kind", tag="error"):
    message: str
    place: str | None
    remedy: str | None


async def while_asked(
    request: Request, work: Coroutine[Any, Any, _Result], *, timeout_s: float, too_long: TestudoError
) -> _Result:
    """What ``work`` gives, as long as the page that sent ``request`` waits for it.

    Raises ``too_long`` after ``timeout_s``, as a ``RequestError``.
    """
    task = asyncio.ensure_future(work)
    leaving = asyncio.ensure_future(_left(request))
    try:
        done, _ = await asyncio.wait({task, leaving}, timeout=timeout_s, return_when=asyncio.FIRST_COMPLETED)
        if task in done:
            return task.result()
        if leaving in done:
            raise RequestError("the page has gone", _GONE)
        raise RequestError(too_long.cause, _TIMED_OUT, remedy=too_long.remedy)
    finally:
        for one in (task, leaving):
            one.cancel()
        await asyncio.gather(task, leaving, return_exceptions=True)


async def worked_out(
    module: str, order: object, kind: type[_Result], report: Callable[[float], None]
) -> _Result:
    """What the process of ``module`` makes of ``order``; ``report`` is told its share of the work.

    It reads JSON, and writes lines of JSON whose ``kind`` is ``progress`` (``share``), ``result``
    (``result``, of type ``kind``) or ``error`` (``message``, ``place``, ``remedy``: raised as
    ``TestudoError``). It is ended where the caller is cancelled.
    """
    process = await asyncio.create_subprocess_exec(
        sys.executable, "-m", module, stdin=PIPE, stdout=PIPE, stderr=DEVNULL, limit=_MAX_LINE_BYTES
    )
    try:
        return await _followed(process, order, kind, report)
    finally:
        if process.returncode is None:
            process.kill()
            await process.wait()


async def _followed(
    process: Process, order: object, kind: type[_Result], report: Callable[[float], None]
) -> _Result:
    if process.stdin is None or process.stdout is None:
        raise TestudoError("the process has no pipes")
    process.stdin.write(msgspec.json.encode(order))
    process.stdin.write_eof()
    async for line in process.stdout:
        match msgspec.json.decode(line, type=_Share | _Done | _Failure):
            case _Share(share=share):
                report(share)
            case _Done(result=result):
                return msgspec.json.decode(result, type=kind)
            case _Failure(message=message, place=place, remedy=remedy):
                raise TestudoError(message, place=place, remedy=remedy)
    raise TestudoError("the work ended without a result", remedy="try it on the command line")


async def _left(request: Request) -> None:
    """Returns once the page that asked has gone."""
    while (await request.receive())["type"] != "http.disconnect":
        pass
