# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""Streams, messages, commands and ends of a link that carries a robot's topics, and how the link does."""

from __future__ import annotations

from collections.abc import Callable, Collection, Mapping, Sequence
from dataclasses import dataclass, field, fields
from pathlib import Path
from typing import Annotated, Protocol

from smarttestudo.domain.metric import Metered, MetricKind
from smarttestudo.domain.names import full_topic_names
from smarttestudo.domain.parameter import Asked
from smarttestudo.domain.record import Count, JsonEntry, Measured
from smarttestudo.domain.robot import Publisher, Qos
from smarttestudo.domain.units import NS_PER_MS, NS_PER_S


@dataclass(frozen=True, slots=True, kw_only=True)
class StreamCounts:
    """Messages of one topic at the robot's end of a link, since the start.

    ``sent`` went out whole. ``replaced`` gave way to newer ones before their first byte was sent;
    ``overflowed`` were dropped because the queue of the topic was full, or waited for publishers that are
    gone, of which there were too many, once an operator's end had been there; where it ``is_losing``, some of
    these within the last minute. ``queued_bytes`` wait now.

    Of those that went as datagrams, ``repaired`` ones arrived because lost parts of them were sent again.
    Others were lost: of ``lost_replaced`` a newer one was sent or had arrived, ``lost_late`` were too late.
    ``sent_bytes`` were put on the link for the topic, compressed and with headers; ``repair_bytes`` of these
    were parts that were sent again.
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
    repaired: Annotated[
        Count,
        Metered(
            "topic_link_repaired",
            "messages",
            "Messages that arrived because lost parts of them were sent again.",
            MetricKind.COUNTER,
        ),
    ] = 0
    lost_replaced: Annotated[
        Count,
        Metered(
            "topic_link_lost_replaced",
            "messages",
            "Messages that the radio lost, and newer ones went before them.",
            MetricKind.COUNTER,
        ),
    ] = 0
    lost_late: Annotated[
        Count,
        Metered(
            "topic_link_lost_late",
            "messages",
            "Messages that the radio lost, and were too late to be sent again.",
            MetricKind.COUNTER,
        ),
    ] = 0
    sent_bytes: Annotated[
        Count,
        Metered(
            "topic_link_sent", "bytes", "Bytes that were put on the link for the topic.", MetricKind.COUNTER
        ),
    ] = 0
    repair_bytes: Annotated[
        Count,
        Metered(
            "topic_link_repair",
            "bytes",
            "Of the bytes on the link, those of parts that were sent again.",
            MetricKind.COUNTER,
        ),
    ] = 0

    @property
    def lost(self) -> int:
        """Messages that the radio lost, and that did not arrive."""
        return self.lost_replaced + self.lost_late

    def __add__(self, other: StreamCounts) -> StreamCounts:
        return self._with(other, 1)

    def __sub__(self, other: StreamCounts) -> StreamCounts:
        return self._with(other, -1)

    def _with(self, other: StreamCounts, factor: int) -> StreamCounts:
        numbers = {
            one.name: getattr(self, one.name) + factor * getattr(other, one.name)
            for one in fields(self)
            if one.name != "is_losing"
        }
        return StreamCounts(**numbers, is_losing=self.is_losing or other.is_losing)


@dataclass(frozen=True, slots=True, kw_only=True)
class LinkState:
    """State of the link at the robot's end; ``None`` for what was not measured yet.

    ``capacity_kb_per_s`` is what the link carries, ``round_trip_ms`` the least of the last seconds,
    ``outages`` how often nothing arrived at the operator's end for more than a second and four round trips,
    whether its connection was cut or it was started anew. Where it goes ``by_datagrams``, ``lost_percent`` of
    them were lost in the last minute. ``sessions`` counts how often an operator's end
    joined that may lack what was sent before. All operator's ends that are there reckon the topics in
    ``predicted`` where they are told how; ``operators`` are their numbers. Since the start
    ``sent_bytes`` were put on the link, and ``report_bytes`` came back that say what arrived; for
    ``silent_s`` nothing of them is known to have arrived at an operator's end.
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
    by_datagrams: Annotated[
        bool,
        JsonEntry(name="datagrams"),
        Metered("link_datagrams", "", "1 if what is relayed goes as datagrams, else 0."),
    ] = False
    lost_percent: Annotated[
        Measured | None,
        Metered("link_lost", "ratio", "The share of datagrams that were lost in the last minute."),
    ] = None
    sessions: Annotated[int, JsonEntry(is_absent=True)] = 0
    predicted: Annotated[frozenset[str], JsonEntry(is_absent=True)] = frozenset()
    operators: Annotated[frozenset[int], JsonEntry(is_absent=True)] = frozenset()
    sent_bytes: Annotated[
        Count,
        Metered("link_sent", "bytes", "Bytes that were put on the link.", MetricKind.COUNTER),
    ] = 0
    report_bytes: Annotated[
        Count,
        Metered(
            "link_reports", "bytes", "Bytes of the reports that came back over the link.", MetricKind.COUNTER
        ),
    ] = 0
    silent_s: Annotated[float, JsonEntry(is_absent=True)] = 0.0


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
    when it arrived, as far as the clocks of both ends can be compared. A message that ``begins_anew`` does
    not follow directly on the one before, so what was reckoned of it is void. A message that ``is_predicted``
    was made at this end. ``boot`` tells the runs of the robot's end apart.
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
    def robot(self) -> str: ...

    @property
    def is_settled(self) -> bool:
        """Whether it is known of what former connections carried whether it arrived."""

    @property
    def is_watched(self) -> bool:
        """Whether somebody receives statuses."""

    @property
    def state(self) -> LinkState: ...

    @property
    def budget_kb_per_s(self) -> float | None:
        """Bandwidth that relayed topics may share now; ``None`` while nothing is known of the link."""

    def counts(self) -> dict[str, StreamCounts]: ...

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
        """End: nothing more comes."""


