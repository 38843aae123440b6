# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""Streams, messages and ends of a link that carries a robot's topics."""

from __future__ import annotations

from collections.abc import Callable, Collection, Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Protocol

from smarttestudo.domain.link_state import LinkState, StreamCounts
from smarttestudo.domain.questions import Asked
from smarttestudo.domain.robot import Publisher, Qos


@dataclass(frozen=True, slots=True, kw_only=True)
class Prediction:
    """The robot's end keeps what a receiver reckons of a topic within these bounds, by property.

    At least ``heartbeat_hz`` messages a second pass while the source sends any.
    """

    within: Mapping[str, float]
    heartbeat_hz: float


@dataclass(frozen=True, slots=True, kw_only=True)
class StreamInfo:
    """One stream of a link: the messages of one publisher of a topic on the robot.

    ``publisher`` numbers the publishers of the topic that are kept apart. ``definition`` is the message
    definition as rosbag2 stores it (concatenated .msg texts), empty where the robot does not know it.
    Without a ``prediction``, messages are to be shown as they are.
    """

    topic: str
    type_name: str
    qos: Qos
    publisher: int = 0
    definition: str = ""
    prediction: Prediction | None = None


@dataclass(frozen=True, slots=True, kw_only=True)
class LinkNeeds:
    """How a topic is served where the link cannot carry all: ``priority`` is the profile's.

    At least ``floor_hz`` messages a second go before all others. Where ``is_full``, every message is to
    arrive: they queue, and none is replaced by a newer one.
    """

    priority: float = 1.0
    floor_hz: float = 0.0
    is_full: bool = False


@dataclass(frozen=True, slots=True, kw_only=True)
class MessageOrigin:
    """A message by the name of its source and the robot's clock when the rules let it pass."""

    topic: str
    stamp_ns: int


@dataclass(frozen=True, slots=True, kw_only=True)
class MissedMessage:
    """A message that an operator's end would have received, had there been no outage."""

    origin: MessageOrigin
    payload: bytes


@dataclass(frozen=True, slots=True, kw_only=True)
class ReceivedMessage:
    """A whole message at the operator's end.

    ``offered_ns`` is the robot's clock when its loop relayed the message, ``age_ns`` how long ago that was
    when it arrived, as far as the clocks of both ends can be compared. One that ``begins_anew`` does not
    follow directly on the one before, so what was reckoned of it is void. One that ``is_predicted`` was made
    at this end. ``boot`` tells the runs of the robot's end apart.
    """

    robot: str
    stream: StreamInfo
    payload: bytes
    offered_ns: int
    age_ns: int | None
    begins_anew: bool = True
    is_predicted: bool = False
    boot: str = ""


class OutgoingLink(Protocol):
    """The robot's end of a link. Calls never wait for the link."""

    def advertise(self, stream: StreamInfo) -> Publisher:
        """Publisher of the messages of a stream."""

    def follow(self, needs: Mapping[str, LinkNeeds]) -> None:
        """Serve topics so from now on."""

    def predict(self, predictions: Mapping[str, Prediction], anew: Collection[str]) -> None:
        """Have receivers reckon these topics; of some, ``anew`` from the next message on."""

    def tell(self, status: Mapping[str, object]) -> None:
        """Have everyone who watches receive this status, the object that it is in JSON."""

    def keep_missed(self, origin: Callable[[], MessageOrigin | None]) -> None:
        """Keep from now on what operators' ends miss. ``origin`` is asked of each message as it is sent.

        Those without one are not kept.
        """

    def take_missed(self, *, is_last: bool = False) -> Sequence[MissedMessage]:
        """Messages that operators' ends have missed since the last call.

        With ``is_last``, what waits for them in vain is missed, too.
        """

    def offer_incidents(self, folder: Path) -> None:
        """Let operators list and fetch the incidents in ``folder`` from now on."""

    def take_question(self) -> Asked | None:
        """The next question that waits for an answer."""

    @property
    def robot(self) -> str:
        """The robot's name."""

    @property
    def is_settled(self) -> bool:
        """Whether it is known of what former connections carried whether it arrived."""

    @property
    def is_watched(self) -> bool:
        """Whether somebody receives statuses."""

    @property
    def state(self) -> LinkState:
        """State of the link now."""

    @property
    def budget_kb_per_s(self) -> float | None:
        """Bandwidth that relayed topics may share now; ``None`` while nothing is known of the link."""

    def counts(self) -> dict[str, StreamCounts]:
        """Messages by topic."""

    def age_ms(self, topic: str) -> float | None:
        """How old the last message of ``topic`` was when it arrived at the operator's end."""


class Sink(Protocol):
    """Where the operator's end puts what arrives. What a call raises costs its topic here, and is said."""

    def open(self, robot: str, stream: StreamInfo) -> str | None:
        """A robot has this stream; its messages may follow. Said again where a stream changed.

        Returns why they cannot be put here, where that is so.
        """

    def write(self, message: ReceivedMessage) -> str | None:
        """A message arrived, or ``is_predicted``. Returns why it cannot be put here, where that is so."""

    def forget(self, robot: str, stream: StreamInfo) -> None:
        """A robot has this stream no more: what it latched is not given to anybody."""

    def close(self) -> None:
        """Nothing more comes."""
