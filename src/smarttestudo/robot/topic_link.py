# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""Connections of a relayed topic on the graph, and which subscribers its output cannot serve."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace

from smarttestudo.domain.robot import Endpoint, Qos
from smarttestudo.robot.topic import OpenTopic


def not_offered(offered: Qos, subscriber: Endpoint) -> tuple[str, ...]:
    """Policies that ``subscriber`` requests beyond ``offered``; if there are any, it receives nothing."""
    unmet = {
        "reliable delivery": subscriber.reliable and not offered.reliable,
        "transient local durability": subscriber.transient_local and not offered.transient_local,
    }
    return (*(policy for policy, is_unmet in unmet.items() if is_unmet), *subscriber.asks)


_LESS = {"reliable delivery": "best effort", "transient local durability": "volatile durability"}


def instead_of(policies: Sequence[str]) -> str:
    """Policies for a subscriber to request in the place of those that are ``not_offered``."""
    return " and ".join(_LESS.get(policy, f"no {policy.removeprefix('a ')}") for policy in policies)


@dataclass(frozen=True, slots=True, kw_only=True)
class TopicLink:
    """Connections of a relayed topic on the graph.

    Unless it ``is_heard``, the source is not subscribed to; it was ``subscriptions`` times.
    Of the ``subscribers`` of the output, its QoS cannot serve ``unserved``, which are of the nodes
    ``incompatible``.
    """

    output: str
    type_name: str | None = None
    publishers: int = 0
    is_heard: bool = True
    subscriptions: int = 0
    transient_local: bool = False
    has_header: bool = False
    subscribers: int = 0
    unserved: int = 0
    incompatible: tuple[str, ...] = ()
    problem: str | None = None

    @property
    def is_received(self) -> bool:
        """Whether somebody receives what is relayed."""
        return self.subscribers > self.unserved


def topic_link(topic: OpenTopic, output: str, subscribers: Sequence[Endpoint]) -> TopicLink:
    """The links of ``topic``, which is relayed to ``output``, where the ``subscribers`` are."""
    link = TopicLink(
        output=output,
        is_heard=topic.subscription is not None,
        subscriptions=topic.subscriptions,
        subscribers=len(subscribers),
        problem=topic.problem,
    )
    source = topic.source
    if source is None:
        return link
    unserved = [one for one in subscribers if not_offered(source.qos, one)]
    return replace(
        link,
        type_name=source.type_name,
        publishers=source.publishers,
        transient_local=source.qos.transient_local,
        has_header=topic.has_header,
        unserved=len(unserved),
        incompatible=tuple(sorted({one.node for one in unserved})),
    )
