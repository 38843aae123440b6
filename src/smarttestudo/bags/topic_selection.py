# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""Topics chosen by name or pattern."""

from __future__ import annotations

from collections.abc import Collection, Sequence
from fnmatch import fnmatchcase

from smarttestudo.domain.errors import RecordingError


def is_selected(topic: str, patterns: Sequence[str]) -> bool:
    """Whether one of ``patterns`` names ``topic``; ``*``, ``?`` and ``[…]`` match as in a shell."""
    return any(topic == pattern or fnmatchcase(topic, pattern) for pattern in patterns)


def select_topics(
    patterns: Sequence[str],
    known: Collection[str],
    *,
    place: str,
    listed_by: str = "`testudo bag info` lists them",
) -> frozenset[str]:
    """The ``known`` topics that ``patterns`` name (``is_selected``).

    Raises ``RecordingError`` at ``place`` for a pattern that names none; ``listed_by`` says where to look.
    """
    chosen: set[str] = set()
    for pattern in patterns:
        named = {topic for topic in known if is_selected(topic, [pattern])}
        if not named:
            raise RecordingError(
                f"no topic {pattern}", place=place, remedy=_remedy(pattern, known) or listed_by
            )
        chosen |= named
    return frozenset(chosen)


def _remedy(pattern: str, known: Collection[str]) -> str:
    from difflib import get_close_matches  # noqa: PLC0415  most patterns name a topic

    close = get_close_matches(pattern, sorted(known), n=1)
    return f"did you mean {close[0]}?" if close else ""
