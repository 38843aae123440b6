# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""Numbers, as of ROS domains and ports, that no other test run on this machine has."""

from __future__ import annotations

import fcntl
import tempfile
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from pathlib import Path

import pytest


@contextmanager
def first_free(kind: str, numbers: range, is_free: Callable[[int], bool] = lambda _: True) -> Iterator[int]:
    """The first of ``numbers`` that nobody holds, held until the block ends."""
    for number in numbers:
        with (Path(tempfile.gettempdir()) / f"smarttestudo-test-{kind}-{number}").open("w") as lock:
            try:
                fcntl.flock(lock, fcntl.LOCK_EX | fcntl.LOCK_NB)
            except BlockingIOError:
                continue
            if is_free(number):
                yield number
                return
    pytest.fail(f"each {kind} is taken by other test runs")
