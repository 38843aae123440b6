# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""Work that makes many objects which stay, without holding up messages then or later."""

from __future__ import annotations

import gc
import sys
import time
from collections.abc import Iterator
from contextlib import contextmanager

from smarttestudo.domain.timing import Yield

_SWITCH_INTERVAL_S = 0.000_5
_WORK_S, _YIELD_S = 0.000_5, 0.001


@contextmanager
def long_lived() -> Iterator[None]:
    """Let the block make objects that stay: nothing looks for cycles meanwhile, nor later among them.

    To look through all that is imported, or through all rules, would hold up every message.
    """
    gc.disable()
    try:
        yield
    finally:
        gc.freeze()
        gc.enable()


@contextmanager
def low_priority() -> Iterator[Yield]:
    """Let this thread make many objects while others go on; it is to yield between two pieces of work.

    A thread that yields often is seldom interrupted while it has the interpreter, for which all others would
    wait. What it makes is ``long_lived``.
    """
    interval_s = sys.getswitchinterval()
    sys.setswitchinterval(_SWITCH_INTERVAL_S)
    try:
        with long_lived():
            yield _yielding()
    finally:
        sys.setswitchinterval(interval_s)


def _yielding() -> Yield:
    due_s = time.monotonic() + _WORK_S

    def yield_turn() -> None:
        nonlocal due_s
        if time.monotonic() >= due_s:
            time.sleep(_YIELD_S)
            due_s = time.monotonic() + _WORK_S

    return yield_turn
