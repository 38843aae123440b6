# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""The threads of a link."""

from __future__ import annotations

import threading
from collections import deque
from collections.abc import Callable

_END_WITHIN_S = 5.0
_REST_S = 60.0


def _rest() -> float:
    return _REST_S


class AutoResetEvent:
    """An event that is set until one ``wait`` ends.

    It is a lock, in C: where threads wait hundreds of times a second, ``threading.Event`` costs as much as
    what they do then.
    """

    def __init__(self) -> None:
        self._is_unset = threading.Lock()
        self._is_unset.acquire()

    def set(self) -> None:
        """Have a ``wait`` end: one that waits now, or the next."""
        if self._is_unset.locked():
            # Another thread may do the same at this moment; ``suppress`` takes as long as all of the rest.
            try:  # noqa: SIM105
                self._is_unset.release()
            except RuntimeError:
                pass

    def wait(self, timeout_s: float) -> bool:
        """Wait until it is set, and unset it; whether it was set in time."""
        return self._is_unset.acquire(timeout=max(timeout_s, 0.0))


class Worker:
    """A thread that does what it is given, in order, and then ``poll``s whether more is due.

    ``poll`` returns after how many seconds it is to be called again; ``wake`` has that done at once.
    ``failed`` is told what either raises: a task costs itself, ``poll`` ends the thread.
    """

    def __init__(
        self, name: str, failed: Callable[[Exception], None], poll: Callable[[], float] = _rest
    ) -> None:
        self.is_closed = False
        self._failed = failed
        self._poll = poll
        self._tasks: deque[Callable[[], None]] = deque()
        self._news = AutoResetEvent()
        self._thread = threading.Thread(target=self._run, name=name, daemon=True)

    def start(self) -> None:
        self._thread.start()

    def give(self, task: Callable[[], None], *, most: int | None = None) -> bool:
        """Have a task done, unless ``most`` wait already; whether it will be."""
        if most is not None and len(self._tasks) >= most:
            return False
        self._tasks.append(task)
        self.wake()
        return True

    def wake(self) -> None:
        self._news.set()

    def close(self) -> None:
        """Begin nothing more, and wait a few seconds for what was begun."""
        self.is_closed = True
        self.wake()
        if self._thread.ident is not None:
            self._thread.join(_END_WITHIN_S)

    def _run(self) -> None:
        try:
            while not self.is_closed:
                self._do_tasks()
                wait_s = self._poll()
                # What wakes it after it began to look has it look again.
                self._news.wait(wait_s)
        except Exception as error:  # noqa: BLE001 - whatever it fails of, that is said once
            self._fail(error)

    def _do_tasks(self) -> None:
        while self._tasks and not self.is_closed:
            self._do(self._tasks.popleft())

    def _do(self, task: Callable[[], None]) -> None:
        try:
            task()
        except Exception as error:  # noqa: BLE001 - whatever one task fails of, others are done
            self._fail(error)

    def _fail(self, error: Exception) -> None:
        if not self.is_closed:
            self._failed(error)
