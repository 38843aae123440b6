# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""Tasks that tests give to executors, in a module that every worker can import."""

from __future__ import annotations

import os
import signal
import time
from pathlib import Path

from smarttestudo.domain.errors import RecordingError


def square(number: int) -> int:
    return number * number


def slow_first(number: int) -> int:
    """The first takes longer than all others together."""
    time.sleep(0.3 if number == 0 else 0.001)
    return number


def odd_ones_fail(number: int) -> int:
    if number % 4 == 1:
        raise RecordingError("odd", place=f"bag {number}", remedy="even it out")
    if number % 4 == 3:
        raise ZeroDivisionError("by zero")
    return number


def needs_a_package(_number: int) -> int:
    raise ModuleNotFoundError("No module named 'zzz'", name="zzz")


def noted(folder: Path, number: int) -> int:
    """Leaves a file, so that the test can see what was begun."""
    (folder / str(number)).touch()
    time.sleep(0.3 if number == 0 else 0.001)
    return number


def dies_once(folder: Path, number: int) -> int:
    """Of number 5 the first try ends its process."""
    mark = folder / "died"
    if number == 5 and not mark.exists():
        mark.touch()
        os.kill(os.getpid(), signal.SIGKILL)
    return number


def dies(culprits: set[int], number: int) -> int:
    """Each of the culprits ends its process whenever it is tried."""
    if number in culprits:
        os.kill(os.getpid(), signal.SIGKILL)
    return number


def waits_to_be_ended(folder: Path, number: int) -> int:
    """Leaves a file that goes if the worker is ended in an orderly way; that takes a while."""
    mark = folder / f"unfinished-{number}"
    try:
        mark.touch()
        if number > 0:
            time.sleep(30)
    finally:
        if number > 0:
            time.sleep(0.2)
        mark.unlink(missing_ok=True)
    return number
