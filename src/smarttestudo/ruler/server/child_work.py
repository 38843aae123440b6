# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""Work that takes long, each in a process of its own that ends with who asked for it."""

from __future__ import annotations

import asyncio
import math
import sys
from asyncio.subprocess import DEVNULL, PIPE, Process
from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path
from typing import TypeAlias

import msgspec
from msgspec.structs import replace
from starlette.concurrency import run_in_threadpool
from starlette.requests import Request
from starlette.responses import Response

from smarttestudo.domain.errors import TestudoError, UsageError
from smarttestudo.domain.names import is_topic_name, resolve_topic
from smarttestudo.ruler.answer_json import answer_json
from smarttestudo.ruler.child_messages import Done, Failure, Share
from smarttestudo.ruler.child_process import ChildWork, MeasureOrder
from smarttestudo.ruler.files.project_folder import ForbiddenPathError, ProjectFolder
from smarttestudo.ruler.incidents.incidents import IncidentCourseRequest, KnownIncidents
from smarttestudo.ruler.page_words import in_page_words
from smarttestudo.ruler.rules.document import require_usable
from smarttestudo.ruler.server.errors import GONE, RequestError
from smarttestudo.ruler.server.live import Listeners, Progress
from smarttestudo.ruler.server.routes import json_answer
from smarttestudo.ruler.topics.curves import CurveRequest
from smarttestudo.ruler.topics.profiles import MeasureLiveRequest
from smarttestudo.ruler.tries.check_course import (
    CheckCourseOrder,
    CheckCourseRequest,
    check_course_order,
)
from smarttestudo.ruler.tries.loss import TriedRecording
from smarttestudo.ruler.tries.try_rules import TryRequest

_MODULE = ChildWork.__module__
_MAX_LINE_BYTES = 50_000_000
_IDLE_S = 60.0
_TIMED_OUT = 504


@dataclass(frozen=True, slots=True, kw_only=True)
class Order:
    """Order to the process that does ``work`` within ``timeout_s``.

    ``run`` is how the page calls it where it is told how far it is; ``too_long`` and ``broken`` are said of
    work that takes longer, and of a process that ended without a word. ``name`` is what the page calls the
    recording at ``path``, if it is about one.
    """

    work: ChildWork
    asked: msgspec.Struct
    run: str
    timeout_s: float
    too_long: TestudoError
    broken: TestudoError
    path: str = ""
    name: str = ""

    def told(self, result: bytes) -> bytes:
        """JSON with the recording's name where texts begin with its path, as notices do."""
        return result.replace(_beginning(self.path), _beginning(self.name)) if self.path else result


def _beginning(text: str) -> bytes:
    return msgspec.json.encode(text)[:-1]


class _Spare:
    """A process that loads what ``work`` needs before it is asked for; it ends ``idle_s`` after the last.

    With ``work`` None there is none.
    """

    def __init__(self, work: ChildWork | None, idle_s: float) -> None:
        self._work = work
        self._idle_s = idle_s
        self._process: Process | None = None
        self._expiry: asyncio.TimerHandle | None = None
        self._expired: asyncio.Future[None] | None = None

    async def taken(self, work: ChildWork) -> Process:
        """A process that waits for its order, this one where it is there."""
        process = self._pop() if work is self._work else None
        if process is not None and _is_lost(process):
            await _ended(process)
            process = None
        return process or await _started(work)

    async def prepare(self, work: ChildWork) -> None:
        """Be there for the next, where it is of this ``work``."""
        if work is self._work:
            self._process = await _started(work)

    def expire_later(self) -> None:
        """End where it is not taken in time."""
        if self._process is not None and self._expiry is None:
            self._expiry = asyncio.get_running_loop().call_later(self._idle_s, self._expire)

    async def close(self) -> None:
        """End."""
        await self._end()
        if self._expired is not None:
            await self._expired

    def _expire(self) -> None:
        self._expired = asyncio.ensure_future(self._end())

    async def _end(self) -> None:
        process = self._pop()
        if process is not None:
            await _ended(process)

    def _pop(self) -> Process | None:
        if self._expiry is not None:
            self._expiry.cancel()
        process, self._process, self._expiry = self._process, None, None
        return process


