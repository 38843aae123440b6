# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""All that follows from the topics of a live run while none of them changes."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence, Set
from functools import cached_property

from smarttestudo.domain.robot import Endpoint, Publisher, Subscription
from smarttestudo.robot.topic import LiveSource, OpenTopic
from smarttestudo.robot.topic_link import TopicLink, topic_link

EndpointsOf = Callable[[str], Sequence[Endpoint]]
"""Endpoints of a topic, as of the last poll of the graph."""
Ends = Mapping[str, tuple[Subscription, Publisher | None]]
"""Where messages of each topic come in and go out, if they do."""


class SettledTopics:
    """All that follows from ``topics`` and their endpoints, each made when it is first asked for, and kept.

    With hundreds of topics it costs more than polling the graph, so there is a new one only after a
    change: of what is open, of a source, or of an endpoint.
    """

    def __init__(
        self,
        topics: Mapping[str, OpenTopic],
        publishers_of: EndpointsOf,
        subscribers_of: EndpointsOf,
        *,
        recorded: Set[str],
        watched: Set[str],
    ) -> None:
        self._topics = topics
        self._publishers_of = publishers_of
        self._subscribers_of = subscribers_of
        self._recorded = recorded
        self._watched = watched

    @cached_property
    def outputs(self) -> Mapping[str, OpenTopic]:
        """The relayed topics by their output topic."""
        return {live.output: live for live in self._topics.values() if live.output is not None}

    @cached_property
    def unseen(self) -> Sequence[str]:
        """Topics whose source is not there, or not told of."""
        return [topic for topic, live in self._topics.items() if live.source is None or not live.is_told]

    @cached_property
    def latched(self) -> Sequence[OpenTopic]:
        """Topics that hold what publishers latched."""
        return [live for live in self._topics.values() if live.is_latched]

    @cached_property
    def listeners(self) -> Mapping[str, frozenset[bytes]]:
        """The GIDs of those that subscribe to the output of each relayed topic."""
        return {
            live.topic: frozenset(one.gid for one in self._subscribers_of(output))
            for output, live in self.outputs.items()
        }

    @cached_property
    def links(self) -> Mapping[str, TopicLink]:
        """Connections of each relayed topic."""
        return {
            live.topic: topic_link(live, output, self._subscribers_of(output))
            for output, live in self.outputs.items()
        }

    @cached_property
    def heard(self) -> Sequence[tuple[str, LiveSource]]:
        """The topics whose messages are received, with their sources."""
        return [
            (topic, live.source)
            for topic, live in self._topics.items()
            if live.subscription is not None and live.source is not None
        ]

    @cached_property
    def subscriptions(self) -> Mapping[str, Subscription]:
        """All subscriptions that are open."""
        return {
            topic: live.subscription for topic, live in self._topics.items() if live.subscription is not None
        }

    @cached_property
    def pausable(self) -> Mapping[str, Subscription]:
        """The subscriptions to topics that are not recorded and have one publisher, or none any more."""
        return {
            topic: subscription
            for topic, subscription in self.subscriptions.items()
            if topic not in self._recorded and len(self._publishers_of(topic)) <= 1
        }

    @cached_property
    def ends(self) -> Ends:
        """Where messages come in and go out, of topics that have one place for each, or are recorded only."""
        return self._ends(is_published=True)

    @cached_property
    def beginnings(self) -> Ends:
        """Where messages come in, of topics of which all that comes is the same to whoever relays it."""
        return self._ends(is_published=False)

    def _ends(self, *, is_published: bool) -> Ends:
        ends = {topic: live.ends(is_published=is_published) for topic, live in self._topics.items()}
        read_only = {topic for topic in self._watched if self._topics[topic].output is None}
        return {topic: one for topic, one in ends.items() if one is not None and topic not in read_only}
