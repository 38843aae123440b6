# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""Options of the commands that simulate a robot."""

from __future__ import annotations

import argparse

_MIN_SECONDS = 1.0
_MAX_SECONDS = 86_400.0


def add_simulation(parser: argparse.ArgumentParser, *, full_images_help: str) -> None:
    """Add ``--seed`` and ``--full-images``."""
    parser.add_argument(
        "--seed", metavar="N", type=_seed, default=0, help="fixes all noise (default: %(default)s)"
    )
    parser.add_argument("--full-images", action="store_true", help=full_images_help)


def seconds(text: str) -> float:
    """A duration from the command line; ``ArgumentTypeError`` for anything but 1 s to a day."""
    try:
        number = float(text)
    except ValueError:
        number = 0.0
    if not _MIN_SECONDS <= number <= _MAX_SECONDS:
        raise argparse.ArgumentTypeError(f"{text!r} is not a number of seconds from 1 to {_MAX_SECONDS:.0f}")
    return number


def _seed(text: str) -> int:
    if not (text.isascii() and text.isdigit()):
        raise argparse.ArgumentTypeError(f"{text!r} is not a whole number of 0 or more")
    return int(text)
