# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""Python processes that are forked from one that has imported SmartTestudo, so that none imports it again.

What they run is real, with a number, streams, an environment and signals of its own; only the second of
imports is spent once for each worker of the tests. That commands start from nothing is tested where they are
started with ``subprocess``.
"""

from __future__ import annotations

import atexit
import functools
import json
import os
import select
import signal
import socket
import subprocess
import sys
from collections.abc import Mapping, Sequence
from contextlib import suppress
from pathlib import Path
from typing import TextIO

SERVER = Path(__file__).parent / "fork_server.py"
# A parent of another environment leaves these, and then the ROS of this one does not load.
NOT_INHERITED = ("_ROS_WHEELS_BOOTSTRAP_COMPLETE", "LD_LIBRARY_PATH")


def inherited(environment: Mapping[str, str]) -> dict[str, str]:
    """What a process of the ROS that this one uses may have of its environment."""
    # A setup file that was sourced means its LD_LIBRARY_PATH; ROS 2 from PyPI is none that could be.
    is_sourced = "AMENT_PREFIX_PATH" in environment
    return {
        name: value
        for name, value in environment.items()
        if name not in NOT_INHERITED or (is_sourced and name == "LD_LIBRARY_PATH")
    }


class ForkedPython:
    """``python ARGUMENTS``, as far as tests need of a ``Popen`` in text mode.

    Its standard error goes where its output does, or to the open file ``stderr``.
    """

    def __init__(
        self, arguments: Sequence[str], environment: Mapping[str, str], *, stderr: int | None = None
    ) -> None:
        own_stdin, stdin = os.pipe()
        stdout, own_stdout = os.pipe()
        told, own_told = os.pipe()
        request = {"arguments": arguments, "environment": {**environment}, "folder": str(Path.cwd())}
        files = [own_stdin, own_stdout, own_stdout if stderr is None else stderr, own_told]
        socket.send_fds(fork_server(), [json.dumps(request).encode()], files)
        for file in (own_stdin, own_stdout, own_told):
            os.close(file)
        self.stdin: TextIO = os.fdopen(stdin, "w", encoding="utf-8")
        self.stdout: TextIO = os.fdopen(stdout, encoding="utf-8")
        self.returncode: int | None = None
        # Unbuffered: ``select`` sees what has come.
        self._told = os.fdopen(told, "rb", buffering=0)
        self.pid = int(self._told.readline())

    def poll(self) -> int | None:
        """The exit code, negative for a signal, or ``None`` while it runs."""
        if self.returncode is None and select.select([self._told], [], [], 0)[0]:
            self.returncode = self._read_exit_code()
        return self.returncode

    def wait(self, timeout_s: float | None = None) -> int:
        """Its exit code; raises what a ``Popen`` raises if it takes longer."""
        if self.returncode is None:
            if not select.select([self._told], [], [], timeout_s)[0]:
                raise subprocess.TimeoutExpired(str(self.pid), timeout_s or 0)
            self.returncode = self._read_exit_code()
        return self.returncode

    def send_signal(self, number: int) -> None:
        if self.poll() is None:
            # It may end right now.
            with suppress(ProcessLookupError):
                os.kill(self.pid, number)

    def kill(self) -> None:
        self.send_signal(signal.SIGKILL)

    def _read_exit_code(self) -> int:
        with self._told as told:
            return int(told.readline())


@functools.cache
def fork_server() -> socket.socket:
    """The socket of this worker's server, which ends with this process."""
    ours, its = socket.socketpair(socket.AF_UNIX, socket.SOCK_SEQPACKET)
    with its:
        server = subprocess.Popen(
            [sys.executable, str(SERVER), str(its.fileno())],
            pass_fds=[its.fileno()],
            # A process with threads is not forked.
            env=inherited(os.environ) | {"OPENBLAS_NUM_THREADS": "1"},
        )

    def end() -> None:
        ours.close()
        server.wait()

    atexit.register(end)
    return ours
