# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""The ``testudo`` command: picks the subcommand, and turns every known failure into one line.

Little is imported before ``main``, so that it also hears a Ctrl-C that comes while the rest is.
"""

from __future__ import annotations

import sys
from collections.abc import Sequence
from contextlib import suppress

from smarttestudo.cli.standard_streams import forget_output, is_of_a_stream, open_closed_streams
from smarttestudo.cli.terminal import Terminated, terminating_signals
from smarttestudo.domain.errors import TestudoError, UsageError
from smarttestudo.domain.packages import missing_package

EXIT_ERROR = 1
EXIT_USAGE = 2
EXIT_INTERRUPTED = 130
_EXIT_SIGNALLED = 128


def main(argv: Sequence[str] | None = None) -> int:
    """Run ``testudo`` with ``argv`` (default: the process's) and return its exit code."""
    open_closed_streams()
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
    """Be ``testudo run``: the executable of ``ros2 run smarttestudo smart_testudo``."""
    return main(["run", *(sys.argv[1:] if argv is None else argv)])


def _run(argv: Sequence[str] | None) -> int:
    from smarttestudo.cli.commands import command_parser  # noqa: PLC0415  see above

    try:
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
        print(line, file=sys.stderr)  # noqa: T201
    return code
