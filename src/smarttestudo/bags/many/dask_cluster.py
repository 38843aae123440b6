# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""Tasks on a Dask cluster: the only importer of ``distributed``."""

from __future__ import annotations

import logging
import time
from collections.abc import Iterator
from concurrent.futures import Executor
from contextlib import contextmanager, suppress

from distributed import Client
from distributed import TimeoutError as DaskTimeoutError

from smarttestudo import __version__
from smarttestudo.domain.errors import TestudoError
from smarttestudo.domain.units import counted

_POLL_S = 1.0
_WITHOUT_WORKERS_S = 10.0
_LOGGERS = ("distributed", "tornado")


class ClusterError(TestudoError):
    """A Dask cluster that cannot be reached, does not fit, or is lost."""


@contextmanager
def open_cluster(address: str, *, timeout_s: float) -> Iterator[DaskCluster]:
    """The cluster whose scheduler is at ``address``, once a worker is there. Raises ``ClusterError``."""
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
        yield DaskCluster(client, address)
    finally:
        with suppress(OSError, DaskTimeoutError):
            client.close(timeout=_POLL_S)


class DaskCluster:
    """Workers of a Dask cluster as an executor of ``concurrent.futures``."""

    def __init__(self, client: Client, address: str) -> None:
        self._client = client
        self._address = address
        self._loss = ""
        self._alone_since_s: float | None = None
        self.threads = max(1, sum(client.nthreads().values()))

    def open_pool(self) -> Executor:
        """An executor; where several workers are lost with an item, its future has an exception."""
        pool: Executor = self._client.get_executor(pure=False)
        return pool

    def loss(self) -> str:
        """Why nobody works on what was submitted any more; "" while somebody does."""
        if self._client.status != "running":
            self._loss = "its scheduler is gone"
        elif self._has_workers():
            self._alone_since_s = None
        elif self._alone_since_s is None:
            self._alone_since_s = time.monotonic()
        elif time.monotonic() - self._alone_since_s > _WITHOUT_WORKERS_S:
            self._loss = "it has no worker any more"
        return self._loss

    def failure(self, rest: int) -> ClusterError:
        """The error that ``rest`` recordings are worked on without it."""
        loss = self._loss or "its scheduler is gone"
        return ClusterError(
            f"{loss}; {counted(rest, 'recording')} went to this machine instead",
            place=self._address,
            remedy="look at the cluster's own log",
        )

    def _has_workers(self) -> bool:
        scheduler = self._client.scheduler
        try:
            return scheduler is not None and bool(
                self._client.sync(scheduler.ncores, callback_timeout=_POLL_S)
            )
        except (OSError, DaskTimeoutError):
            return False


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
