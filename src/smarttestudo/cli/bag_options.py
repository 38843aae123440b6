# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""Options that the actions of ``testudo bag`` share."""

from __future__ import annotations

import argparse
from collections.abc import Sequence

from smarttestudo.domain.errors import UsageError


def add_topics(action: argparse.ArgumentParser) -> None:
    """Add ``--topics``."""
    action.add_argument(
        "--topics",
        metavar="NAME",
        nargs="+",
        action="extend",
        default=[],
        help="only these topics, by name or pattern ('/camera/*')",
    )


def add_topics_and_form(action: argparse.ArgumentParser) -> None:
    """Add ``--topics``, and ``--json`` or ``--csv``."""
    add_topics(action)
    form = action.add_mutually_exclusive_group()
    form.add_argument("--json", action="store_true", help="print one JSON object instead of tables")
    form.add_argument("--csv", action="store_true", help="print comma-separated values instead of tables")


def add_map(action: argparse.ArgumentParser) -> None:
    """Add ``--map``."""
    action.add_argument(
        "--map",
        metavar="/a=/b",
        action="append",
        default=[],
        type=_topic_pair,
        help="pair A's /a with B's /b; may be given several times",
    )


def topic_mapping(pairs: Sequence[tuple[str, str]]) -> dict[str, str]:
    """What ``--map`` says; ``UsageError`` for a topic that is paired twice."""
    mapping = dict(pairs)
    if len(mapping) < len(pairs) or len(set(mapping.values())) < len(mapping):
        raise UsageError("a topic is paired twice", place="--map", remedy="give each topic once")
    return mapping


def _topic_pair(text: str) -> tuple[str, str]:
    a, separator, b = text.partition("=")
    if not (a and separator and b):
        raise argparse.ArgumentTypeError(f"two topics are paired as in /a=/b, not {text!r}")
    return a, b
