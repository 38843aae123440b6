# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""Keys, durations and signals of a terminal."""

from __future__ import annotations

import os
import select
import signal
import sys
import threading
from collections.abc import Callable, Iterator
from contextlib import contextmanager, suppress
from types import FrameType
from typing import TextIO

_LONGEST = 64
_LOCAL_MODES = 3
"""Place of them in what termios gives."""


def is_unicode(stream: TextIO) -> bool:
    """Whether ``stream`` takes every character, as one in memory does, which has no encoding."""
    return not stream.encoding or stream.encoding.lower().replace("-", "").startswith("utf")


@contextmanager
def key_presses() -> Iterator[Callable[[], str]]:
    """The keys pressed since the last call; never any where standard input is no terminal.

    Nor are there any in the background of a shell, where who shows something on the terminal is stopped.
    """
    if not sys.stdin.isatty():
        yield str
        return
    import termios  # noqa: PLC0415  not on every laptop
    import tty  # noqa: PLC0415

    terminal = sys.stdin.fileno()
    before = termios.tcgetattr(terminal)
    if _is_in_front(terminal) or sys.stdout.isatty():
        tty.setcbreak(terminal)

    def pressed() -> str:
        if not _is_in_front(terminal):
            return ""
        # A shell that had stopped the process has set the terminal to whole lines.
        if termios.tcgetattr(terminal)[_LOCAL_MODES] & termios.ICANON:
            tty.setcbreak(terminal, termios.TCSADRAIN)
        return _read(terminal) if select.select([terminal], [], [], 0)[0] else ""

    try:
        yield pressed
    finally:
        # It may be gone, as after SIGHUP.
        with suppress(termios.error):
            if _is_in_front(terminal):
                termios.tcsetattr(terminal, termios.TCSADRAIN, before)


def _is_in_front(terminal: int) -> bool:
    """Whether the process may change ``terminal``, which stops those in the background."""
    try:
        return os.tcgetpgrp(terminal) == os.getpgrp()
    except OSError:
        # No shell has processes in its background there.
        return True


def _read(terminal: int) -> str:
    return os.read(terminal, _LONGEST).decode("utf-8", "replace")


STOP_SIGNALS = (signal.SIGINT, signal.SIGTERM)
_TERMINATING_SIGNALS = (signal.SIGTERM, signal.SIGHUP)


class Terminated(KeyboardInterrupt):
    """The signal ``number`` asked the process to end, as Ctrl-C does."""

    def __init__(self, number: int) -> None:
        super().__init__()
        self.number = number


@contextmanager
def terminating_signals() -> Iterator[None]:
    """SIGTERM and SIGHUP raise ``Terminated`` in the block, so that unfinished files are removed.

    A signal that the process was told to ignore stays ignored.
    """
    is_main = threading.current_thread() is threading.main_thread()
    ours = [one for one in _TERMINATING_SIGNALS if is_main and signal.getsignal(one) is signal.SIG_DFL]

    def end(number: int, _frame: FrameType | None) -> None:
        raise Terminated(number)

    for number in ours:
        signal.signal(number, end)
    try:
        yield
    finally:
        for number in ours:
            signal.signal(number, signal.SIG_DFL)


@contextmanager
def stop_signals() -> Iterator[Callable[[], bool]]:
    """Whether one came, for the block; a second one ends the process at once."""
    came = False
    before = {number: signal.getsignal(number) for number in STOP_SIGNALS}

    def stop(_number: int, _frame: FrameType | None) -> None:
        nonlocal came
        came = True
        signal.signal(signal.SIGINT, before[signal.SIGINT])
        # Python may not come to raise anything where it is stuck in a library.
        signal.signal(signal.SIGTERM, signal.SIG_DFL)

    for number in STOP_SIGNALS:
        signal.signal(number, stop)
    try:
        yield lambda: came
    finally:
        for number, handler in before.items():
            signal.signal(number, handler)
