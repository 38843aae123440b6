# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""The commands: each is imported when it is named, and a wrong command line is one line."""

from __future__ import annotations

import argparse
import re
import sys
from collections.abc import Callable, Iterable, Sequence
from difflib import get_close_matches
from importlib import import_module
from typing import TYPE_CHECKING, Any, NoReturn

from smarttestudo import __version__
from smarttestudo.domain.errors import UsageError

if TYPE_CHECKING:
    Subcommands = argparse._SubParsersAction["CommandParser"]  # noqa: SLF001  argparse has no other name for it


_ARGUMENT = re.compile(r"argument (?P<place>[^:]+): (?P<cause>.+)", re.DOTALL)
_CHOICE = re.compile(r"(?P<cause>invalid choice: '(?P<word>.*)') \(choose from (?P<choices>.+)\)", re.DOTALL)
_QUOTES = "'\""


class CommandParser(argparse.ArgumentParser):
    """The arguments of a command, which ``fill`` adds when the first command line is parsed.

    Options cannot be abbreviated: a later version may add one that begins the same. ``parse_args`` raises
    ``UsageError`` in place of printing the usage.
    """

    def __init__(self, *, fill: Callable[[CommandParser], None] | None = None, **options: Any) -> None:
        super().__init__(allow_abbrev=False, **options)
        self._fill = fill
        self._given: Sequence[str] = ()

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
        self._given = sys.argv[1:] if args is None else args
        known, unknown = super().parse_known_args(args, namespace)
        for action in self._get_positional_actions():
            # Before Python 3.13, one that may be left out is looked for in front of options only.
            is_left_out = action.nargs == argparse.OPTIONAL and getattr(known, action.dest) == action.default
            if is_left_out and unknown and not unknown[0].startswith("-"):
                setattr(known, action.dest, self._late(action, unknown.pop(0)))
        if unknown:
            self.error(f"unrecognized arguments: {' '.join(unknown)}")
        return known, unknown

    def _late(self, action: argparse.Action, text: str) -> object:
        try:
            return self._get_value(action, text)
        except argparse.ArgumentError as error:
            self.error(str(error))

    def error(self, message: str) -> NoReturn:
        """Raise ``UsageError`` with argparse's words, the argument as its place, and what was meant."""
        found = _ARGUMENT.fullmatch(message)
        place, cause = (found["place"], found["cause"]) if found else (None, message)
        remedy = f"see '{self.prog} --help'"
        if choice := _CHOICE.fullmatch(cause):
            near = _near(choice["word"], (one.strip(_QUOTES) for one in choice["choices"].split(", ")))
            cause, remedy = (choice["cause"], f"did you mean {near}?") if near else (cause, remedy)
        elif found is None and (misspelled := self._misspelled()):
            # Where an option lacks, it may be the one that is misspelled.
            option, near = misspelled
            cause, remedy = f"unrecognized arguments: {option}", f"did you mean {near}?"
        raise UsageError(" ".join(cause.split()), place=place, remedy=remedy)

    def _misspelled(self) -> tuple[str, str] | None:
        """The first option given that is not known, and the one that it is nearly."""
        options = self._option_string_actions
        for word in self._given:
            option = word.partition("=")[0]
            known = options.get(option)
            if word == "--" or (known is not None and known.nargs == argparse.REMAINDER):
                return None
            if known is None and word.startswith("-") and (near := _near(option, options)):
                return option, near
        return None


def _near(word: str, known: Iterable[str]) -> str | None:
    return next(iter(get_close_matches(word.lower(), list(known), n=1)), None)


def add_lazy(commands: Subcommands, name: str, module: str, purpose: str) -> None:
    """Add a subcommand whose ``module`` adds its arguments, and is imported when the subcommand is named."""

    def fill(parser: CommandParser) -> None:
        import_module(module).add_arguments(parser)

    commands.add_parser(name, help=purpose, fill=fill)


_PURPOSES = {
    "demo": "watch a simulated robot cross a warehouse, with and without adaptive monitoring",
    "check": "report errors and doubtful rules in rule files",
    "fmt": "format rule files in place",
    "run": "relay a running robot's topics at the rates that your rules give them now",
    "receive": "receive what robots send with 'testudo run --link'",
    "top": "show what running SmartTestudo nodes relay, and why",
    "echo": "subscribe to topics: their rates, bandwidth and last values",
    "why": "say which rule gives a topic its rate, and which values would change it",
    "push": "let a running robot follow other rules, on trial and then for good",
    "replay": "write the recording that an operator would have received under your rules",
    "incidents": "list, show, fetch, export and delete what rules recorded",
    "bag": "measure and compare recordings: rates, bandwidth, losses",
    "profile": "measure sizes and rates, and propose levels",
    "optimize": "turn quality levels into rates within the budget",
    "ruler": "build, check and optimize rules on a web page",
    "simulate": "publish the topics of a simulated robot on a real ROS graph",
    "completion": "print what a shell needs to complete command lines",
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
