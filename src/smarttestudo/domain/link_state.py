# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""How a link to an operator does, as the robot's end knows it, and what comes of the operator."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Annotated

from smarttestudo.domain.metric import Metered, MetricKind
from smarttestudo.domain.record import Count, JsonEntry, Measured


@dataclass(frozen=True, slots=True, kw_only=True)
class StreamCounts:
    """Messages of one topic at the robot's end of a link, since the start.

    ``sent`` went out whole. ``replaced`` gave way to newer ones before their first byte was sent;
    ``overflowed`` were dropped because the queue of the topic was full, or waited for publishers that are
    gone, of which there were too many, once an operator's end had been there; where it ``is_losing``, some of
    these within the last minute. ``queued_bytes`` wait now.
    """

    sent: Annotated[
        Count,
        Metered(
            "topic_link_sent", "messages", "Messages that went out whole over the link.", MetricKind.COUNTER
        ),
    ] = 0
    replaced: Annotated[
        Count,
        Metered(
            "topic_link_replaced",
            "messages",
            "Messages that gave way to newer ones before the link.",
            MetricKind.COUNTER,
        ),
    ] = 0
    overflowed: Annotated[
        Count,
        Metered(
            "topic_link_overflowed",
            "messages",
            "Messages lost because the topic's queue was full.",
            MetricKind.COUNTER,
        ),
    ] = 0
    queued_bytes: Annotated[
        Count, Metered("topic_link_queued", "bytes", "What waits for the link of the topic.")
    ] = 0
    is_losing: Annotated[bool, JsonEntry(name="losing")] = False

    def __add__(self, other: StreamCounts) -> StreamCounts:
        """The counts of both."""
        return StreamCounts(
            sent=self.sent + other.sent,
            replaced=self.replaced + other.replaced,
            overflowed=self.overflowed + other.overflowed,
            queued_bytes=self.queued_bytes + other.queued_bytes,
            is_losing=self.is_losing or other.is_losing,
        )


@dataclass(frozen=True, slots=True, kw_only=True)
class LinkState:
    """State of the link at the robot's end; ``None`` for what was not measured yet.

    ``capacity_kb_per_s`` is what the link carries, ``round_trip_ms`` the least of the last seconds,
    ``outages`` how often nothing arrived at the operator's end for more than a second and four round trips,
    whether its connection was cut or it was started anew. ``sessions`` counts how often an operator's end
    came that may lack what was sent before. All operator's ends that are there reckon the topics in
    ``predicted`` where they are told how; ``operators`` are their numbers.
    """

    is_connected: Annotated[
        bool,
        JsonEntry(name="connected"),
        Metered("link_connected", "", "1 if an operator is connected over the link, else 0."),
    ] = False
    capacity_kb_per_s: Annotated[
        Measured | None,
        Metered("link_capacity", "bytes_per_second", "What the link carries, where it is the limit."),
    ] = None
    round_trip_ms: Annotated[
        Measured | None,
        Metered("link_round_trip", "seconds", "The least round trip of the last seconds on the link."),
    ] = None
    outages: Annotated[
        int,
        Metered(
            "link",
            "outages",
            "How often nothing arrived at the operator's end for more than a second and four round trips.",
            MetricKind.COUNTER,
        ),
    ] = 0
    sessions: Annotated[int, JsonEntry(is_absent=True)] = 0
    predicted: Annotated[frozenset[str], JsonEntry(is_absent=True)] = frozenset()
    operators: Annotated[frozenset[int], JsonEntry(is_absent=True)] = frozenset()


@dataclass(frozen=True, slots=True, kw_only=True)
class TopicOnLink:
    """How one topic does on a link.

    ``age_ms`` is how old its last message was when it arrived at the operator's end; ``None`` while unknown.
    """

    counts: Annotated[StreamCounts, JsonEntry(is_merged=True)]
    age_ms: Annotated[
        Measured | None,
        Metered("topic_link_age", "seconds", "Age of the last message when it arrived at the operator."),
    ] = None


@dataclass(frozen=True, slots=True, kw_only=True)
class CommandTopic:
    """A topic that a robot accepts, as the robot's end knows it.

    ``type_name`` is what the robot's own nodes subscribe with, ``None`` where none does or ``problem`` says
    why nothing is delivered. Of the messages that were ``received``, some were ``delivered``, some
    ``too_old`` and some ``refused``. ``age_ms`` is how old the last one was when it arrived, at most.
    """

    topic: str
    type_name: Annotated[str | None, JsonEntry(name="type")] = None
    problem: str | None = None
    received: Count = 0
    delivered: int = 0
    too_old: int = 0
    refused: int = 0
    age_ms: Measured | None = None
