# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""What the ends say about the link itself: acknowledgements one way, the streams the other way."""

from __future__ import annotations

import json
import math
import re
import struct
from collections.abc import Mapping
from dataclasses import dataclass, field
from typing import Any

from smarttestudo.domain.errors import LinkError
from smarttestudo.domain.json_text import json_text
from smarttestudo.domain.link import Prediction, StreamInfo
from smarttestudo.domain.names import is_topic_name
from smarttestudo.domain.robot import Qos
from smarttestudo.link.protocol.chunks import MAX_STREAMS

MAX_REPORT_BYTES = 256_000
MAX_PREDICTED = 64
"""How many topics an operator's end reckons."""
_MAX_DEPTH = 1_000
_MAX_DEFINITION_BYTES = 256_000
_MAX_DURATION_MS = 1e9
_UNREADABLE = (ValueError, TypeError, LookupError, AttributeError, ArithmeticError, RecursionError)
_TYPE_NAME = re.compile(r"[A-Za-z]\w{0,99}/msg/[A-Za-z]\w{0,99}", re.ASCII)
_VERSION = 1
_PREDICTS = "predicts"
# version, receiver, session, received bytes
_HEAD = struct.Struct("<BQIQ")


@dataclass(frozen=True, slots=True, kw_only=True)
class Report:
    """What the operator's end has: ``received_bytes`` of chunks of ``session``, 0 where it knows of none.

    ``receiver`` is a random number that tells it from others. ``ages_ms`` says how old the last message of
    each stream was when it arrived; it is there about once a second, and so is what it ``predicts``: the
    topics that it reckons where the robot's end does so too.
    """

    receiver: int
    session: int
    received_bytes: int
    ages_ms: Mapping[int, float] = field(default_factory=dict)
    predicts: frozenset[str] = frozenset()

    def to_bytes(self) -> bytes:
        """The report as it travels."""
        head = _HEAD.pack(_VERSION, self.receiver, self.session, self.received_bytes)
        said: dict[str, object] = {str(stream): round(age, 1) for stream, age in self.ages_ms.items()}
        if self.predicts:
            said[_PREDICTS] = sorted(self.predicts)
        return head + json_text(said).encode() if said else head

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
            said = json.loads(data[_HEAD.size :]) if len(data) > _HEAD.size else {}
            predicts = _topics(said.pop(_PREDICTS, []))
            ages_ms = {int(stream): _duration_ms(age) for stream, age in said.items()}
        except _UNREADABLE as error:
            raise LinkError("the ages of a report are not readable") from error
        return Report(
            receiver=receiver,
            session=session,
            received_bytes=received_bytes,
            ages_ms=ages_ms,
            predicts=predicts,
        )


@dataclass(frozen=True, slots=True, kw_only=True)
class Announcement:
    """A stream of the robot's end; without ``info``, it is closed.

    Its prediction is for the receivers in ``predicted_for``: others may lack what it is made of.
    """

    stream: int
    info: StreamInfo | None
    predicted_for: frozenset[int] = frozenset()


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
        if info.prediction is not None:
            record["predicted_within"] = dict(info.prediction.within)
            record["heartbeat_hz"] = info.prediction.heartbeat_hz
            record["predicted_for"] = sorted(said.predicted_for)
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
        return Announcement(
            stream=stream,
            info=_info(record) if "topic" in record else None,
            predicted_for=frozenset(map(int, record.get("predicted_for", ()))),
        )
    except _UNREADABLE as error:
        raise LinkError("a message of the control stream is not readable") from error


def _duration_ms(value: object) -> float:
    number = float(str(value))
    if not 0 <= number <= _MAX_DURATION_MS:
        raise ValueError(f"{number} ms")
    return number


def _info(record: Mapping[str, Any]) -> StreamInfo:
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
        prediction=_prediction(record),
    )


def _prediction(record: Mapping[str, Any]) -> Prediction | None:
    within = record.get("predicted_within")
    if within is None:
        return None
    bounds = {str(name): float(bound) for name, bound in within.items()}
    heartbeat_hz = float(record["heartbeat_hz"])
    if not (all(0 <= bound < math.inf for bound in bounds.values()) and 0 < heartbeat_hz < math.inf):
        raise LinkError("a prediction without usable bounds")
    return Prediction(within=bounds, heartbeat_hz=heartbeat_hz)


def _topics(names: list[object]) -> frozenset[str]:
    if len(names) > MAX_PREDICTED or not all(isinstance(name, str) and is_topic_name(name) for name in names):
        raise ValueError("no names of topics")
    return frozenset(map(str, names))
