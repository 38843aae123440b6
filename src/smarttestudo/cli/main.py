# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""The ``testudo`` command: picks the subcommand, and turns every known failure into one line."""

from __future__ import annotations

import argparse
import os
import sys
from collections.abc import Sequence

from smarttestudo import __version__
from smarttestudo.cli import bag, check, demo, fmt, optimize, profile, replay, ruler, run, simulate, top
from smarttestudo.domain.errors import TestudoError, UsageError

EXIT_ERROR = 1
EXIT_USAGE = 2
EXIT_INTERRUPTED = 130
STUDIO_PACKAGES = frozenset(
    {
        "apsw",
        "highspy",
        "lz4",
        "mcap",
        "msgspec",
        "numpy",
        "PIL",
        "rich",
        "rosbags",
        "ruamel",
        "starlette",
        "uvicorn",
        "websockets",
        "zstandard",
    }
)


def main(argv: Sequence[str] | None = None) -> int:
    """Run ``testudo`` with ``argv`` (default: the process's) and return its exit code."""
    arguments = _parser().parse_args(argv)
    try:
        code: int = arguments.run(arguments)
        sys.stdout.flush()
    except UsageError as error:
        return _fail(str(error), EXIT_USAGE)
    except TestudoError as error:
        return _fail(str(error), EXIT_ERROR)
    except ModuleNotFoundError as error:
        if (error.name or "").partition(".")[0] not in STUDIO_PACKAGES:
            raise
        remedy = "pip install 'smarttestudo[studio]'"
        return _fail(f"error: this command needs the package {error.name}; {remedy}", EXIT_ERROR)
    except BrokenPipeError:
        # The reader of our output has gone; whatever Python still flushes at exit must not complain.
        os.dup2(os.open(os.devnull, os.O_WRONLY), sys.stdout.fileno())
        return EXIT_ERROR
    except KeyboardInterrupt:
        return _fail("interrupted", EXIT_INTERRUPTED)
    return code


def smart_testudo(argv: Sequence[str] | None = None) -> int:
    """Be ``testudo run``: the executable of ``ros2 run smarttestudo smart_testudo``."""
    return main(["run", *(sys.argv[1:] if argv is None else argv)])


def _parser() -> argparse.ArgumentParser:
    parser = argparse.ArgumentParser(
        prog="testudo",
        description="Adaptive monitoring for ROS 2 robots: each topic at the rate your rules give it now.",
        epilog="'testudo demo' needs no robot. 'testudo COMMAND --help' explains a command.",
    )
    parser.add_argument("--version", action="version", version=f"testudo {__version__}")
    commands = parser.add_subparsers(title="commands", metavar="COMMAND", required=True)
    for command in (demo, check, fmt, run, top, replay, bag, profile, optimize, ruler, simulate):
        command.add_parser(commands)
    return parser


def _fail(line: str, code: int) -> int:
    print(line, file=sys.stderr)  # noqa: T201
    return code
