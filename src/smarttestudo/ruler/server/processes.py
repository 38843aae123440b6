# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""Jobs that take long, each in a process of its own that ends with who asked for it."""

from __future__ import annotations

import asyncio
import sys
from asyncio.subprocess import DEVNULL, PIPE, Process
from contextlib import suppress
from pathlib import Path
from typing import Any

import msgspec

from smarttestudo.domain.errors import TestudoError
from smarttestudo.ruler.child import Done, Failed, FailedError, Said, Share, command
from smarttestudo.ruler.job import Job, Limit, Report, RequestError

_MAX_LINE_BYTES = 50_000_000
_IDLE_S = 60.0
_TIMED_OUT = 504


class _SilentError(TestudoError):
    """A process ended without a word."""


class Processes:
    """The processes of jobs on the project at ``root``, one at a time of each job.

    While a job is done that repeats, and for ``idle_s`` after it, a second process is ready for the next.
    """

    def __init__(self, root: Path, *, idle_s: float = _IDLE_S) -> None:
        self._root = root
        self._idle_s = idle_s
        self._of_jobs: dict[Job[..., Any], _JobProcesses] = {}

    async def result(self, job: Job[..., Any], asked: msgspec.Struct, report: Report) -> bytes:
        """The answer as JSON; ``TestudoError`` where there is none. Who cancels it ends the process."""
        if job not in self._of_jobs:
            self._of_jobs[job] = _JobProcesses(job, self._root, self._idle_s)
        return await self._of_jobs[job].result(asked, report)

    async def close(self) -> None:
        """End the processes that are ready."""
        for each in self._of_jobs.values():
            await each.close()


class _JobProcesses:
    """The process of ``job`` that is at work, and one that has loaded what the next needs."""

    def __init__(self, job: Job[..., Any], root: Path, idle_s: float) -> None:
        self._job = job
        self._root = root
        self._idle_s = idle_s
        self._turn = asyncio.Semaphore(1)
        self._ready: Process | None = None
        self._expiry: asyncio.TimerHandle | None = None
        self._expired: asyncio.Future[None] | None = None

    async def result(self, asked: msgspec.Struct, report: Report) -> bytes:
        """The answer as JSON."""
        limit = self._job.limit
        if limit is None:
            raise TypeError(f"{self._job.route} has no process")
        async with self._turn:
            try:
                return await asyncio.wait_for(self._done(asked, report, limit), limit.limit_s)
            except asyncio.TimeoutError as error:
                remedy = limit.too_long.remedy
                raise RequestError(limit.too_long.cause, _TIMED_OUT, remedy=remedy) from error

    async def close(self) -> None:
        """End the process that is ready."""
        await self._end_ready()
        if self._expired is not None:
            await self._expired

    async def _done(self, asked: msgspec.Struct, report: Report, limit: Limit) -> bytes:
        ready = self._pop()
        if ready is not None:
            # It may have ended since, which is known only once it says nothing.
            with suppress(_SilentError):
                return await self._done_by(ready, asked, report, limit)
        return await self._done_by(await self._started(), asked, report, limit)

    async def _done_by(self, process: Process, asked: msgspec.Struct, report: Report, limit: Limit) -> bytes:
        try:
            return await self._followed(process, asked, report, limit)
        finally:
            if self._ready is not None and self._expiry is None:
                self._expiry = asyncio.get_running_loop().call_later(self._idle_s, self._expire)
            await _ended(process)

    async def _followed(self, process: Process, asked: msgspec.Struct, report: Report, limit: Limit) -> bytes:
        if process.stdin is None or process.stdout is None:
            raise TestudoError("the work has no pipes")
        process.stdin.write(msgspec.json.encode(asked))
        process.stdin.write_eof()
        if self._job.repeats and self._ready is None:
            self._ready = await self._started()
        ended: type[TestudoError] = _SilentError
        async for line in process.stdout:
            ended = TestudoError
            match msgspec.json.decode(line, type=Said):
                case Share(share=share):
                    report(share)
                case Done(result=result):
                    return bytes(result)
                case Failed() as failed:
                    raise FailedError(failed)
        raise ended(limit.broken.cause, remedy=limit.broken.remedy)

    async def _started(self) -> Process:
        return await asyncio.create_subprocess_exec(
            *(sys.executable, *command(self._job, self._root)),
            stdin=PIPE,
            stdout=PIPE,
            stderr=DEVNULL,
            limit=_MAX_LINE_BYTES,
        )

    def _expire(self) -> None:
        self._expired = asyncio.ensure_future(self._end_ready())

    async def _end_ready(self) -> None:
        process = self._pop()
        if process is not None:
            await _ended(process)

    def _pop(self) -> Process | None:
        if self._expiry is not None:
            self._expiry.cancel()
        process, self._ready, self._expiry = self._ready, None, None
        return process


async def _ended(process: Process) -> None:
    """End ``process``, so that nothing of it is left to a loop that may close next."""
    if process.returncode is None:
        process.kill()
    await process.communicate(b"")