async def _started(work: ChildWork) -> Process:
    return await asyncio.create_subprocess_exec(
        *(sys.executable, "-m", _MODULE, work.value),
        stdin=PIPE,
        stdout=PIPE,
        stderr=DEVNULL,
        limit=_MAX_LINE_BYTES,
    )


def _is_lost(process: Process) -> bool:
    """Whether a process has ended that waits for its order."""
    # Its end is told later than the end of its output, by a thread of its own.
    return process.returncode is not None or process.stdout is None or process.stdout.at_eof()


async def _ended(process: Process) -> None:
    """End ``process``, so that nothing of it is left to a loop that may close next."""
    if process.returncode is None:
        process.kill()
    await process.communicate(b"")


class ChildProcesses:
    """Does one order at a time; ``tell`` gets its progress.

    While it does ``repeated`` work, and for ``idle_s`` after it, a second process is ready for the next.
    """

    def __init__(
        self,
        tell: Callable[[Progress], None],
        *,
        repeated: ChildWork | None = None,
        idle_s: float = _IDLE_S,
    ) -> None:
        self._tell = tell
        self._turn = asyncio.Semaphore(1)
        self._spare = _Spare(repeated, idle_s)

    async def close(self) -> None:
        """End the process that is ready."""
        await self._spare.close()

    async def answer(self, request: Request, order: Order) -> Response:
        """The result; ``TestudoError`` where there is none. Who leaves ends the work."""
        work = asyncio.ensure_future(self.result(order))
        leaving = asyncio.ensure_future(_left(request))
        try:
            await asyncio.wait({work, leaving}, return_when=asyncio.FIRST_COMPLETED)
            if work.done():
                return await run_in_threadpool(json_answer, request, work.result())
            raise RequestError("the page was closed", GONE)
        finally:
            for one in (work, leaving):
                one.cancel()
            await asyncio.gather(work, leaving, return_exceptions=True)

    async def result(self, order: Order) -> bytes:
        """The result as JSON; ``TestudoError`` where there is none. Who cancels it ends the work."""
        async with self._turn:
            try:
                return await asyncio.wait_for(self._done(order), order.timeout_s)
            except asyncio.TimeoutError as error:
                remedy = order.too_long.remedy
                raise RequestError(order.too_long.cause, _TIMED_OUT, remedy=remedy) from error

    async def _done(self, order: Order) -> bytes:
        process = await self._spare.taken(order.work)
        try:
            return await self._followed(process, order)
        finally:
            self._spare.expire_later()
            await _ended(process)

    async def _followed(self, process: Process, order: Order) -> bytes:
        if process.stdin is None or process.stdout is None:
            raise TestudoError("the work has no pipes")
        process.stdin.write(msgspec.json.encode(order.asked))
        process.stdin.write_eof()
        await self._spare.prepare(order.work)
        async for line in process.stdout:
            match msgspec.json.decode(line, type=Share | Done | Failure):
                case Share(share=share):
                    self._tell(Progress(run=order.run, share=share))
                case Done(result=result):
                    return order.told(bytes(result))
                case Failure(message=message, place=place, remedy=remedy):
                    raise TestudoError(message, place=place, remedy=remedy)
        raise order.broken


async def _left(request: Request) -> None:
    """Returns once the page that asked has gone."""
    while (await request.receive())["type"] != "http.disconnect":
        pass


_TIMEOUT_S = 600.0
_BAD_REQUEST = 400


