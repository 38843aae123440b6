# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""Work that makes many objects which stay, without holding up messages then or later."""

from __future__ import annotations

import gc
import sys
import time
from collections.abc import Iterator
from contextlib import contextmanager

from smarttestudo.domain.timing import Rest

_SWITCH_INTERVAL_S = 0.000_5
_WORK_S, _REST_S = 0.000_5, 0.001


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
def low_priority() -> Iterator[Rest]:
    """Let this thread make many objects while others go on; it is to rest between two pieces of work.

    A thread that rests often is seldom interrupted while it has the interpreter, for which all others would
    wait. What it makes is ``long_lived``.
    """
    interval_s = sys.getswitchinterval()
    sys.setswitchinterval(_SWITCH_INTERVAL_S)
    try:
        with long_lived():
            yield _rests()
    finally:
        sys.setswitchinterval(interval_s)


def _rests() -> Rest:
    due_s = time.monotonic() + _WORK_S

    def rest() -> None:
        nonlocal due_s
        if time.monotonic() >= due_s:
            time.sleep(_REST_S)
            due_s = time.monotonic() + _WORK_S

    return rest
