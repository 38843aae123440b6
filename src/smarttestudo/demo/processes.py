# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""The processes of a demo: started, watched and ended in order."""

from __future__ import annotations

import signal
import subprocess
import sys
import time
from collections.abc import Iterator, Mapping, Sequence
from contextlib import contextmanager
from pathlib import Path

from smarttestudo.domain.errors import TestudoError

_END_TIMEOUT_S = 10.0
_POLL_S = 0.05


class ChildProcess:
    """A running process, whose output goes to the file ``log``."""

    def __init__(self, name: str, process: subprocess.Popen[bytes], log: Path) -> None:
        self._name = name
        self._process = process
        self._log = log

    def is_running(self) -> bool:
        """Whether it still runs. Raises ``TestudoError`` with the last line of its log where it failed."""
        code = self._process.poll()
        if code in (None, 0):
            return code is None
        lines = self._said().splitlines()
        said = lines[-1] if lines else f"exit code {code}"
        raise TestudoError(f"the {self._name} failed: {said}")

    def await_text(self, text: str, timeout_s: float) -> None:
        """Return once it said ``text``. Raises ``TestudoError`` if it ends or ``timeout_s`` pass before."""
        end_s = time.monotonic() + timeout_s
        while text not in self._said():
            if not self.is_running() or time.monotonic() > end_s:
                raise TestudoError(f"the {self._name} did not get as far as {text!r} in {timeout_s:g} s")
            time.sleep(_POLL_S)

    def end(self) -> None:
        """Ask it to end as by Ctrl-C, and make it if it does not."""
        self._process.send_signal(signal.SIGINT)
        try:
            self._process.wait(_END_TIMEOUT_S)
        except subprocess.TimeoutExpired:
            self._process.kill()
            self._process.wait()

    def _said(self) -> str:
        return self._log.read_text(encoding="utf-8", errors="replace")


def testudo_command(*arguments: str) -> list[str]:
    """The command line of ``testudo`` with ``arguments``."""
    return [sys.executable, "-m", "smarttestudo", *arguments]


@contextmanager
def child_process(
    name: str, command: Sequence[str], log: Path, environment: Mapping[str, str] | None = None
) -> Iterator[ChildProcess]:
    """``command`` while the block lasts, then ended; ``environment`` is this process's unless given."""
    with log.open("wb") as output:
        process = subprocess.Popen(  # noqa: S603  our own programs, with arguments that we make
            command,
            stdin=subprocess.DEVNULL,
            stdout=output,
            stderr=subprocess.STDOUT,
            env=environment,
            # Ctrl-C in the terminal ends this process, which ends the others in order.
            start_new_session=True,
        )
        child = ChildProcess(name, process, log)
        try:
            yield child
        finally:
            child.end()
