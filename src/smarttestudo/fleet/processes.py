# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""Tasks in processes of this machine."""

from __future__ import annotations

import signal
from collections import deque
from collections.abc import Callable, Generator, Sequence
from contextlib import suppress
from multiprocessing import get_context
from multiprocessing.connection import Connection, wait
from multiprocessing.process import BaseProcess
from types import FrameType
from typing import Generic, cast

from smarttestudo.domain.dataclass import dataclass
from smarttestudo.domain.errors import TestudoError
from smarttestudo.domain.units import counted
from smarttestudo.fleet.executor import Item, Result, WorkerError, attempt

_AHEAD_PER_WORKER = 4
"""Items that may be finished or under way behind one that takes long."""
_TRIES = 2
_END_S = 5.0


@dataclass(slots=True, kw_only=True)
class _Worker:
    """A process, and the place of the item that it works on."""

    process: BaseProcess
    connection: Connection
    place: int | None = None

    def end(self) -> None:
        # It may have to remove what it did not finish.
        self.process.terminate()
        self.process.join(_END_S)
        self.process.kill()
        self.process.join()
        self.process.close()
        self.connection.close()


class Processes:
    """An ``Executor`` with ``workers`` processes, each with one item, so it is known which item ends one."""

    failure: TestudoError | None = None

    def __init__(self, workers: int) -> None:
        self._workers = workers
        self._lost = 0

    @property
    def notices(self) -> Sequence[str]:
        """The number of lost workers."""
        if not self._lost:
            return ()
        were = "was" if self._lost == 1 else "were"
        return (f"{counted(self._lost, 'worker')} ended without an answer and {were} replaced",)

    def map(self, task: Callable[[Item], Result], items: Sequence[Item]) -> Generator[Result | TestudoError]:
        """The results in order; processes end with it."""
        run = _Run(task, items, min(self._workers, len(items)))
        try:
            yield from run.results()
        finally:
            self._lost += run.lost
            run.end()


class _Run(Generic[Item, Result]):
    """One pass over items."""

    def __init__(self, task: Callable[[Item], Result], items: Sequence[Item], workers: int) -> None:
        self._task = task
        self._items = items
        self._waiting = deque(range(len(items)))
        self._tries = [0] * len(items)
        self._finished: dict[int, Result | TestudoError] = {}
        self._ahead = _AHEAD_PER_WORKER * workers
        self._workers: list[_Worker] = []
        self._count = workers
        self.lost = 0

    def results(self) -> Generator[Result | TestudoError]:
        for due in range(len(self._items)):
            self._hand_out(due)
            while due not in self._finished:
                self._await_answer()
                # Nobody is idle while the caller works on what it is given.
                self._hand_out(due)
            yield self._finished.pop(due)

    def end(self) -> None:
        for worker in self._workers:
            worker.process.terminate()
        while self._workers:
            self._workers.pop().end()

    def _hand_out(self, due: int) -> None:
        """Give each idle worker an item, none that is too far behind the one that is ``due``."""
        while self._waiting and self._waiting[0] < due + self._ahead:
            worker = self._idle()
            if worker is None:
                return
            worker.place = self._waiting.popleft()
            # One that is gone is noticed when it is to answer.
            with suppress(OSError):
                worker.connection.send(self._items[worker.place])

    def _idle(self) -> _Worker | None:
        for worker in self._workers:
            if worker.place is None:
                return worker
        if len(self._workers) == self._count:
            return None
        self._workers.append(_start(self._task))
        return self._workers[-1]

    def _await_answer(self) -> None:
        busy = {worker.connection: worker for worker in self._workers if worker.place is not None}
        for connection in wait([*busy]):
            worker = busy[cast("Connection", connection)]
            place, worker.place = cast("int", worker.place), None
            try:
                answer = worker.connection.recv()
            except (EOFError, OSError):
                self._replace(worker, place)
                continue
            if isinstance(answer, ModuleNotFoundError):
                raise answer
            self._finished[place] = answer

    def _replace(self, worker: _Worker, place: int) -> None:
        """Try the item of a lost worker once more."""
        self.lost += 1
        self._workers.remove(worker)
        worker.process.join()
        code = worker.process.exitcode or 0
        worker.end()
        self._tries[place] += 1
        if self._tries[place] < _TRIES:
            self._waiting.appendleft(place)
        else:
            self._finished[place] = WorkerError(
                f"the process that worked on it {_ending(code)}, {_TRIES} times",
                remedy="read it alone with --workers 1; if memory was short, use fewer workers",
            )


def _ending(code: int) -> str:
    return f"was ended by {signal.Signals(-code).name}" if code < 0 else f"ended with {code}"


def _start(task: Callable[[Item], Result]) -> _Worker:
    # No state of this process is in them, whichever threads it has.
    context = get_context("spawn")
    ours, theirs = context.Pipe()
    process = context.Process(target=_work, args=(theirs, task), daemon=True)
    process.start()
    theirs.close()
    return _Worker(process=process, connection=ours)


def _work(connection: Connection, task: Callable[[Item], Result]) -> None:
    """Answer items until the other end is closed; Ctrl-C is the other end's business."""
    signal.signal(signal.SIGINT, signal.SIG_IGN)
    signal.signal(signal.SIGTERM, _leave)
    with suppress(EOFError, OSError):
        while True:
            item = connection.recv()
            answer: object
            try:
                answer = attempt(task, item)
            except ModuleNotFoundError as error:
                answer = error
            connection.send(answer)


def _leave(number: int, _frame: FrameType | None) -> None:
    # Another one must not break off the removal of what is not finished.
    signal.signal(number, signal.SIG_IGN)
    raise SystemExit
