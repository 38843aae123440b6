# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""Executors of tasks: the port, and this process itself."""

from __future__ import annotations

from collections.abc import Callable, Generator, Sequence
from typing import Protocol, TypeVar

from smarttestudo.domain.errors import TestudoError, testudo_error

Item = TypeVar("Item")
Result = TypeVar("Result")


class WorkerError(TestudoError):
    """Workers ended without an answer."""


class Executor(Protocol):
    """Works on one task for each of many items.

    ``map`` gives the result of ``task`` for each item, or the error that it ended with, in the order of the
    items and as soon as it is known. It works a bounded number of items ahead, so memory does not grow with
    their number, and lets go of all when it is closed. A worker that is lost costs time: its item is tried
    once more elsewhere. ``task`` is a function of a module, or a ``partial`` of one.

    Raises ``ModuleNotFoundError`` for a package that a worker lacks.
    """

    def map(self, task: Callable[[Item], Result], items: Sequence[Item]) -> Generator[Result | TestudoError]:
        """The results in order."""

    @property
    def notices(self) -> Sequence[str]:
        """Losses that were made good, a line each."""

    @property
    def failure(self) -> TestudoError | None:
        """Why it could not go on, where the rest was worked on in another way."""


def attempt(task: Callable[[Item], Result], item: Item) -> Result | TestudoError:
    """The result of ``task`` for ``item``, or the error that it ended with; a missing package is raised."""
    try:
        return task(item)
    except ModuleNotFoundError:
        raise
    except Exception as error:  # noqa: BLE001 - one recording costs no other
        return testudo_error(error)


class InProcess:
    """An ``Executor`` that works in this process, on one item after the other."""

    notices: Sequence[str] = ()
    failure: TestudoError | None = None

    def map(self, task: Callable[[Item], Result], items: Sequence[Item]) -> Generator[Result | TestudoError]:
        """The results in order, each made when it is asked for."""
        return (attempt(task, item) for item in items)
