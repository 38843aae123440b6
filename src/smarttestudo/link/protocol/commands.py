# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""What travels between an operator who sends messages and the robot that accepts them."""

from __future__ import annotations

import json
import math
import re
import struct
from collections.abc import Mapping, Sequence
from dataclasses import dataclass

from smarttestudo.domain.command import MAX_COMMAND_BYTES, MAX_COMMAND_TOPICS
from smarttestudo.domain.errors import LinkError
from smarttestudo.domain.json_text import json_text
from smarttestudo.domain.link_state import AcceptedTopic
from smarttestudo.domain.names import is_topic_name

MAX_SENDERS = 4
"""Operators that send at the same time."""

_VERSION = 1
_MESSAGE, _NAMES = 0, 1
# version, kind, topic, revision, sender, number, stamp_ns
_COMMAND = struct.Struct("<BBBHQQq")
# version, acknowledgements, sent_ns
_REPORT = struct.Struct("<BBq")
# sender, number
_ACKNOWLEDGEMENT = struct.Struct("<QQ")
_MAX_TEXT_BYTES = 32_000
_MAX_PROBLEM = 300
_MAX_COUNT = 2**63
_MAX_REVISION = 2**16
_TYPE_NAME = re.compile(r"[A-Za-z]\w{0,99}/msg/[A-Za-z]\w{0,99}", re.ASCII)
_UNREADABLE = (ValueError, TypeError, LookupError, AttributeError, ArithmeticError, RecursionError)


@dataclass(frozen=True, slots=True, kw_only=True)
class CommandMessage:
    """A message of the accepted topic with number ``topic``, as the robot told it in ``revision``.

    ``sender`` is a random number that tells an operator's end from others, ``number`` grows with each of its
    messages. ``stamp_ns`` is a time of the robot's clock at which the message did not yet exist, or just did.
    """

    sender: int
    number: int
    topic: int
    revision: int
    stamp_ns: int
    payload: bytes

    def to_bytes(self) -> bytes:
        """The message as it travels."""
        head = (_VERSION, _MESSAGE, self.topic, self.revision, self.sender, self.number, self.stamp_ns)
        return _COMMAND.pack(*head) + self.payload


@dataclass(frozen=True, slots=True, kw_only=True)
class SentNames:
    """The topics that an operator's end sends, by the robot's names."""

    sender: int
    topics: tuple[str, ...]

    def to_bytes(self) -> bytes:
        """The names as they travel."""
        return _COMMAND.pack(_VERSION, _NAMES, 0, 0, self.sender, 0, 0) + json_text(self.topics).encode()


def read_command(data: bytes) -> CommandMessage | SentNames:
    """What ``to_bytes`` gave ``data`` for. Raises ``LinkError`` for anything else."""
    if not _COMMAND.size <= len(data) <= _COMMAND.size + MAX_COMMAND_BYTES:
        raise LinkError(f"{len(data)} bytes are no command")
    version, kind, topic, revision, sender, number, stamp_ns = _COMMAND.unpack_from(data)
    body = data[_COMMAND.size :]
    if version != _VERSION or kind not in (_MESSAGE, _NAMES):
        raise LinkError(
            f"a command has version {version}.{kind}",
            remedy="use the same version of SmartTestudo at both ends",
        )
    if kind == _NAMES:
        return SentNames(sender=sender, topics=_topic_names(body))
    return CommandMessage(
        sender=sender, number=number, topic=topic, revision=revision, stamp_ns=stamp_ns, payload=body
    )


def _topic_names(data: bytes) -> tuple[str, ...]:
    try:
        names = tuple(json.loads(data))
        if len(names) > MAX_COMMAND_TOPICS or not all(map(is_topic_name, names)):
            raise LinkError("what is sent has no names of topics")
    except _UNREADABLE as error:
        raise LinkError("the names of what is sent are not readable") from error
    return names


