# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""Pools of processes of this machine that end with a block."""

from __future__ import annotations

import os
import signal
import time
from collections.abc import Callable, Iterator
from concurrent.futures import Executor, Future, ProcessPoolExecutor
from contextlib import contextmanager, suppress
from multiprocessing import get_context
from multiprocessing.connection import Connection
from threading import Thread
from types import FrameType
from typing import ParamSpec, TypeVar

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
