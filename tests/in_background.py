# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""Runs a command in the background of a terminal, as a shell does with &, and ends with its exit code.

Usage: in_background.py COMMAND …. If the command is stopped because it asks for the terminal, it is killed.
"""

from __future__ import annotations

import os
import pty
import signal
import sys
from contextlib import suppress

_STOPPED = 99


def main(command: list[str]) -> int:
    """Be the terminal: show what is written there."""
    shell, screen = pty.fork()
    if shell == 0:
        os._exit(_exit_code(command))
    # The end of what a terminal shows is an error on Linux.
    with suppress(OSError):
        while shown := os.read(screen, 4096):
            os.write(sys.stdout.fileno(), shown)
    return os.waitstatus_to_exitcode(os.waitpid(shell, 0)[1])


def _exit_code(command: list[str]) -> int:
    """Be the shell, which stays in front."""
    job = os.fork()
    if job == 0:
        os.setpgid(0, 0)
        os.execvp(command[0], command)
    _, status = os.waitpid(job, os.WUNTRACED)
    if not os.WIFSTOPPED(status):
        return os.waitstatus_to_exitcode(status)
    os.kill(job, signal.SIGKILL)
    return _STOPPED


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
