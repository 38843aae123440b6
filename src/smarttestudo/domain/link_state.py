# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""How a link to an operator does, as the robot's end knows it, and what comes of the operator."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Annotated

from smarttestudo.domain.record import Count, Entry, Measured


@dataclass(frozen=True, slots=True, kw_only=True)
class StreamCounts:
    """Messages of one topic at the robot's end of a link, since the start.

    ``sent`` went out whole. ``replaced`` gave way to newer ones before their first byte was sent;
    ``overflowed`` were dropped because the queue of the topic was full, once an operator's end had been
    there; where it ``is_losing``, some of these within the last minute. ``queued_bytes`` wait now.
    """

    sent: Count = 0
    replaced: Count = 0
    overflowed: Count = 0
    queued_bytes: Count = 0
    is_losing: Annotated[bool, Entry(name="losing")] = False


@dataclass(frozen=True, slots=True, kw_only=True)
class LinkState:
    """What the robot's end knows of the link; ``None`` for what was not measured yet.

    ``capacity_kb_per_s`` is what the link carries, ``round_trip_ms`` the least of the last seconds,
    ``outages`` how often the operator's end was silent while something was under way to it. ``sessions``
    counts how often an operator's end came that may lack what was sent before. All operator's ends that are
    there reckon the topics in ``predicted`` where they are told how.
    """

    is_connected: Annotated[bool, Entry(name="connected")] = False
    capacity_kb_per_s: Measured | None = None
    round_trip_ms: Measured | None = None
    outages: int = 0
    sessions: Annotated[int, Entry(is_absent=True)] = 0
    predicted: Annotated[frozenset[str], Entry(is_absent=True)] = frozenset()


@dataclass(frozen=True, slots=True, kw_only=True)
class TopicOnLink:
    """How one topic does on a link.

    ``age_ms`` is how old its last message was when it arrived at the operator's end; ``None`` while unknown.
    """

    counts: Annotated[StreamCounts, Entry(is_merged=True)]
    age_ms: Measured | None = None


@dataclass(frozen=True, slots=True, kw_only=True)
class AcceptedTopic:
    """A topic that a robot accepts, as the robot's end knows it.

    ``type_name`` is what the robot's own nodes subscribe with, ``None`` where none does or ``problem`` says
    why nothing is delivered. Of the messages that were ``received``, some were ``delivered``, some
    ``too_old`` and some ``refused``. ``age_ms`` is how old the last one was when it arrived, at most.
    """

    topic: str
    type_name: Annotated[str | None, Entry(name="type")] = None
    problem: str | None = None
    received: Count = 0
    delivered: int = 0
    too_old: int = 0
    refused: int = 0
    age_ms: Measured | None = None
