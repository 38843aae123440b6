# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""Who is at the ends of many topics, asked for cheaply and often."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Sequence

from smarttestudo.domain.robot import Endpoint

LOOKS_PER_ROUND = 5


class Roster:
    """The endpoints of topics. At each look, ``count`` asks how many every topic has.

    ``find`` costs several times as much: it is asked where the number changed, and for a fifth of the others
    in turn, so that one that was replaced by another is noticed too.
    """

    def __init__(self, count: Callable[[str], int], find: Callable[[str], Sequence[Endpoint]]) -> None:
        self._count = count
        self._find = find
        self._found: dict[str, Sequence[Endpoint]] = {}
        self._looks = 0

    def look(self, topics: Iterable[str]) -> list[str]:
        """Those of ``topics`` whose endpoints are not what they were at the last look."""
        turn = self._looks % LOOKS_PER_ROUND
        self._looks += 1
        return [
            topic
            for place, topic in enumerate(topics)
            if self._has_changed(topic, place % LOOKS_PER_ROUND == turn)
        ]

    def of(self, topic: str) -> Sequence[Endpoint]:
        """The endpoints of ``topic`` as of the last look."""
        return self._found.get(topic, ())

    def _has_changed(self, topic: str, is_its_turn: bool) -> bool:  # noqa: FBT001  one private caller
        known = self._found.get(topic)
        if known is not None and not is_its_turn and self._count(topic) == len(known):
            return False
        self._found[topic] = found = self._find(topic)
        return found != known
