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
from typing import Any

from real_browser import TIMEOUT_MS
from smarttestudo.ruler import child
from smarttestudo.ruler.job import Job

LOOK_S = 0.01


@contextmanager
def first_held(job: Job[..., Any]) -> Iterator[Callable[[], int]]:
    """Stop the first process for ``job`` that begins, and let it go on afterwards.

    The result waits until there is one, and says its number.
    """
    found: queue.SimpleQueue[int] = queue.SimpleQueue()
    held: list[int] = []
    is_over = threading.Event()

    def watch() -> None:
        while not is_over.wait(LOOK_S):
            pid = child_of_server(job)
            if pid is None:
                continue
            # One that ended meanwhile was another test's.
            with suppress(ProcessLookupError):
                os.kill(pid, signal.SIGSTOP)
                held.append(pid)
                found.put(pid)
                return

    watching = threading.Thread(target=watch)
    watching.start()
    try:
        yield lambda: found.get(timeout=TIMEOUT_MS / 1000)
    finally:
        is_over.set()
        watching.join()
        for pid in held:
            with suppress(ProcessLookupError):
                os.kill(pid, signal.SIGCONT)


def child_of_server(job: Job[..., Any]) -> int | None:
    """The process for ``job`` of the server of this test; others have forked that."""
    servers = _children(_children(iter([os.getpid()])))
    command = "\0".join(child.command(job, Path())[:-1])
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
