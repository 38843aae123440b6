# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""Ports that no other test run on this machine has, also while nobody listens there."""

from __future__ import annotations

import fcntl
import socket
import tempfile
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path

import pytest

# Linux gives those above to connections that ask for none.
PORTS = range(20_000, 20_200)


@contextmanager
def free_port() -> Iterator[int]:
    for port in PORTS:
        with (Path(tempfile.gettempdir()) / f"smarttestudo-test-port-{port}").open("w") as lock:
            try:
                fcntl.flock(lock, fcntl.LOCK_EX | fcntl.LOCK_NB)
                with socket.create_server(("127.0.0.1", port)):
                    pass
            except OSError:
                continue
            yield port
            return
    pytest.fail("all ports of the tests are taken")
