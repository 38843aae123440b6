# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""The loop's observations of the robot."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Annotated

from smarttestudo.domain.record import JsonEntry


@dataclass(frozen=True, slots=True, kw_only=True)
class Undecodable:
    """Stands for a message whose bytes could not be read as its type."""


@dataclass(slots=True)
class Arrival:
    """A message of ``topic`` arrived at the step's time.

    ``message`` is the decoded message (any object with the fields of its ROS type as attributes) where a
    check reads a field of the topic, ``Undecodable`` where decoding failed, else ``None``. Treat it as
    immutable; frozen or keyword-only it would take two to four times as long to make.
    """

    topic: str
    size_bytes: int
    message: object | None = None


@dataclass(frozen=True, slots=True, kw_only=True)
class SourceChanged:
    """The publishers of ``topic`` are now ``publishers`` many, and ``transient_local`` or not.

    ``type_name`` is the topic's ROS type, for instance ``nav_msgs/msg/Odometry``, or empty while unknown.
    It ``is_standard`` unless a recording defines other fields of that type than ROS 2: what is read of
    messages without decoding them is unknown then.
    """

    topic: str
    publishers: int
    transient_local: bool
    type_name: Annotated[str, JsonEntry(name="type")] = ""
    is_standard: Annotated[bool, JsonEntry(name="standard", omits_default=True)] = True


@dataclass(frozen=True, slots=True, kw_only=True)
class ListenersChanged:
    """Whether the output topic of ``topic`` has a subscriber; until this comes, it counts as if it had.

    It comes again for each further subscriber, which has got nothing yet.
    """

    topic: str
    are_there: bool


@dataclass(frozen=True, slots=True, kw_only=True)
class LinkBudget:
    """The relayed topics together may now take ``link_kb_per_s``.

    ``is_measured``: so much the link carries; else somebody set it. The lesser of both holds.
    """

    link_kb_per_s: Annotated[float, JsonEntry(name="budget_kb_per_s")]
    is_measured: Annotated[bool, JsonEntry(name="measured", omits_default=True)] = False


@dataclass(frozen=True, slots=True, kw_only=True)
class ReceiversReckon:
    """Of these topics all receivers show dead reckoning from now on, of the others the last value."""

    topics: frozenset[str]


@dataclass(frozen=True, slots=True, kw_only=True)
class ClockJumped:
    """The clock jumped ahead by ``ahead_ns``, as where the network told it the time: so much did not pass."""

    ahead_ns: int


@dataclass(frozen=True, slots=True, kw_only=True)
class VitalsMeasured:
    """Values by property of the machine or the link, whichever ``source`` names; ``None`` is unknown."""

    source: str
    values: Mapping[str, float | None]


Change = SourceChanged | ListenersChanged | LinkBudget | ReceiversReckon | ClockJumped | VitalsMeasured
Observation = Arrival | SourceChanged | ListenersChanged | LinkBudget | VitalsMeasured
