# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""Processes at the ends of a thin link."""

from __future__ import annotations

import os
import sys
from collections.abc import Iterator, Sequence
from contextlib import contextmanager

from live.processes import Process
from thin_link.fast_dds import ENVIRONMENT
from thin_link.network_namespaces import in_namespace


@contextmanager
def process(namespace: str, command: Sequence[str]) -> Iterator[Process]:
    """A process in a namespace, which is ended at the end."""
    environment = {**os.environ, **ENVIRONMENT, "PYTHONPATH": os.pathsep.join(sys.path)}
    started = Process(in_namespace(namespace, command), environment)
    try:
        yield started
    finally:
        started.end()


@contextmanager
def role(namespace: str, *arguments: str) -> Iterator[Process]:
    """A process of one end, which is ended at the end."""
    with process(namespace, [sys.executable, "-m", "thin_link.role_process", *arguments]) as started:
        yield started
