# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""One task for each of many recordings: in this process, in others, or on a cluster."""

from __future__ import annotations

import os
import signal
import time
from collections import deque
from collections.abc import Callable, Generator, Iterator, Sequence
from concurrent.futures import BrokenExecutor, Executor, Future, ProcessPoolExecutor, ThreadPoolExecutor, wait
from contextlib import contextmanager, suppress
from dataclasses import dataclass, field
from functools import partial
from multiprocessing import get_context
from multiprocessing.connection import Connection
from threading import Thread
from types import FrameType
from typing import TYPE_CHECKING, Generic, ParamSpec, TypeVar

from smarttestudo.domain.errors import TestudoError, testudo_error
from smarttestudo.domain.units import counted

if TYPE_CHECKING:
    from smarttestudo.bags.many.dask_cluster import DaskCluster

_P = ParamSpec("_P")
_Answer = TypeVar("_Answer")
OpenPool = Callable[[int], Executor]
"""Opens a pool of so many processes."""
_END_S = 5.0


@contextmanager
def process_pools() -> Iterator[OpenPool]:
    """Yield what opens pools; their processes end with the block, and where this process is killed.

    A task that is under way then may remove what it did not finish.
    """
    # No state of this process is in them, whichever threads it has.
    context = get_context("spawn")
    lifeline, own_end = context.Pipe(duplex=False)
    pools: list[_Pool] = []

    def opened(workers: int) -> _Pool:
        pools.append(_Pool(workers, mp_context=context, initializer=_begin, initargs=(lifeline,)))
        return pools[-1]

    try:
        yield opened
    finally:
        own_end.close()
        for pool in pools:
            pool.shutdown(cancel_futures=True)
        lifeline.close()


class _Pool(ProcessPoolExecutor):
    def submit(
        self, task: Callable[_P, _Answer], /, *arguments: _P.args, **options: _P.kwargs
    ) -> Future[_Answer]:
        return super().submit(_work, task, *arguments, **options)


def _begin(lifeline: Connection) -> None:
    """Prepare a process of a pool; Ctrl-C is the business of the one that opened it."""
    signal.signal(signal.SIGINT, signal.SIG_IGN)
    Thread(target=_end_with, args=(lifeline,), daemon=True).start()


def _work(task: Callable[_P, _Answer], /, *arguments: _P.args, **options: _P.kwargs) -> _Answer:
    """The answer of ``task``, which may clean up where its process is ended."""
    signal.signal(signal.SIGTERM, _leave)
    try:
        return task(*arguments, **options)
    except SystemExit:
        # The pool would take it for an answer.
        os._exit(1)
    finally:
        signal.signal(signal.SIGTERM, signal.SIG_DFL)


def _leave(number: int, _frame: FrameType | None) -> None:
    # Another one must not break off the removal of what is not finished.
    signal.signal(number, signal.SIG_IGN)
    raise SystemExit


def _end_with(lifeline: Connection) -> None:
    with suppress(EOFError, OSError):
        lifeline.recv()
    os.kill(os.getpid(), signal.SIGTERM)
    time.sleep(_END_S)
    os._exit(1)


Item = TypeVar("Item")
Result = TypeVar("Result")
_AHEAD_PER_WORKER = 4
"""Items that may be finished or under way behind one that takes long."""
_POLL_S = 1.0


class WorkerError(TestudoError):
    """Workers ended without an answer."""


class Workers:
    """Work on one task for each of many items.

    With one process and without a cluster this process works itself. What is unfinished when a pool of
    processes breaks, or when the cluster loses it, is tried once more in a process of its own, so that it is
    known which item ends a worker. What a lost cluster leaves goes to ``processes`` of this machine.
    """

    def __init__(self, processes: int, cluster: DaskCluster | None = None) -> None:
        self._processes = processes
        self._cluster = cluster
        self._tried_again = 0
        self.failure: TestudoError | None = None
        """Why the cluster could not go on."""

    @property
    def notices(self) -> Sequence[str]:
        """Losses that were made good, a line each."""
        if not self._tried_again:
            return ()
        count = counted(self._tried_again, "recording")
        return (f"a worker ended without an answer: {count} tried once more, each in a process of its own",)

    def map(self, task: Callable[[Item], Result], items: Sequence[Item]) -> Generator[Result | TestudoError]:
        """The result of ``task`` for each item, or the error that it ended with, in order.

        It is given as soon as it is known. A bounded number of items is worked on ahead, so memory does not
        grow with their number. All is let go of where it is closed. ``task`` is a function of a module, or a
        ``partial`` of one. Raises ``ModuleNotFoundError`` for a package that a worker lacks.
        """
        if self._cluster is None and self._processes <= 1:
            yield from (attempt(task, item) for item in items)
            return
        threads = ThreadPoolExecutor(self._processes)
        try:
            with process_pools() as open_pool:
                run = _Run(
                    work=partial(attempt, task),
                    items=items,
                    open_pool=open_pool,
                    threads=threads,
                    processes=self._processes,
                    cluster=self._cluster,
                )
                try:
                    yield from run.results()
                finally:
                    run.end()
                    self._tried_again += run.tried_again
                    self.failure = run.failure
        finally:
            threads.shutdown(cancel_futures=True)


