# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""The Ruler's server and the Chromium of this machine, for benchmarks of the page."""

from __future__ import annotations

import shutil
import subprocess
import sys
from collections.abc import Iterator, Mapping
from contextlib import contextmanager
from pathlib import Path

_CHROMIUM_NAMES = ("chromium", "chromium-browser", "google-chrome")


def chromium_path() -> str:
    """The Chromium that is installed; ends the benchmark where none is."""
    found = next((path for name in _CHROMIUM_NAMES if (path := shutil.which(name))), None)
    if found is None:
        raise SystemExit("this benchmark needs Chromium")
    return found


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
