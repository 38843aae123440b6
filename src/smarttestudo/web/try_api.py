# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""What the page asks of a bag: what its rules would have done."""

from __future__ import annotations

import asyncio
import sys
from asyncio.subprocess import DEVNULL, PIPE, Process

import msgspec
from starlette.concurrency import run_in_threadpool
from starlette.requests import Request
from starlette.responses import Response

from smarttestudo.adapters.files.project_folder import ProjectFolder
from smarttestudo.composition.ruler.checked_text import Draft, require_usable
from smarttestudo.domain.errors import TestudoError
from smarttestudo.web.bodies import read_body
from smarttestudo.web.errors import JSON, RequestError
from smarttestudo.web.schemas import Progress, TryAnswer, TryRequest
from smarttestudo.web.socket import Listeners

_PROCESS = "smarttestudo.composition.ruler.trial_process"
_TIMEOUT_S = 600.0
_MAX_LINE_BYTES = 50_000_000
_GONE = 499
_TIMED_OUT = 504


class _Share(msgspec.Struct, tag_field="kind", tag="progress"):
    share: float


class _Result(msgspec.Struct, tag_field="kind", tag="result"):
    trial: TryAnswer


class _Failure(msgspec.Struct, tag_field="kind", tag="error"):
    message: str
    place: str | None
    remedy: str | None


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
        task = asyncio.ensure_future(self._tried(draft, str(bag), order.run))
        leaving = asyncio.ensure_future(_left(request))
        try:
            done, _ = await asyncio.wait(
                {task, leaving}, timeout=_TIMEOUT_S, return_when=asyncio.FIRST_COMPLETED
            )
            if task in done:
                return Response(msgspec.json.encode(task.result()), media_type=JSON)
            if leaving in done:
                raise RequestError("the page has gone", _GONE)
            raise RequestError(
                "the bag takes longer than ten minutes", _TIMED_OUT, remedy="try a shorter one"
            )
        finally:
            for one in (task, leaving):
                one.cancel()
            await asyncio.gather(task, leaving, return_exceptions=True)

    async def _tried(self, draft: Draft, bag: str, run: str) -> TryAnswer:
        async with self._turn:
            process = await asyncio.create_subprocess_exec(
                sys.executable, "-m", _PROCESS, stdin=PIPE, stdout=PIPE, stderr=DEVNULL, limit=_MAX_LINE_BYTES
            )
            try:
                return await self._followed(process, draft, bag, run)
            finally:
                if process.returncode is None:
                    process.kill()
                    await process.wait()

    async def _followed(self, process: Process, draft: Draft, bag: str, run: str) -> TryAnswer:
        if process.stdin is None or process.stdout is None:
            raise TestudoError("the replay has no pipes")
        order = {
            "text": draft.text,
            "name": draft.name,
            "profile_text": draft.profile_text,
            "profile_name": draft.profile_name,
            "bag": bag,
        }
        process.stdin.write(msgspec.json.encode(order))
        process.stdin.write_eof()
        async for line in process.stdout:
            match msgspec.json.decode(line, type=_Share | _Result | _Failure):
                case _Share(share=share):
                    self._listeners.tell(Progress(run=run, share=share))
                case _Result(trial=trial):
                    return trial
                case _Failure(message=message, place=place, remedy=remedy):
                    raise TestudoError(message, place=place, remedy=remedy)
        raise TestudoError("the replay ended without a result", place=bag, remedy="try testudo replay on it")


async def _left(request: Request) -> None:
    """Returns once the page that asked has gone."""
    while (await request.receive())["type"] != "http.disconnect":
        pass