class TryApi:
    """Tries rules on the bags of ``folder``, one at a time, each in a process that can be ended."""

    def __init__(self, folder: ProjectFolder, listeners: Listeners) -> None:
        self._folder = folder
        # A folder is tried one recording after the other.
        self._work = ChildProcesses(listeners.tell, repeated=ChildWork.HEADLINE)

    async def close(self) -> None:
        """End the process that is ready for the next recording of a folder."""
        await self._work.close()

    async def answer(self, request: Request, asked: TryRequest) -> Response:
        """Replay a bag; who leaves ends it."""
        await run_in_threadpool(require_usable, asked)
        return await self._answered(request, asked, ChildWork.TRIAL)

    async def headline(self, request: Request, asked: TryRequest) -> Response:
        """As ``answer``, in short; why a bag of the project cannot be tried is an answer, too."""
        await run_in_threadpool(require_usable, asked)
        try:
            return await self._answered(request, asked, ChildWork.HEADLINE)
        except ForbiddenPathError:
            raise
        except TestudoError as error:
            said = in_page_words(error)
            tried = TriedRecording(headline=None, problem=said.cause, remedy=said.remedy or "")
            return json_answer(request, answer_json(tried))

    async def _answered(self, request: Request, asked: TryRequest, work: ChildWork) -> Response:
        bag = await run_in_threadpool(self._folder.bag, asked.bag)
        order = order_about_bag(work, replace(asked, bag=str(bag)), bag, asked.bag)
        return await self._work.answer(request, order)


class CurveApi:
    """Measures what topics of the bags of ``folder`` lose at each rate or need, one at a time."""

    def __init__(self, folder: ProjectFolder, listeners: Listeners, work: ChildWork) -> None:
        self._folder = folder
        self._kind = work
        self._work = ChildProcesses(listeners.tell)

    async def answer(self, request: Request, asked: CurveRequest) -> Response:
        """Measure a topic of a bag; who leaves ends it."""
        if not is_topic_name(asked.topic):
            raise RequestError(f"{asked.topic!r} is not a valid ROS 2 topic name", _BAD_REQUEST)
        bag = await run_in_threadpool(self._folder.bag, asked.bag)
        order = replace(asked, bag=str(bag), topic=resolve_topic(asked.topic))
        return await self._work.answer(request, order_about_bag(self._kind, order, bag, asked.bag))


class CheckApi:
    """Looks at checks over bags of ``folder``, one at a time."""

    def __init__(self, folder: ProjectFolder, listeners: Listeners) -> None:
        self._folder = folder
        self._work = ChildProcesses(listeners.tell)

    async def answer(self, request: Request, asked: CheckCourseRequest) -> Response:
        """The course of a check; who leaves ends it."""
        bag = await run_in_threadpool(self._folder.bag, asked.bag)
        order = await run_in_threadpool(check_course_order, asked, bag)
        return await self._work.answer(request, order_about_bag(ChildWork.CHECK, order, bag, asked.bag))


class IncidentApi:
    """Reads the messages of incidents of ``folder``, one at a time."""

    def __init__(self, folder: ProjectFolder, listeners: Listeners) -> None:
        self._known = KnownIncidents(folder)
        self._work = ChildProcesses(listeners.tell)

    async def answer(self, request: Request, asked: IncidentCourseRequest) -> Response:
        """The course of an incident; who leaves ends it."""
        bag = await run_in_threadpool(self._known.bag, asked.name)
        order = order_about_bag(ChildWork.INCIDENT, replace(asked, name=str(bag)), bag, asked.name)
        return await self._work.answer(request, order)


_BagOrder: TypeAlias = TryRequest | CheckCourseOrder | CurveRequest | IncidentCourseRequest


def order_about_bag(work: ChildWork, asked: _BagOrder, bag: Path, name: str) -> Order:
    """The order of ``work`` on the recording at ``bag``, which the page calls ``name``."""
    return Order(
        work=work,
        asked=asked,
        run=asked.run,
        timeout_s=_TIMEOUT_S,
        too_long=TestudoError("the recording takes longer than ten minutes", remedy="try a shorter one"),
        broken=TestudoError(
            "reading the recording ended without a result", place=name, remedy="try testudo bag info on it"
        ),
        path=str(bag),
        name=name,
    )


MAX_SECONDS = 60.0
# For the first topic to be seen, and for the process to begin and end.
_FIRST_TOPIC_S = 5.0
_MARGIN_S = 30.0


class MeasureApi:
    """Measures one at a time: it subscribes to everything."""

    def __init__(self, listeners: Listeners) -> None:
        self._work = ChildProcesses(listeners.tell)

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
