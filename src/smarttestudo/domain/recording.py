# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""A recording of a robot's topics, whatever file holds it."""

from __future__ import annotations

from collections.abc import Collection, Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass
from enum import Enum
from typing import Protocol

from smarttestudo.domain.names import is_own_topic
from smarttestudo.domain.units import utc_time


class Storage(Enum):
    """The file formats of rosbag2; the value is rosbag2's own name."""

    SQLITE3 = "sqlite3"
    MCAP = "mcap"


@dataclass(frozen=True, slots=True, kw_only=True)
class ForeignSchema:
    """A type's definition in another language than ROS 2's, such as ``jsonschema``, as a file holds it."""

    encoding: str
    data: bytes


@dataclass(frozen=True, slots=True, kw_only=True)
class Channel:
    """One topic of a recording with one type and one definition of it.

    ``definition`` is the type's definition with those of its parts, as rosbag2 stores it, ``None`` where the
    recording has none, but perhaps a ``foreign_schema``; ``digest`` its ``RIHS01_…`` hash or empty; ``qos``
    the offered profiles, opaque to everything but the adapter that read them. ``transient_local`` says
    whether any of them is.
    """

    topic: str
    type_name: str
    definition: str | None = None
    digest: str = ""
    qos: tuple[object, ...] = ()
    serialization_format: str = "cdr"
    transient_local: bool = False
    foreign_schema: ForeignSchema | None = None


TWO_TYPES = "recorded with two types; left out of the second"
"""Why messages were left out: of a topic that has two types, that with the most messages counts."""


def first_of_topics(channels: Iterable[Channel]) -> dict[str, Channel]:
    """The channel of each topic; of one with several, the first, whose type counts.

    Others of that type count, too, each by its own definition.
    """
    first: dict[str, Channel] = {}
    for channel in channels:
        first.setdefault(channel.topic, channel)
    return first


def robots_own(channels: Iterable[Channel]) -> list[Channel]:
    """``channels`` without those of what a SmartTestudo node said of itself."""
    return [channel for channel in channels if not is_own_topic(channel.topic, channel.type_name)]


def types_of_topics(channels: Iterable[Channel]) -> dict[str, str]:
    """The name of the type of each topic that counts."""
    return {topic: channel.type_name for topic, channel in first_of_topics(channels).items()}


RecordedMessage = tuple[Channel, int, bytes]
"""Channel, receive stamp in ns, serialized message."""

RecordedSize = tuple[Channel, int, int]
"""Channel, receive stamp in ns, bytes of the serialized message."""

RecordedHead = tuple[Channel, int, tuple[int, bytes]]
"""Channel, receive stamp in ns, bytes of the serialized message and the first of them."""


def readable_until(readable_share: float | None, end_ns: int) -> str:
    """``69 % readable, ends at …`` of what is damaged; without the share where that is not known."""
    end = f"ends at {utc_time(end_ns)}"
    return end if readable_share is None else f"{min(round(100 * readable_share), 99)} % readable, {end}"


class RecordingReader(Protocol):
    """Reads a recording from its first message to its last."""

    @property
    def storage(self) -> Storage: ...

    @property
    def channels(self) -> Sequence[Channel]:
        """Every topic with its type and its definition; those of a topic that count come first."""

    @property
    def custom_data(self) -> Mapping[str, str]:
        """Notes of the recording's author beside the messages."""

    @property
    def declared_bytes(self) -> Mapping[str, int]:
        """Bytes that each message of a topic stands for, where the recording declares them."""

    @property
    def start_ns(self) -> int:
        """Stamp of the first message, 0 where there is none."""

    @property
    def end_ns(self) -> int:
        """Stamp of the last message, 0 where there is none."""

    @property
    def message_count(self) -> int | None:
        """Messages in the recording, ``None`` while that is unknown."""

    @property
    def promised_messages(self) -> int:
        """Messages that it held once, as far as its metadata and files tell."""

    @property
    def readable_share(self) -> float | None:
        """About how much of what was once recorded can be read, 0 … 1; known once all of it was read.

        ``None`` if it is unknown how much is missing.
        """

    def messages(self, topics: Collection[str] | None = None) -> Iterator[RecordedMessage]:
        """All messages, or those of ``topics``, in time order; memory does not grow with their number."""

    def sizes(self) -> Iterator[RecordedSize]:
        """Results of ``messages``, with each payload's size in its place and as far as possible unread.

        Damage within a payload is not seen then: the message counts with the size that it was written with.
        A message that is compressed on its own and cannot be decompressed is none of them.
        """

    def heads(self, head_bytes: int) -> Iterator[RecordedHead]:
        """Results of ``sizes``, with the first ``head_bytes`` of each payload."""

    def notices(self) -> Sequence[str]:
        """Losses and oddities, one line each; complete once all messages, sizes or heads were read."""


class RecordingWriter(Protocol):
    """Writes a recording; it appears under its name only when it is whole."""

    def add(self, channel: Channel) -> None:
        """Announce ``channel``, so that it is listed even if no message of it follows."""

    def write(self, channel: Channel, stamp_ns: int, payload: bytes) -> None:
        """Append one message, adding its channel on first use.

        Raises:
            RecordingError: the file cannot take it, for instance because the disk is full.
        """