@dataclass(frozen=True, slots=True, kw_only=True)
class AcceptedStream:
    """An accepted topic; ``revision`` changes with its type, so that no bytes are taken for another type."""

    topic: AcceptedTopic
    revision: int


@dataclass(frozen=True, slots=True, kw_only=True)
class CommandReport:
    """What the robot's end has: the newest ``acknowledged`` number by sender, at ``sent_ns`` of its clock.

    ``streams`` are there now and then, in the order that gives them their numbers.
    """

    sent_ns: int
    acknowledged: Mapping[int, int]
    streams: Sequence[AcceptedStream] = ()

    def to_bytes(self) -> bytes:
        """The report as it travels."""
        head = _REPORT.pack(_VERSION, len(self.acknowledged), self.sent_ns)
        acknowledged = b"".join(_ACKNOWLEDGEMENT.pack(*one) for one in self.acknowledged.items())
        if not self.streams:
            return head + acknowledged
        return head + acknowledged + json_text([_record(one) for one in self.streams]).encode()

    @staticmethod
    def from_bytes(data: bytes) -> CommandReport:
        """The report that ``to_bytes`` gave ``data`` for. Raises ``LinkError`` for anything else."""
        if not _REPORT.size <= len(data) <= _MAX_TEXT_BYTES or data[0] != _VERSION:
            raise LinkError(
                f"{len(data)} bytes are no report of this version",
                remedy="use the same version of SmartTestudo at both ends",
            )
        _, count, sent_ns = _REPORT.unpack_from(data)
        text_at = _REPORT.size + count * _ACKNOWLEDGEMENT.size
        if count > MAX_SENDERS or text_at > len(data):
            raise LinkError("a report ends within its acknowledgements")
        acknowledged = dict(_ACKNOWLEDGEMENT.iter_unpack(data[_REPORT.size : text_at]))
        try:
            records = json.loads(data[text_at:]) if text_at < len(data) else []
            if len(records) > MAX_COMMAND_TOPICS:
                raise LinkError("a report tells of too many topics")
            streams = tuple(map(_stream, records))
        except _UNREADABLE as error:
            raise LinkError("the topics of a report are not readable") from error
        return CommandReport(sent_ns=sent_ns, acknowledged=acknowledged, streams=streams)


def _record(stream: AcceptedStream) -> list[object]:
    topic = stream.topic
    age_ms = None if topic.age_ms is None else round(topic.age_ms, 1)
    problem = None if topic.problem is None else topic.problem[:_MAX_PROBLEM]
    counts = (topic.received, topic.delivered, topic.too_old, topic.refused)
    return [stream.revision, topic.topic, topic.type_name, problem, age_ms, *counts]


def _stream(record: Sequence[object]) -> AcceptedStream:
    revision, topic, type_name, problem, age_ms, *counts = record
    numbers = [int(str(count)) for count in (revision, *counts)]
    if not isinstance(topic, str) or not is_topic_name(topic):
        raise LinkError("a report tells of something that is no topic")
    if type_name is not None and not _TYPE_NAME.fullmatch(str(type_name)):
        raise LinkError(f"{str(type_name)[:80]!r} is no type", place=topic)
    if numbers[0] >= _MAX_REVISION or not all(0 <= number < _MAX_COUNT for number in numbers):
        raise LinkError("a report counts wrongly", place=topic)
    received, delivered, too_old, refused = numbers[1:]
    told = AcceptedTopic(
        topic=topic,
        type_name=None if type_name is None else str(type_name),
        problem=None if problem is None else str(problem)[:_MAX_PROBLEM],
        received=received,
        delivered=delivered,
        too_old=too_old,
        refused=refused,
        age_ms=None if age_ms is None else _finite(float(str(age_ms))),
    )
    return AcceptedStream(topic=told, revision=numbers[0])


def _finite(number: float) -> float:
    if not math.isfinite(number):
        raise ValueError(f"{number} ms")
    return number
