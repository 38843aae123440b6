# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""Parsers of ``testudo``: a command is imported when it is named, and a wrong command line is one line."""

from __future__ import annotations

import argparse
import re
from collections.abc import Callable, Sequence
from importlib import import_module
from typing import TYPE_CHECKING, Any, NoReturn

from smarttestudo.domain.errors import UsageError

if TYPE_CHECKING:
    Subcommands = argparse._SubParsersAction["CommandParser"]  # noqa: SLF001  argparse has no other name for it

_ARGUMENT = re.compile(r"argument (?P<place>[^:]+): (?P<cause>.+)", re.DOTALL)


class CommandParser(argparse.ArgumentParser):
    """The arguments of a command, which ``fill`` adds when the first command line is parsed.

    Options cannot be abbreviated: a later version may add one that begins the same. ``parse_args`` raises
    ``UsageError`` in place of printing the usage.
    """

    def __init__(self, *, fill: Callable[[CommandParser], None] | None = None, **options: Any) -> None:
        super().__init__(allow_abbrev=False, **options)
        self._fill = fill

    def add_commands(self, title: str) -> Subcommands:
        """Add subcommands, one of which must be named; ``title`` is their plural."""
        return self.add_subparsers(title=title, metavar=title.removesuffix("s").upper(), required=True)

    def fill(self) -> None:
        """Add the arguments, unless they were added."""
        fill, self._fill = self._fill, None
        if fill is not None:
            fill(self)

    def parse_known_args(  # type: ignore[override]
        self, args: Sequence[str] | None = None, namespace: argparse.Namespace | None = None
    ) -> tuple[argparse.Namespace, list[str]]:
        """Parse once the arguments are there; raises ``UsageError``, also where some are not known."""
        self.fill()
        known, unknown = super().parse_known_args(args, namespace)
        if unknown:
            self.error(f"unrecognized arguments: {' '.join(unknown)}")
        return known, unknown

    def error(self, message: str) -> NoReturn:
        """Raise ``UsageError`` with argparse's words, the argument as its place."""
        found = _ARGUMENT.fullmatch(message)
        place, cause = (found["place"], found["cause"]) if found else (None, message)
        raise UsageError(" ".join(cause.split()), place=place, remedy=f"see '{self.prog} --help'")


def add_lazy(commands: Subcommands, name: str, module: str, purpose: str) -> None:
    """Add a subcommand whose ``module`` adds its arguments, and is imported when the subcommand is named."""

    def fill(parser: CommandParser) -> None:
        import_module(module).add_arguments(parser)

    commands.add_parser(name, help=purpose, fill=fill)
