# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""The Ruler's server, for benchmarks of its page."""

from __future__ import annotations

import subprocess
import sys
from collections.abc import Iterator, Mapping
from contextlib import contextmanager
from pathlib import Path


@contextmanager
def served(folder: Path, environment: Mapping[str, str]) -> Iterator[str]:
    """``testudo ruler`` on a free port; yields its address."""
    command = [sys.executable, "-m", "smarttestudo", "ruler", str(folder), "--port", "0", "--no-browser"]
    settings = {**environment, "PYTHONUNBUFFERED": "1"}
    with subprocess.Popen(command, stdout=subprocess.PIPE, text=True, env=settings) as server:
        assert server.stdout is not None
        try:
            yield server.stdout.readline().split(": ", 1)[1].split()[0]
        finally:
            server.terminate()
