# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""The ``testudo`` command: picks the subcommand, and turns every known failure into one line.

Little is imported before ``main``, so that it also hears a Ctrl-C that comes while the rest is.
"""

from __future__ import annotations

import errno
import os
import sys
from collections.abc import Sequence
from contextlib import suppress
from io import TextIOWrapper
from typing import TextIO, cast

from smarttestudo.cli.output import write_line
from smarttestudo.cli.terminal import Terminated, is_unicode, terminating_signals
from smarttestudo.domain.errors import TestudoError, UsageError, missing_package

EXIT_ERROR = 1
EXIT_USAGE = 2
EXIT_INTERRUPTED = 130
_EXIT_SIGNALLED = 128


def main(argv: Sequence[str] | None = None) -> int:
    """Run ``testudo`` with ``argv`` (default: the process's) and return its exit code."""
    reopen_standard_streams()
    tolerate_surrogates(sys.stdout)
    try:
        with terminating_signals():
            return _run(argv)
    except UsageError as error:
        return _fail(str(error), EXIT_USAGE)
    except TestudoError as error:
        return _fail(str(error), EXIT_ERROR)
    except ModuleNotFoundError as error:
        missing = missing_package(error, "this command")
        if missing is None:
            raise
        return _fail(str(missing), EXIT_ERROR)
    except BrokenPipeError:
        # The reader of the output has gone.
        forget_output()
        return EXIT_ERROR
    except OSError as error:
        if not is_of_a_stream(error):
            raise
        forget_output()
        remedy = "write to another place"
        return _fail(f"standard output: error: cannot be written: {error.strerror}; {remedy}", EXIT_ERROR)
    except Terminated as signalled:
        return _fail("terminated", _EXIT_SIGNALLED + signalled.number)
    except KeyboardInterrupt:
        return _fail("interrupted", EXIT_INTERRUPTED)


def smart_testudo(argv: Sequence[str] | None = None) -> int:
    """Run ``testudo run``: the executable of ``ros2 run smarttestudo smart_testudo``."""
    return main(["run", *(sys.argv[1:] if argv is None else argv)])


def _run(argv: Sequence[str] | None) -> int:
    try:
        from smarttestudo.cli.commands import command_parser  # noqa: PLC0415  see above

        arguments = command_parser().parse_args(argv)
        code: int = arguments.run(arguments)
    except SystemExit:
        # Help was printed.
        sys.stdout.flush()
        raise
    sys.stdout.flush()
    return code


def _fail(line: str, code: int) -> int:
    try:
        sys.stdout.flush()
    except OSError:
        forget_output()
    with suppress(OSError):
        write_line(line, sys.stderr)
    return code


_OF_A_STREAM = frozenset({errno.ENOSPC, errno.EDQUOT, errno.EFBIG, errno.EIO, errno.EBADF})


def reopen_standard_streams() -> None:
    """Give a process that was started without them an output that refuses, and errors that go nowhere."""
    if cast("TextIO | None", sys.stdout) is None:
        # Only for reading, so that what is written fails with the system's own words.
        sys.stdout = os.fdopen(os.open(os.devnull, os.O_RDONLY), "w")
    if cast("TextIO | None", sys.stderr) is None:
        sys.stderr = os.fdopen(os.open(os.devnull, os.O_WRONLY), "w")


def tolerate_surrogates(stream: TextIO) -> None:
    """Have ``stream`` write names of files as their bytes, and replace characters that it lacks."""
    if isinstance(stream, TextIOWrapper):
        stream.reconfigure(errors="surrogateescape" if is_unicode(stream) else "replace")


def is_of_a_stream(error: OSError) -> bool:
    """Whether ``error`` is what printing raises: it has no file's name."""
    return error.filename is None and error.errno in _OF_A_STREAM


def forget_output() -> None:
    """Whatever Python still writes to standard output at the end must not complain."""
    with suppress(OSError):
        os.dup2(os.open(os.devnull, os.O_WRONLY), sys.stdout.fileno())
