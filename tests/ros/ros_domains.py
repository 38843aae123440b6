# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""ROS domains that no other test run on this machine has."""

from __future__ import annotations

import fcntl
import tempfile
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path

import pytest

# Domains above have ports that Linux gives to others.
DOMAINS = range(1, 102)


@contextmanager
def free_domain() -> Iterator[int]:
    for number in DOMAINS:
        with (Path(tempfile.gettempdir()) / f"smarttestudo-test-domain-{number}").open("w") as lock:
            try:
                fcntl.flock(lock, fcntl.LOCK_EX | fcntl.LOCK_NB)
            except BlockingIOError:
                continue
            yield number
            return
    pytest.fail("all ROS domains are taken by other test runs")
