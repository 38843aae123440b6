# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""The subcommands of ``testudo``."""

from __future__ import annotations

import argparse

from smarttestudo import __version__
from smarttestudo.cli import (
    bag,
    check,
    demo,
    echo,
    fmt,
    incidents,
    optimize,
    profile,
    receive,
    replay,
    ruler,
    run,
    simulate,
    top,
)


def command_parser() -> argparse.ArgumentParser:
    """What understands a command line, and sets ``run`` to the function that does what it asks."""
    parser = argparse.ArgumentParser(
        prog="testudo",
        description="Adaptive monitoring for ROS 2: relay each topic at the rate that your rules give it.",
        epilog="'testudo demo' needs no robot. 'testudo COMMAND --help' explains a command.",
    )
    parser.add_argument("--version", action="version", version=f"testudo {__version__}")
    commands = parser.add_subparsers(title="commands", metavar="COMMAND", required=True)
    for command in (
        demo,
        check,
        fmt,
        run,
        receive,
        top,
        echo,
        replay,
        incidents,
        bag,
        profile,
        optimize,
        ruler,
        simulate,
    ):
        command.add_parser(commands)
    return parser
