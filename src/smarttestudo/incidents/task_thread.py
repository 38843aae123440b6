# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""Work that is done in order while something else goes on."""

from __future__ import annotations

import threading
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from queue import SimpleQueue


class TaskThread:
    """Does what it is given, in order, on a thread named ``name``.

    ``failed`` is told what a task raises; the next is done all the same.
    """

    def __init__(self, name: str, failed: Callable[[Exception], None]) -> None:
        self._name = name
        self._failed = failed
        self._tasks: SimpleQueue[Callable[[], None] | None] = SimpleQueue()

    def give(self, task: Callable[[], None]) -> None:
        """Have it done after all that was given before."""
        self._tasks.put(task)

    @contextmanager
    def running(self) -> Iterator[None]:
        """Work during the block, and on what is left after it."""
        thread = threading.Thread(target=self._run, name=self._name, daemon=True)
        thread.start()
        try:
            yield
        finally:
            self._tasks.put(None)
            thread.join()

    def _run(self) -> None:
        while (task := self._tasks.get()) is not None:
            self._do(task)
            # What it holds is free while the thread waits for the next.
            del task

    def _do(self, task: Callable[[], None]) -> None:
        try:
            task()
        except Exception as error:  # noqa: BLE001 - whatever a task fails of, the thread goes on
            self._failed(error)