MAX_AGE_NS = NS_PER_S // 2
"""Nothing older is delivered."""
MAX_COMMAND_BYTES = 64_000
MAX_COMMAND_TOPICS = 16


@dataclass(slots=True)
class SentCounts:
    """Messages of one topic at the operator's end, since the robot's end is known.

    ``replaced`` ones gave way to newer ones, ``expired`` ones became too old, before they were sent;
    ``too_large`` ones were refused.
    """

    sent: int = 0
    replaced: int = 0
    expired: int = 0
    too_large: int = 0


class IncomingCommands(Protocol):
    """Commands from operators at the robot's end of a link. Calls never wait for the link."""

    @property
    def topics(self) -> Sequence[CommandTopic]:
        """State of each accepted topic."""

    @property
    def has_operator(self) -> bool:
        """Whether an operator's end that sends anything is connected."""

    def sent_names(self) -> Sequence[tuple[str, ...]]:
        """Topics that each operator's end heard lately sends."""

    def follow(
        self, topic: str, type_name: str | None, publisher: Publisher | None, problem: str | None = None
    ) -> None:
        """From now on give ``publisher`` the messages of ``topic``, which are of that type."""


@dataclass(slots=True, eq=False)
class TooOld:
    """Says of which topics all that arrives lately is too old; each once, until something is delivered."""

    _before: dict[str, CommandTopic] = field(default_factory=dict)
    _said: set[str] = field(default_factory=set)

    def new_sentences(self, topics: Sequence[CommandTopic]) -> list[str]:
        """A sentence for each topic of which that is new since the last poll."""
        sentences = []
        for now in topics:
            before = self._before.get(now.topic, now)
            self._before[now.topic] = now
            if now.delivered > before.delivered:
                self._said.discard(now.topic)
            elif now.too_old > before.too_old and now.topic not in self._said and now.age_ms is not None:
                self._said.add(now.topic)
                sentences.append(
                    f"{now.topic} arrives {now.age_ms:.0f} ms old; "
                    f"nothing older than {MAX_AGE_NS // NS_PER_MS} ms is delivered"
                )
        return sentences


def command_topics(names: Sequence[str], option: str) -> tuple[str, ...]:
    """The topics that ``option`` names, each once. Raises ``UsageError``."""
    return full_topic_names(names, option, most=MAX_COMMAND_TOPICS, like="/joy")
