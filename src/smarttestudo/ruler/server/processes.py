# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""Jobs that take long, each in a process of its own that ends with who asked for it."""

from __future__ import annotations

import asyncio
import sys
from asyncio.subprocess import DEVNULL, PIPE, Process
from pathlib import Path
from typing import Any

import msgspec

from smarttestudo.domain.errors import TestudoError
from smarttestudo.ruler.child import Done, Failed, FailedError, Said, Share, command
from smarttestudo.ruler.job import Job, Limit, Report, RequestError

_MAX_LINE_BYTES = 50_000_000
_IDLE_S = 60.0
_TIMED_OUT = 504


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
        process = await self._asked(msgspec.json.encode(asked))
        try:
            return await self._followed(process, report, limit)
        finally:
            if self._ready is not None and self._expiry is None:
                self._expiry = asyncio.get_running_loop().call_later(self._idle_s, self._expire)
            await _ended(process)

    async def _followed(self, process: Process, report: Report, limit: Limit) -> bytes:
        if process.stdout is None:
            raise TestudoError("the work has no pipes")
        if self._job.repeats:
            self._ready = await self._started()
        async for line in process.stdout:
            match msgspec.json.decode(line, type=Said):
                case Share(share=share):
                    report(share)
                case Done(result=result):
                    return bytes(result)
                case Failed() as failed:
                    raise FailedError(failed)
        raise TestudoError(limit.broken.cause, remedy=limit.broken.remedy)

    async def _asked(self, request: bytes) -> Process:
        """A process that has its request, the one that is ready where that is still there."""
        process = self._pop()
        if process is not None and _has_taken(process, request):
            return process
        if process is not None:
            await _ended(process)
        process = await self._started()
        _has_taken(process, request)
        return process

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


def _has_taken(process: Process, request: bytes) -> bool:
    """Give ``process`` its request; whether there was still a process to take it."""
    if process.stdin is None:
        return False
    # That it has ended may be reported later; the pipe knows it at once.
    process.stdin.write(request)
    if process.stdin.is_closing():
        return False
    process.stdin.write_eof()
    return True


async def _ended(process: Process) -> None:
    """End ``process``, so that nothing of it is left to a loop that may close next."""
    if process.returncode is None:
        process.kill()
    await process.communicate(b"")
