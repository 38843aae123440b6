# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""A Dask scheduler and workers as processes, on the loopback."""

from __future__ import annotations

import json
import os
import signal
import subprocess
import sys
import time
from collections.abc import Iterator
from contextlib import contextmanager, suppress
from dataclasses import dataclass
from pathlib import Path

TESTS = Path(__file__).parents[2]
_WITHIN_S = 60


@dataclass(frozen=True, slots=True, kw_only=True)
class DaskProcesses:
    address: str
    scheduler: subprocess.Popen[bytes]
    workers: tuple[subprocess.Popen[bytes], ...]


@contextmanager
def dask_processes(
    folder: Path, *, workers: int = 2, python: str = sys.executable
) -> Iterator[DaskProcesses]:
    """They end with the block, as far as they still are; a worker that ends is not replaced."""
    file = folder / "scheduler.json"
    started: list[subprocess.Popen[bytes]] = []
    try:
        started.append(_start(python, folder, "scheduler", "--port", "0", "--host", "127.0.0.1"))
        end_s = time.monotonic() + _WITHIN_S
        # A file is there before anything is in it.
        while not file.exists() or not (said := file.read_text()).endswith("}"):
            assert time.monotonic() < end_s
            time.sleep(0.05)
        begun = ("worker", "--nthreads", "1", "--no-nanny")
        started += [_start(python, folder, *begun) for _ in range(workers)]
        address = json.loads(said)["address"]
        yield DaskProcesses(address=address, scheduler=started[0], workers=tuple(started[1:]))
    finally:
        for process in started:
            # A test may have ended it.
            with suppress(ProcessLookupError):
                os.killpg(process.pid, signal.SIGKILL)
            process.wait()


def _start(python: str, folder: Path, *arguments: str) -> subprocess.Popen[bytes]:
    """``dask`` with ``arguments``; a task that ended two workers is not tried again."""
    variables = {
        **os.environ,
        "PYTHONPATH": os.pathsep.join((str(TESTS), os.environ.get("PYTHONPATH", ""))),
        "DASK_DISTRIBUTED__SCHEDULER__ALLOWED_FAILURES": "1",
        # A cluster that waits would take a tenth of a processor.
        "DASK_DISTRIBUTED__ADMIN__TICK__INTERVAL": "500ms",
        "DASK_DISTRIBUTED__WORKER__PROFILE__ENABLED": "False",
    }
    return subprocess.Popen(
        [python, "-m", "dask", *arguments, "--no-dashboard", "--scheduler-file", "scheduler.json"],
        cwd=folder,
        env=variables,
        stdout=subprocess.DEVNULL,
        stderr=subprocess.DEVNULL,
        start_new_session=True,
    )
