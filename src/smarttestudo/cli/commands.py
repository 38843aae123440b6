# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""The subcommands of ``testudo``."""

from __future__ import annotations

from smarttestudo import __version__
from smarttestudo.cli.command_parser import CommandParser, add_lazy

_PURPOSES = {
    "demo": "watch a simulated robot cross a warehouse, with and without adaptive monitoring",
    "check": "report errors and doubtful rules in rule files",
    "fmt": "format rule files in place",
    "run": "relay a running robot's topics at the rates that your rules give them now",
    "receive": "receive what robots send with 'testudo run --link'",
    "top": "show what running SmartTestudo nodes relay, and why",
    "echo": "subscribe to topics: their rates, bandwidth and last values",
    "replay": "write the recording that an operator would have received under your rules",
    "incidents": "list, show, fetch, export and delete what rules recorded",
    "bag": "measure and compare recordings: rates, bandwidth, losses",
    "profile": "measure sizes and rates, and propose levels",
    "optimize": "turn quality levels into rates within the budget",
    "ruler": "build, check and optimize rules on a web page",
    "simulate": "publish the topics of a simulated robot on a real ROS graph",
}


def command_parser() -> CommandParser:
    """The parser of ``testudo``, which sets ``run`` to the function that does what a command line asks."""
    parser = CommandParser(
        prog="testudo",
        description="Adaptive monitoring for ROS 2: relay each topic at the rate that your rules give it.",
        epilog="'testudo demo' needs no robot. 'testudo COMMAND --help' explains a command.",
    )
    parser.add_argument("--version", action="version", version=f"testudo {__version__}")
    commands = parser.add_commands("commands")
    for name, purpose in _PURPOSES.items():
        add_lazy(commands, name, f"smarttestudo.cli.{name}", purpose)
    return parser
