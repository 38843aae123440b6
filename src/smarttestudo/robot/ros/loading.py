# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""Loading rclpy, which a laptop may lack."""

from __future__ import annotations

import signal
import threading
from collections.abc import Iterator
from contextlib import contextmanager
from importlib.util import find_spec
from types import FrameType

_SIGNALS = (signal.SIGINT, signal.SIGTERM, signal.SIGHUP)


def has_rclpy() -> bool:
    """Whether rclpy is installed here, or its setup file was sourced; it may fail to load nevertheless."""
    return find_spec("rclpy") is not None


def load_rclpy() -> None:
    """Have rclpy imported; signals wait until it is. Raises ``ImportError``."""
    with _signals_waiting():
        import rclpy  # noqa: F401, PLC0415  a laptop lacks it


@contextmanager
def _signals_waiting() -> Iterator[None]:
    """Signals that come in the block are handled after it.

    rclpy's library clears what their handlers raise while it is loaded: a Ctrl-C then would be lost.
    """
    if threading.current_thread() is not threading.main_thread():
        yield
        return
    caught: list[int] = []

    def wait(number: int, _frame: FrameType | None) -> None:
        caught.append(number)

    handlers = {number: signal.getsignal(number) for number in _SIGNALS}
    raising = {number: handler for number, handler in handlers.items() if callable(handler)}
    for number in raising:
        signal.signal(number, wait)
    try:
        yield
    finally:
        for number, handler in raising.items():
            signal.signal(number, handler)
        for one in dict.fromkeys(caught):
            signal.raise_signal(one)
