# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""Keys as they are pressed."""

from __future__ import annotations

import os
import select
import sys
from collections.abc import Callable, Iterator
from contextlib import contextmanager

_LONGEST = 64


@contextmanager
def key_presses() -> Iterator[Callable[[], str]]:
    """The keys pressed since the last call; never any where standard input is no terminal."""
    if not sys.stdin.isatty():
        yield str
        return
    import termios  # noqa: PLC0415  not on every laptop
    import tty  # noqa: PLC0415

    terminal = sys.stdin.fileno()
    before = termios.tcgetattr(terminal)
    tty.setcbreak(terminal)
    try:
        yield lambda: _read(terminal) if select.select([terminal], [], [], 0)[0] else ""
    finally:
        termios.tcsetattr(terminal, termios.TCSADRAIN, before)


def _read(terminal: int) -> str:
    return os.read(terminal, _LONGEST).decode("utf-8", "replace")
