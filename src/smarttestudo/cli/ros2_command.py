# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""``ros2 testudo``: an entry point of ros2cli, which asks for these two methods and is not imported."""

from __future__ import annotations

import argparse

from smarttestudo.cli.main import main


class TestudoCommand:
    """Run a command of SmartTestudo, as testudo does."""

    __test__ = False

    def add_arguments(self, parser: argparse.ArgumentParser, _cli_name: str) -> None:
        """Take all that follows, ``--help`` and ``--version`` included."""
        parser.prefix_chars = ""
        parser.add_argument("arguments", nargs=argparse.REMAINDER)

    def main(self, *, parser: argparse.ArgumentParser, args: argparse.Namespace) -> int:  # noqa: ARG002  ros2cli names them
        """Run it, and return its exit code."""
        return main(args.arguments)
