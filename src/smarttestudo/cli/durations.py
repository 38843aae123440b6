# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""Durations on the command line."""

from __future__ import annotations

import argparse
import math

DEFAULT_TIMEOUT_S = 5.0


def duration_s(text: str) -> float:
    """A duration from the command line; ``ArgumentTypeError`` for anything but a positive number."""
    try:
        number = float(text)
    except ValueError:
        number = math.nan
    if not 0 < number < math.inf:
        raise argparse.ArgumentTypeError(f"a duration is a number of seconds above 0, not {text!r}")
    return number


def add_timeout(parser: argparse.ArgumentParser, meaning: str) -> None:
    """Add ``--timeout``, which means ``meaning``."""
    parser.add_argument(
        "--timeout",
        metavar="SECONDS",
        type=duration_s,
        default=DEFAULT_TIMEOUT_S,
        help=f"{meaning} (default: %(default)g)",
    )
