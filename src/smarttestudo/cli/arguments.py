# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""Values from the command line; ``ArgumentTypeError`` for what is none."""

from __future__ import annotations

import argparse
import math
import os
from collections.abc import Callable
from pathlib import Path

from smarttestudo.domain import profile
from smarttestudo.rules.rule_files import STANDARD_INPUT

LAST_PORT = 65_535
_MOST_DIGITS = 20


def file_path(text: str) -> Path:
    """A path from the command line; ``ArgumentTypeError`` for an empty one, which would be this folder."""
    if not text:
        raise argparse.ArgumentTypeError("the name of a file or folder is not empty")
    return Path(text)


def add_rule_files(parser: argparse.ArgumentParser) -> None:
    """Add the rule files that are only read or formatted; ``-`` is ``STANDARD_INPUT``."""
    parser.add_argument(
        "files",
        metavar="FILE",
        nargs="+",
        type=lambda text: STANDARD_INPUT if text == "-" else file_path(text),
        help="a rule file, a folder of them, or - for standard input",
    )


def own_name(path: Path) -> str:
    """Own name of the file or folder at ``path``, also where that is ``.`` or a link."""
    return Path(os.path.realpath(path)).name


def budget_kb_per_s(text: str) -> float:
    """A budget from the command line; ``ArgumentTypeError`` for anything but a number of KB/s."""
    try:
        return profile.budget_kb_per_s(text)
    except ValueError as error:
        raise argparse.ArgumentTypeError(str(error)) from error


def number_type(accepts: Callable[[float], bool], *, refusal: str) -> Callable[[str], float]:
    """Reader of numbers that ``accepts`` takes; in ``refusal``, ``{}`` stands for any other text."""

    def read(text: str) -> float:
        try:
            number = float(text)
        except ValueError:
            number = math.nan
        if not accepts(number):
            raise argparse.ArgumentTypeError(refusal.format(f"{text!r:.40}"))
        return number

    return read


def whole_number_type(least: int, most: float, *, refusal: str) -> Callable[[str], int]:
    """Reader of whole numbers in digits from ``least`` to ``most``; ``refusal`` as of ``number_type``."""

    def read(text: str) -> int:
        is_number = text.isascii() and text.isdigit() and len(text) <= _MOST_DIGITS
        if not is_number or not least <= int(text) <= most:
            raise argparse.ArgumentTypeError(refusal.format(f"{text!r:.40}"))
        return int(text)

    return read


duration_s = number_type(
    lambda number: 0 < number < math.inf, refusal="a duration is a number of seconds above 0, not {}"
)
DEFAULT_TIMEOUT_S = 5.0


def add_timeout(parser: argparse.ArgumentParser, meaning: str) -> None:
    parser.add_argument(
        "--timeout",
        metavar="SECONDS",
        type=duration_s,
        default=DEFAULT_TIMEOUT_S,
        help=f"{meaning} (default: %(default)g)",
    )
