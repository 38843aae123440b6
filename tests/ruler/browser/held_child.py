# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""Work that the server of a test does in a process of its own, held so that it does not end by itself."""

from __future__ import annotations

import os
import queue
import signal
import threading
from collections.abc import Callable, Iterator
from contextlib import contextmanager, suppress
from pathlib import Path

from real_browser import TIMEOUT_MS
from smarttestudo.ruler.child_process import ChildWork

LOOK_S = 0.01


@contextmanager
def first_held(work: ChildWork) -> Iterator[Callable[[], int]]:
    """Stop the first process for ``work`` that begins, and let it go on afterwards.

    The result waits until there is one, and says its number.
    """
    found: queue.SimpleQueue[int] = queue.SimpleQueue()
    held: list[int] = []
    is_over = threading.Event()

    def watch() -> None:
        while not is_over.wait(LOOK_S):
            child = child_of_server(work)
            if child is None:
                continue
            # One that ended meanwhile was another test's.
            with suppress(ProcessLookupError):
                os.kill(child, signal.SIGSTOP)
                held.append(child)
                found.put(child)
                return

    watching = threading.Thread(target=watch)
    watching.start()
    try:
        yield lambda: found.get(timeout=TIMEOUT_MS / 1000)
    finally:
        is_over.set()
        watching.join()
        for child in held:
            with suppress(ProcessLookupError):
                os.kill(child, signal.SIGCONT)


def child_of_server(work: ChildWork) -> int | None:
    """The process for ``work`` of the server of this test; others have forked that."""
    servers = _children(_children(iter([os.getpid()])))
    command = f"smarttestudo.ruler.child_process\0{work.value}"
    return next((pid for pid in _children(servers) if command in _command(pid)), None)


def _children(parents: Iterator[int]) -> Iterator[int]:
    known = set(parents)
    for entry in Path("/proc").iterdir():
        if entry.name.isdecimal() and _parent(int(entry.name)) in known:
            yield int(entry.name)


def _parent(pid: int) -> int | None:
    try:
        return int(Path(f"/proc/{pid}/stat").read_text().rpartition(")")[2].split()[1])
    except OSError:
        return None


def _command(pid: int) -> str:
    try:
        return Path(f"/proc/{pid}/cmdline").read_text()
    except OSError:
        return ""
