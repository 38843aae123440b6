# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""The endpoints of many topics, followed by few questions to the graph."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Sequence

from smarttestudo.domain.robot import Endpoint, GraphChange

POLLS_PER_ROUND = 5
QUIET_POLLS_PER_ROUND = 20
"""The same where no change was told: the middleware compares a topic with all that are there."""


class EndpointCache:
    """A cache of the endpoints of topics, of which ``count`` gives the number, and ``find`` all.

    ``find`` costs several times as much. Where changes of the graph are told, it is called for all topics
    after one. Where they are not, each poll counts, and finds anew where the number changed and for a fifth
    of the others in turn, so that one that was replaced by another is noticed too. Where none was told, a
    look does that for a twentieth of the topics: what was not told all the same is found then.
    """

    def __init__(self, count: Callable[[str], int], find: Callable[[str], Sequence[Endpoint]]) -> None:
        self._count = count
        self._find = find
        self._found: dict[str, Sequence[Endpoint]] = {}
        self._polls = 0

    def poll(self, topics: Iterable[str], graph: GraphChange) -> list[str]:
        """Topics among ``topics`` whose endpoints are not what they were at the last poll."""
        counted = QUIET_POLLS_PER_ROUND if graph is GraphChange.NONE else 1
        found = 1 if graph is GraphChange.TOLD else counted * POLLS_PER_ROUND
        polls = self._polls
        self._polls += 1
        return [
            topic
            for place, topic in enumerate(topics)
            if (place - polls) % counted == 0 or topic not in self._found
            if self._is_new(topic, is_to_be_found=(place - polls) % found == 0)
        ]

    def of(self, topic: str) -> Sequence[Endpoint]:
        """The endpoints of ``topic`` as of the last poll."""
        return self._found.get(topic, ())

    def _is_new(self, topic: str, *, is_to_be_found: bool) -> bool:
        known = self._found.get(topic)
        if known is not None and not is_to_be_found and self._count(topic) == len(known):
            return False
        self._found[topic] = found = self._find(topic)
        return found != known
