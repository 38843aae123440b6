# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""Tasks on a Dask cluster: the only importer of ``distributed``."""

from __future__ import annotations

import logging
import time
from collections import deque
from collections.abc import Callable, Generator, Iterator, Sequence
from contextlib import contextmanager, suppress
from functools import partial
from itertools import islice
from typing import Any

from distributed import CancelledError, Client, Future, KilledWorker
from distributed import TimeoutError as DaskTimeoutError

from smarttestudo import __version__
from smarttestudo.domain.errors import TestudoError
from smarttestudo.domain.units import counted
from smarttestudo.fleet.executor import Executor, Item, Result, WorkerError, attempt

_AHEAD_PER_THREAD = 4
"""Items that may be finished or under way behind one that takes long."""
_POLL_S = 1.0
_WITHOUT_WORKERS_S = 10.0
_LOGGERS = ("distributed", "tornado")


class ClusterError(TestudoError):
    """A Dask cluster that cannot be reached, does not fit, or is lost."""


@contextmanager
def open_cluster(address: str, *, timeout_s: float, otherwise: Executor) -> Iterator[DaskCluster]:
    """The cluster whose scheduler is at ``address``, once a worker is there.

    What is left when the scheduler or all workers are lost goes to ``otherwise``. Raises ``ClusterError``.
    """
    _silence()
    try:
        client = Client(address, timeout=timeout_s, set_as_default=False)
    except (OSError, ValueError, DaskTimeoutError) as error:
        raise ClusterError(
            "no Dask scheduler answers there",
            place=address,
            remedy="start one with `dask scheduler`, or leave --dask out",
        ) from error
    try:
        _require_workers(client, address, timeout_s)
        yield DaskCluster(client, address, otherwise)
    finally:
        with suppress(OSError, DaskTimeoutError):
            client.close(timeout=_POLL_S)


class DaskCluster:
    """An ``Executor`` on the workers of a Dask cluster."""

    def __init__(self, client: Client, address: str, otherwise: Executor) -> None:
        self._client = client
        self._address = address
        self._otherwise = otherwise
        self.failure: TestudoError | None = None

    @property
    def notices(self) -> Sequence[str]:
        """Notices of the executor that took over."""
        return self._otherwise.notices

    def map(self, task: Callable[[Item], Result], items: Sequence[Item]) -> Generator[Result | TestudoError]:
        """The results in order; what is under way is given up where it is closed."""
        work = partial(attempt, task)
        waiting = iter(items)
        ahead = _AHEAD_PER_THREAD * max(1, sum(self._client.nthreads().values()))
        futures: deque[Future[Any]] = deque()
        done = 0
        try:
            while done < len(items):
                futures += (self._submit(work, item) for item in islice(waiting, ahead - len(futures)))
                try:
                    answer = self._answer(futures.popleft())
                except KilledWorker:
                    answer = self._again(work, items[done])
                yield answer
                done += 1
        except _LostError as error:
            rest = items[done:]
            self.failure = ClusterError(
                f"{error}; {counted(len(rest), 'recording')} went to this machine instead",
                place=self._address,
                remedy="look at the cluster's own log",
            )
            yield from self._otherwise.map(task, rest)
        finally:
            with suppress(Exception):
                self._client.cancel([*futures])

    def _submit(self, work: Callable[[Item], object], item: Item) -> Future[Any]:
        try:
            return self._client.submit(work, item, pure=False)
        except Exception as error:  # a closed client raises all kinds
            raise _LostError("its scheduler is gone") from error

    def _again(self, work: Callable[[Item], object], item: Item) -> Result | TestudoError:
        """The result of another try: Dask blames each item of a worker that is ended, at work or not."""
        try:
            return self._answer(self._submit(work, item))
        except KilledWorker:
            return WorkerError(
                "each worker that worked on it was ended",
                remedy="read it alone, without --dask; if memory was short, use fewer workers a machine",
            )

    def _answer(self, future: Future[Any]) -> Result | TestudoError:
        """The result that ``future`` stands for.

        Raises ``KilledWorker``, and ``_LostError`` where nobody works on it any more.
        """
        seen_s = time.monotonic()
        try:
            while True:
                # A worker may be lost with a result that it had, so that this waits anew.
                with suppress(DaskTimeoutError):
                    future.exception(timeout=_POLL_S)
                    answer: Result | TestudoError = future.result(timeout=_WITHOUT_WORKERS_S)
                    return answer
                if self._has_workers():
                    seen_s = time.monotonic()
                elif time.monotonic() - seen_s > _WITHOUT_WORKERS_S:
                    raise _LostError("it has no worker any more")
        except CancelledError as error:
            raise _LostError("its scheduler is gone") from error

    def _has_workers(self) -> bool:
        scheduler = self._client.scheduler
        try:
            return scheduler is not None and bool(
                self._client.sync(scheduler.ncores, callback_timeout=_POLL_S)
            )
        except (OSError, DaskTimeoutError):
            return False


class _LostError(Exception):
    """Nobody works on what is left."""


def _require_workers(client: Client, address: str, timeout_s: float) -> None:
    """Raise ``ClusterError`` unless there are workers, and all have this version."""
    try:
        client.wait_for_workers(1, timeout=timeout_s)
        versions = set(client.run(_version).values())
    except DaskTimeoutError as error:
        raise ClusterError(
            "the Dask scheduler has no worker",
            place=address,
            remedy=f"start some with `dask worker {address} --nthreads 1`",
        ) from error
    except ModuleNotFoundError as error:
        raise ClusterError(
            f"a Dask worker lacks the package {error.name}", place=address, remedy=_SAME_VERSION
        ) from error
    if versions != {__version__}:
        others = ", ".join(sorted(versions - {__version__}))
        raise ClusterError(f"Dask workers have SmartTestudo {others}", place=address, remedy=_SAME_VERSION)


_SAME_VERSION = f"install SmartTestudo {__version__} with the extra fleet on each"


def _version() -> str:
    return __version__


def _silence() -> None:
    """Silence the loggers of Dask: what happens to a cluster is said in one line."""
    for name in [*logging.root.manager.loggerDict]:
        if name.startswith(_LOGGERS):
            logging.getLogger(name).setLevel(logging.CRITICAL + 1)
