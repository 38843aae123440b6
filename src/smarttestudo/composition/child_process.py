# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""Another ``testudo`` as a process of its own."""

from __future__ import annotations

import signal
import subprocess
import sys
from collections.abc import Iterator, Sequence
from contextlib import contextmanager
from pathlib import Path

from smarttestudo.domain.errors import TestudoError

_END_TIMEOUT_S = 10.0


class ChildProcess:
    """A running ``testudo``, whose output goes to the file ``log``."""

    def __init__(self, name: str, process: subprocess.Popen[bytes], log: Path) -> None:
        self._name = name
        self._process = process
        self._log = log

    def is_running(self) -> bool:
        """Whether it still runs. Raises ``TestudoError`` with the last line of its log where it failed."""
        code = self._process.poll()
        if code in (None, 0):
            return code is None
        lines = self._log.read_text(encoding="utf-8", errors="replace").splitlines()
        said = lines[-1] if lines else f"exit code {code}"
        raise TestudoError(f"the {self._name} failed: {said}")

    def end(self) -> None:
        """Ask it to end as by Ctrl-C, and make it if it does not."""
        self._process.send_signal(signal.SIGINT)
        try:
            self._process.wait(_END_TIMEOUT_S)
        except subprocess.TimeoutExpired:
            self._process.kill()
            self._process.wait()


@contextmanager
def child_process(name: str, arguments: Sequence[str], log: Path) -> Iterator[ChildProcess]:
    """``testudo`` with ``arguments`` while the block lasts, then ended."""
    with log.open("wb") as output:
        process = subprocess.Popen(  # noqa: S603  our own program, with arguments that we make
            [sys.executable, "-m", "smarttestudo", *arguments],
            stdin=subprocess.DEVNULL,
            stdout=output,
            stderr=subprocess.STDOUT,
            # Ctrl-C in the terminal ends this process, which ends the others in order.
            start_new_session=True,
        )
        child = ChildProcess(name, process, log)
        try:
            yield child
        finally:
            child.end()
