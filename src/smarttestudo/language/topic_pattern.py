# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""Patterns of topics: which names they match, and which of two counts."""

from __future__ import annotations

from collections.abc import Collection, Sequence
from functools import cache

from smarttestudo.domain.names import OWN_PREFIX
from smarttestudo.domain.robot import is_visible

ONE_NAME, ANY_NAMES = "*", "**"
"""In a pattern, any one name, and any number of names, none included."""


def may_match(topic: str) -> bool:
    """Whether patterns match ``topic`` at all: not what is hidden, ROS's own or SmartTestudo's."""
    return is_visible(topic) and not topic.startswith(OWN_PREFIX)


def matching(pattern: str, topics: Collection[str]) -> list[str]:
    """The ``topics`` that ``pattern`` matches, by name; all are full names."""
    parts = pattern.split("/")
    beginning = literal_beginning(pattern).rpartition("/")[0]
    return sorted(
        topic
        for topic in topics
        if topic.startswith(beginning) and _matches(parts, topic.split("/")) and may_match(topic)
    )


def literal_beginning(pattern: str) -> str:
    """The text before the first ``*``."""
    return pattern.partition(ONE_NAME)[0]


def standing(name: str) -> tuple[bool, int]:
    """How much a topic or pattern counts beside others that match one topic: the greatest counts.

    A full name beats any pattern, a longer literal beginning a shorter one.
    """
    beginning = literal_beginning(name)
    return beginning == name, len(beginning)


def _matches(parts: Sequence[str], names: Sequence[str]) -> bool:
    """Whether a pattern matches a name: where it fails, the last ``**`` takes one name more.

    An earlier one need not: what stands between the two matched as soon as it could.
    """
    part = name = 0
    last: tuple[int, int] | None = None
    while name < len(names):
        if part < len(parts) and parts[part] == ANY_NAMES:
            part += 1
            last = part, name
        elif part < len(parts) and parts[part] in (ONE_NAME, names[name]):
            part, name = part + 1, name + 1
        elif last is not None:
            last = last[0], last[1] + 1
            part, name = last
        else:
            return False
    return all(left == ANY_NAMES for left in parts[part:])


def may_overlap(pattern: str, other: str) -> bool:
    """Whether some topic can match both patterns."""
    parts, others = pattern.split("/"), other.split("/")

    @cache
    def overlap(at: int, beside: int) -> bool:
        if at == len(parts) or beside == len(others):
            return all(part == ANY_NAMES for part in (*parts[at:], *others[beside:]))
        one, another = parts[at], others[beside]
        if ANY_NAMES in (one, another):
            # Either it matches nothing more, or the name beside it, too.
            return overlap(at + 1, beside) or overlap(at, beside + 1)
        return (one == another or ONE_NAME in (one, another)) and overlap(at + 1, beside + 1)

    return overlap(0, 0)