def attempt(task: Callable[[Item], Result], item: Item) -> Result | TestudoError:
    """The result of ``task`` for ``item``, or the error that it ended with; a missing package is raised."""
    try:
        return task(item)
    except ModuleNotFoundError:
        raise
    except Exception as error:  # noqa: BLE001 - one recording costs no other
        return testudo_error(error)


@dataclass(slots=True, kw_only=True)
class _Run(Generic[Item, Result]):
    """One pass over items."""

    work: Callable[[Item], Result | TestudoError]
    items: Sequence[Item]
    open_pool: OpenPool
    threads: ThreadPoolExecutor
    processes: int
    cluster: DaskCluster | None
    tried_again: int = 0
    failure: TestudoError | None = None
    _pool: Executor | None = None
    _begun: int = 0
    _under_way: deque[Future[Result | TestudoError]] = field(default_factory=deque)
    _alone: set[Future[Result | TestudoError]] = field(default_factory=set)

    def results(self) -> Generator[Result | TestudoError]:
        for _ in self.items:
            self._submit_more()
            self._await_first()
            if self._is_lost(self._under_way[0]):
                self._try_again()
            answer = self._under_way.popleft().result()
            # Nobody is idle while the caller works on what it is given.
            self._submit_more()
            yield answer

    def end(self) -> None:
        """Let a cluster go on without what is under way; processes end with their pools."""
        if self.cluster is not None and self._pool is not None:
            with suppress(Exception):
                self._pool.shutdown(wait=False)

    def _submit_more(self) -> None:
        """Submit what is next; what a broken pool left comes before another pool is opened."""
        workers = self.processes if self.cluster is None else self.cluster.threads
        while (
            self._begun < len(self.items)
            and len(self._under_way) < _AHEAD_PER_WORKER * workers
            and (self._pool is not None or not self._under_way)
        ):
            future = self._submitted(self.items[self._begun])
            if future is not None:
                self._under_way.append(future)
                self._begun += 1

    def _submitted(self, item: Item) -> Future[Result | TestudoError] | None:
        """The future of ``item``; None where the pool is broken."""
        try:
            if self._pool is None:
                self._pool = (
                    self.open_pool(self.processes) if self.cluster is None else self.cluster.open_pool()
                )
            return self._pool.submit(self.work, item)
        except BrokenExecutor:
            pass
        except Exception:  # a closed client raises all kinds
            if self.cluster is None:
                raise
        self._give_up_pool()
        return None

    def _await_first(self) -> None:
        """Wait until the first is done, or its pool is lost."""
        while not wait([self._under_way[0]], _POLL_S).done:
            if self.cluster is not None and self.cluster.loss():
                return

    def _is_lost(self, future: Future[Result | TestudoError]) -> bool:
        """Whether a worker or its pool owes the answer; an error of the task is an answer."""
        if future in self._alone:
            return False
        return (
            not future.done()
            or future.cancelled()
            or not isinstance(future.exception(), ModuleNotFoundError | None)
        )

    def _try_again(self) -> None:
        """Try what is lost once more, each in a process of its own."""
        first, start = self._under_way[0], self._begun - len(self._under_way)
        is_broken = not first.done() or first.cancelled() or isinstance(first.exception(), BrokenExecutor)
        if is_broken:
            self._give_up_pool()
        for place, future in enumerate(self._under_way):
            if self._is_lost(future) and (is_broken or future.done()):
                again = self.threads.submit(self._work_alone, self.items[start + place])
                self._under_way[place] = again
                self._alone.add(again)
                self.tried_again += 1

    def _give_up_pool(self) -> None:
        self._pool = None
        if self.cluster is not None:
            rest = len(self.items) - self._begun + len(self._under_way)
            self.failure, self.cluster = self.cluster.failure(rest), None

    def _work_alone(self, item: Item) -> Result | TestudoError:
        try:
            with self.open_pool(1) as pool:
                return pool.submit(self.work, item).result()
        except BrokenExecutor:
            return WorkerError(
                "each process that worked on it was ended",
                remedy="read it alone with --workers 1; if memory was short, use fewer workers",
            )
        except ModuleNotFoundError:
            raise
        except Exception as error:  # noqa: BLE001 - an answer that no process can send
            return testudo_error(error)
