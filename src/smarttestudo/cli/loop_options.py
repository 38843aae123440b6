# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""Options of every command that runs the loop."""

from __future__ import annotations

import argparse
from pathlib import Path

from smarttestudo.domain import budget
from smarttestudo.pacing.sample import WhenSlow


def add_rules(parser: argparse.ArgumentParser, *, required: bool = True) -> None:
    """Add ``--rules``, ``--profile``, ``--budget`` and ``--when-slow``."""
    parser.add_argument(
        "--rules",
        metavar="FILE",
        nargs="+",
        action="extend",
        type=Path,
        required=required,
        help="rule files, or folders of them; several form one set",
    )
    parser.add_argument("--profile", metavar="FILE", type=Path, help="what is known about the topics (TOML)")
    parser.add_argument(
        "--budget",
        metavar="N",
        type=budget_kb_per_s,
        help="KB/s that all relayed topics together may take; rates are cut by priority, not below floors",
    )
    add_when_slow(parser)


def add_when_slow(parser: argparse.ArgumentParser) -> None:
    """Add ``--when-slow``."""
    parser.add_argument(
        "--when-slow",
        choices=[mode.value for mode in WhenSlow],
        default=WhenSlow.PASS.value,
        help="what to do where a target is above its source: pass what comes (default), or repeat the newest",
    )


def add_ros_arguments(parser: argparse.ArgumentParser) -> None:
    """Add ``--ros-args``, which takes all that follows."""
    parser.add_argument(
        "--ros-args",
        metavar="ARG",
        nargs=argparse.REMAINDER,
        default=[],
        help="all that follows goes to ROS, as in --ros-args -r __ns:=/tb3_0 -p use_sim_time:=true",
    )


def budget_kb_per_s(text: str) -> float:
    """A budget from the command line; ``ArgumentTypeError`` for anything but a number of KB/s."""
    try:
        return budget.budget_kb_per_s(text)
    except ValueError as error:
        raise argparse.ArgumentTypeError(str(error)) from error
