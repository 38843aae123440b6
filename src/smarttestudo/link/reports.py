# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""What the ends say about the link itself: acknowledgements one way, the streams the other way."""

from __future__ import annotations

import json
import re
import struct
from collections.abc import Mapping
from dataclasses import dataclass, field

from smarttestudo.domain.errors import LinkError
from smarttestudo.domain.json_text import json_text
from smarttestudo.domain.link import StreamInfo
from smarttestudo.domain.names import is_topic_name
from smarttestudo.domain.robot import Qos
from smarttestudo.link.chunks import MAX_STREAMS

MAX_REPORT_BYTES = 256_000
_MAX_DEPTH = 1_000
_MAX_DEFINITION_BYTES = 256_000
_MAX_DURATION_MS = 1e9
_UNREADABLE = (ValueError, TypeError, LookupError, AttributeError, ArithmeticError, RecursionError)
_TYPE_NAME = re.compile(r"[A-Za-z]\w{0,99}/msg/[A-Za-z]\w{0,99}", re.ASCII)
_VERSION = 1
# version, receiver, session, received bytes
_HEAD = struct.Struct("<BQIQ")


@dataclass(frozen=True, slots=True, kw_only=True)
class Report:
    """What the operator's end has: ``received_bytes`` of chunks of ``session``, 0 where it knows of none.

    ``receiver`` is a random number that tells it from others. ``ages_ms`` says how old the last message of
    each stream was when it arrived; it is there about once a second.
    """

    receiver: int
    session: int
    received_bytes: int
    ages_ms: Mapping[int, float] = field(default_factory=dict)

    def to_bytes(self) -> bytes:
        """The report as it travels."""
        head = _HEAD.pack(_VERSION, self.receiver, self.session, self.received_bytes)
        if not self.ages_ms:
            return head
        return head + json_text({str(stream): round(age, 1) for stream, age in self.ages_ms.items()}).encode()

    @staticmethod
    def from_bytes(data: bytes) -> Report:
        """The report that ``to_bytes`` gave ``data`` for. Raises ``LinkError`` for anything else."""
        if not _HEAD.size <= len(data) <= MAX_REPORT_BYTES or data[0] != _VERSION:
            raise LinkError(
                f"{len(data)} bytes are no report of this version",
                remedy="use the same version of SmartTestudo at both ends",
            )
        _, receiver, session, received_bytes = _HEAD.unpack_from(data)
        try:
            ages = json.loads(data[_HEAD.size :]) if len(data) > _HEAD.size else {}
            ages_ms = {int(stream): _duration_ms(age) for stream, age in ages.items()}
        except _UNREADABLE as error:
            raise LinkError("the ages of a report are not readable") from error
        return Report(receiver=receiver, session=session, received_bytes=received_bytes, ages_ms=ages_ms)


@dataclass(frozen=True, slots=True, kw_only=True)
class Announcement:
    """A stream of the robot's end; without ``info``, it is closed."""

    stream: int
    info: StreamInfo | None


@dataclass(frozen=True, slots=True, kw_only=True)
class RoundTrip:
    """The least round trip that the robot's end has measured."""

    round_trip_ms: float


def control_message(said: Announcement | RoundTrip) -> bytes:
    """A message of the control stream."""
    if isinstance(said, RoundTrip):
        return json_text({"round_trip_ms": round(said.round_trip_ms, 2)}).encode()
    record: dict[str, object] = {"stream": said.stream}
    if said.info is not None:
        info = said.info
        record |= {
            "topic": info.topic,
            "type": info.type_name,
            "reliable": info.qos.reliable,
            "transient_local": info.qos.transient_local,
            "depth": info.qos.depth,
            "publisher": info.publisher,
            "definition": info.definition,
        }
    return json_text(record).encode()


def read_control_message(data: bytes) -> Announcement | RoundTrip:
    """What ``control_message`` made ``data`` of. Raises ``LinkError`` for anything else."""
    try:
        record = json.loads(data)
        if "round_trip_ms" in record:
            return RoundTrip(round_trip_ms=_duration_ms(record["round_trip_ms"]))
        stream = int(record["stream"])
        if not 0 < stream < MAX_STREAMS:
            raise LinkError(f"there is no stream {stream}")
        return Announcement(stream=stream, info=_info(record) if "topic" in record else None)
    except _UNREADABLE as error:
        raise LinkError("a message of the control stream is not readable") from error


def _duration_ms(value: object) -> float:
    number = float(str(value))
    if not 0 <= number <= _MAX_DURATION_MS:
        raise ValueError(f"{number} ms")
    return number


def _info(record: Mapping[str, object]) -> StreamInfo:
    topic, type_name, depth = str(record["topic"]), str(record["type"]), int(str(record["depth"]))
    if not is_topic_name(topic) or not _TYPE_NAME.fullmatch(type_name) or not 0 < depth <= _MAX_DEPTH:
        raise LinkError(f"{topic[:80]!r} is no topic")
    definition = str(record["definition"])
    if len(definition) > _MAX_DEFINITION_BYTES:
        raise LinkError(f"the definition of {type_name} is too long", place=topic)
    return StreamInfo(
        topic=topic,
        type_name=type_name,
        qos=Qos(
            reliable=record["reliable"] is True,
            transient_local=record["transient_local"] is True,
            depth=depth,
        ),
        publisher=int(str(record["publisher"])),
        definition=definition,
    )
