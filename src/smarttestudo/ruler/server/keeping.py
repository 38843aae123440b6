# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""Incidents of tries that are written into the project, which goes on though the page is closed."""

from __future__ import annotations

import asyncio
from collections.abc import Iterator
from contextlib import ExitStack, contextmanager
from pathlib import Path

import msgspec
from msgspec.structs import replace
from starlette.concurrency import run_in_threadpool
from starlette.requests import Request
from starlette.responses import Response

from smarttestudo.domain.errors import TestudoError, UsageError
from smarttestudo.files.removal import temporary_folder
from smarttestudo.files.whole_file import not_written
from smarttestudo.ruler.answer_json import answer_json
from smarttestudo.ruler.child_process import ChildWork
from smarttestudo.ruler.files.project_folder import ProjectFolder
from smarttestudo.ruler.page_words import in_page_words
from smarttestudo.ruler.rules.document import require_usable
from smarttestudo.ruler.server.child_work import ChildProcesses, order_about_bag
from smarttestudo.ruler.server.live import Progress
from smarttestudo.ruler.server.routes import json_answer
from smarttestudo.ruler.tries.incident_keeping import (
    INCIDENTS_FOLDER,
    KeepEndRequest,
    KeepOrder,
    KeepRequest,
    KeepsAnswer,
    KeepState,
    KeptIncident,
)

MAX_KEEPS = 20
_MAX_NAME = 200


class Keepings:
    """Writes incidents that tries showed into ``folder``, one after the other."""

    def __init__(self, folder: ProjectFolder) -> None:
        self._folder = folder
        self._work = ChildProcesses(self._note)
        self._states: dict[str, KeepState] = {}
        self._tasks: dict[str, asyncio.Task[None]] = {}

    async def told(self, request: Request) -> Response:
        """All that were asked for and not ended since."""
        return self._answer(request)

    async def start(self, request: Request, asked: KeepRequest) -> Response:
        """Begin to keep one, once for each ``run``.

        Raises:
            UsageError: its name is empty or too long.
            ForbiddenPathError, MissingFileError: the project has no such bag.
            RefusedTextError: the rules have errors.
            TestudoError: too many are being kept.
        """
        if not 0 < len(asked.run) <= _MAX_NAME or len(asked.title) > _MAX_NAME:
            raise UsageError(f"give a name of 1 to {_MAX_NAME} letters", place="run")
        bag = await run_in_threadpool(self._folder.bag, asked.bag)
        await run_in_threadpool(require_usable, asked)
        if asked.run not in self._tasks:
            if len(self._tasks) >= MAX_KEEPS:
                remedy = "wait for one of them, or cancel it"
                raise TestudoError(f"{MAX_KEEPS} incidents are being kept", remedy=remedy)
            self._forget_old(asked.run)
            self._states[asked.run] = KeepState(run=asked.run, title=asked.title, bag=asked.bag)
            task = self._tasks[asked.run] = asyncio.create_task(self._kept(asked, bag))
            task.add_done_callback(lambda _: self._ended(asked.run))
        return self._answer(request)

    async def end(self, request: Request, asked: KeepEndRequest) -> Response:
        """End one, of which no part stays, or forget one that has ended."""
        task = self._tasks.get(asked.run)
        if task is not None:
            task.cancel()
            await asyncio.gather(task, return_exceptions=True)
        self._states.pop(asked.run, None)
        return self._answer(request)

    async def close(self) -> None:
        """End all of them."""
        tasks = tuple(self._tasks.values())
        for task in tasks:
            task.cancel()
        await asyncio.gather(*tasks, return_exceptions=True)

    async def _kept(self, asked: KeepRequest, bag: Path) -> None:
        try:
            name = await self._written(asked, bag)
        except TestudoError as error:
            said = in_page_words(error)
            words = ". ".join(filter(None, (said.cause, said.remedy)))
            self._change(asked.run, state="failed", problem=words)
        else:
            self._change(asked.run, state="done", share=1.0, kept=name)

    async def _written(self, asked: KeepRequest, bag: Path) -> str:
        project = self._folder.path(".keeping").parent
        with _workshop(project) as workshop:
            given = {**msgspec.structs.asdict(asked), "bag": str(bag)}
            order = KeepOrder(**given, project=str(project), workshop=str(workshop))
            written = await self._work.result(order_about_bag(ChildWork.KEEP, order, bag, asked.bag))
        return msgspec.json.decode(written, type=KeptIncident).name

    def _ended(self, run: str) -> None:
        del self._tasks[run]
        if self._states[run].state == "running":
            del self._states[run]

    def _forget_old(self, run: str) -> None:
        ended = [name for name, each in self._states.items() if each.state != "running"]
        for name in (*ended[:-MAX_KEEPS], run):
            self._states.pop(name, None)

    def _note(self, progress: Progress) -> None:
        self._change(progress.run, share=progress.share)

    def _change(self, run: str, **changed: object) -> None:
        self._states[run] = replace(self._states[run], **changed)

    def _answer(self, request: Request) -> Response:
        return json_answer(request, answer_json(KeepsAnswer(keeps=tuple(self._states.values()))))


@contextmanager
def _workshop(project: Path) -> Iterator[Path]:
    """Where an incident is written. Raises ``OutputFileError`` where nothing can be."""
    with ExitStack() as opened:
        try:
            workshop = opened.enter_context(temporary_folder(project, prefix=".keeping-"))
        except OSError as error:
            raise not_written(Path(INCIDENTS_FOLDER), "an incident", error) from error
        yield workshop
