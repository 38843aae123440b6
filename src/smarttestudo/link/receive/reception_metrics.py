# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""The metrics of the operator's end for a monitoring system."""

from __future__ import annotations

import re
from collections.abc import Iterator, Mapping
from dataclasses import fields
from itertools import islice
from typing import TYPE_CHECKING

from smarttestudo.domain.link import ReceivedMessage, StreamInfo
from smarttestudo.domain.metric import Metric, MetricKind, MetricName, Sample
from smarttestudo.domain.names import is_topic_name
from smarttestudo.domain.status import RuntimeStatus, status_from_text
from smarttestudo.domain.units import BYTES_PER_KB, grouped
from smarttestudo.link.openmetrics.status import status_metrics
from smarttestudo.link.protocol.keys import MAX_ROBOTS, Boot
from smarttestudo.link.protocol.receiver import ReceiverCounts
from smarttestudo.link.protocol.status_stream import MAX_STATUS_BYTES
from smarttestudo.link.receive.reception import ReceivedTopic, Reception
from smarttestudo.pacing.cdr import string_text

if TYPE_CHECKING:
    from smarttestudo.link.zenoh.operator_end import OperatorEnd


_SHA256 = re.compile(r"(?:[0-9a-f]{64})?", re.ASCII)


class StatusSink:
    """A ``Sink`` that keeps the newest message of ``topic`` of each robot, and reads it when it is asked."""

    def __init__(self, topic: str) -> None:
        self.unreadable = 0
        """Messages that were no status of this version, or one of names that no robot has."""
        self._topic = topic
        self._newest: dict[str, bytes] = {}
        self._statuses: dict[str, RuntimeStatus] = {}

    def open(self, robot: str, stream: StreamInfo) -> None:
        """Nothing to do: any stream is counted."""

    def write(self, message: ReceivedMessage) -> None:
        if message.stream.topic == self._topic:
            self._newest[message.robot] = message.payload

    def forget(self, robot: str, stream: StreamInfo) -> None:
        """The last status of a run stays until the robot's next run is there."""
        if stream.topic == self._topic:
            self._newest.pop(robot, None)
            self._statuses.pop(robot, None)

    def close(self) -> None:
        """Nothing to do."""

    def statuses(self) -> Mapping[str, RuntimeStatus]:
        newest, self._newest = self._newest, {}
        for robot, payload in newest.items():
            status = _status(payload)
            if status is None:
                self.unreadable += 1
            else:
                self._statuses[robot] = status
        return self._statuses

    def source_hz(self, robot: str, topic: str) -> float | None:
        """The rate of the source of what ``robot`` sends as ``topic``; ``None`` while it is not known."""
        status = self.statuses().get(robot)
        if status is None:
            return None
        return next(
            (
                topic_status.source_hz
                for topic_status in status.topics.values()
                if topic_status.output == topic
            ),
            None,
        )


def _status(payload: bytes) -> RuntimeStatus | None:
    text = string_text(payload) if len(payload) <= MAX_STATUS_BYTES else None
    try:
        status = status_from_text(text or "")
        # Integers of JSON may be larger than a metric can be.
        status_metrics({"": status})
    except (ValueError, OverflowError):
        return None
    has_names = all(is_topic_name(name) for name in (status.node, *status.topics))
    return status if has_names and _SHA256.fullmatch(status.rules.sha256) else None


MAX_TOPICS = 10_000
"""Topics of all robots together that have metrics."""
MAX_BOOTS = 1_000
"""Runs of robots whose counts are kept."""
_MS_PER_S = 1000


def _name(
    name: str, unit: str, help_text: str, *, labels: tuple[str, ...] = (), counts: bool = False
) -> MetricName:
    kind = MetricKind.COUNTER if counts else MetricKind.GAUGE
    return MetricName(name=f"testudo_receive_{name}", unit=unit, help=help_text, kind=kind, labels=labels)


_ROBOT = ("robot",)
_TOPIC = ("robot", "topic")
_CONNECTED = _name("connected", "", "1 if the robot is connected, else 0.", labels=_ROBOT)
_HERTZ = _name("topic", "hertz", "Messages of the topic that arrive a second.", labels=_TOPIC)
_BANDWIDTH = _name("topic", "bytes_per_second", "What arrives of the topic, unpacked.", labels=_TOPIC)
_AGE = _name("topic_age", "seconds", "Age of the topic's last message when it arrived.", labels=_TOPIC)
_MESSAGES = _name("topic", "messages", "Messages of the topic that arrived.", labels=_TOPIC, counts=True)
_BYTES = _name("topic", "bytes", "What arrived of the topic, unpacked.", labels=_TOPIC, counts=True)
_PREDICTED = _name(
    "topic_predicted", "messages", "Messages of the topic that were made here.", labels=_TOPIC, counts=True
)
_COUNTS = {
    "messages": _name("delivered", "messages", "Messages that arrived whole.", labels=_ROBOT, counts=True),
    "late": _name("late", "messages", "Messages dropped after an outage.", labels=_ROBOT, counts=True),
    "repeated": _name(
        "repeated", "messages", "Messages that were there already.", labels=_ROBOT, counts=True
    ),
    "broken": _name(
        "broken", "messages", "Messages of which a part was missing.", labels=_ROBOT, counts=True
    ),
    "malformed": _name("garbage", "chunks", "Chunks that were not understood.", labels=_ROBOT, counts=True),
    "received_bytes": _name("link", "bytes", "Bytes that came over the link.", labels=_ROBOT, counts=True),
}
_UNKNOWN = _name("stray", "chunks", "Chunks of robots that are not known here.", counts=True)
_DROPPED = _name("dropped", "events", "Events that gave way because this end was busy.", counts=True)
_UNREADABLE = _name("unreadable", "statuses", "Statuses of robots that could not be read here.", counts=True)
_LEFT_OUT = _name("left_out", "topics", f"Topics without metrics here, beyond {grouped(MAX_TOPICS)}.")
RECEPTION_METRICS = (
    *(_CONNECTED, _HERTZ, _BANDWIDTH, _AGE, _MESSAGES, _BYTES, _PREDICTED, *_COUNTS.values()),
    *(_UNKNOWN, _DROPPED, _UNREADABLE, _LEFT_OUT),
)
"""All that ``ReceptionMetrics`` may give beside the metrics of robots' statuses."""


class ReceptionMetrics:
    """The metrics of the last ``update``. Any thread may ask for them; the rest is for the one that receives.

    A robot's own status, which ``statuses`` gets, is told under the names that it has at the robot, while the
    robot is connected.
    """

    def __init__(self, statuses: StatusSink) -> None:
        self._statuses = statuses
        self._last: list[Metric] = []
        self._counts: dict[Boot, ReceiverCounts] = {}

    def metrics(self) -> list[Metric]:
        return self._last

    def update(self, reception: Reception, end: OperatorEnd) -> None:
        """Take what is known now; to be called after ``Reception.measure``."""
        # A robot that is away keeps its counts, or they would fall.
        self._counts |= end.counts()
        while len(self._counts) > MAX_BOOTS:
            del self._counts[next(iter(self._counts))]
        connected = {robot for robot, known in reception.robots.items() if known.boots}
        received = self._statuses.statuses().items()
        statuses = islice(((robot, status) for robot, status in received if robot in connected), MAX_ROBOTS)
        self._last = [*self._of_reception(reception, end), *status_metrics(dict(statuses))]

    def _of_reception(self, reception: Reception, end: OperatorEnd) -> Iterator[Metric]:
        robots = dict(islice(reception.robots.items(), MAX_ROBOTS))
        all_topics = [
            ((robot, name), topic) for robot, known in robots.items() for name, topic in known.topics.items()
        ]
        topics = all_topics[:MAX_TOPICS]
        connected = [((robot,), float(bool(known.boots))) for robot, known in robots.items()]
        yield Metric(name=_CONNECTED, samples=connected)
        yield from _of_topics(topics)
        yield from _of_counts(self._counts)
        yield Metric(name=_UNKNOWN, samples=[((), float(end.unknown))])
        yield Metric(name=_DROPPED, samples=[((), float(end.dropped))])
        yield Metric(name=_UNREADABLE, samples=[((), float(self._statuses.unreadable))])
        yield Metric(name=_LEFT_OUT, samples=[((), float(len(all_topics) - len(topics)))])


def _of_topics(topics: list[tuple[tuple[str, str], ReceivedTopic]]) -> Iterator[Metric]:
    rates = ((labels, topic.meter.rate_hz) for labels, topic in topics)
    ages = ((labels, topic.age_ms) for labels, topic in topics)
    yield Metric(name=_HERTZ, samples=[(labels, hz) for labels, hz in rates if hz is not None])
    yield Metric(
        name=_BANDWIDTH, samples=[(labels, topic.meter.kb_per_s * BYTES_PER_KB) for labels, topic in topics]
    )
    yield Metric(name=_AGE, samples=[(labels, ms / _MS_PER_S) for labels, ms in ages if ms is not None])
    yield Metric(name=_MESSAGES, samples=[(labels, float(topic.flow.messages)) for labels, topic in topics])
    predicted = [(labels, float(topic.predicted)) for labels, topic in topics if topic.predicted]
    yield Metric(name=_PREDICTED, samples=predicted)
    yield Metric(name=_BYTES, samples=[(labels, float(topic.flow.size_bytes)) for labels, topic in topics])


def _of_counts(counts: Mapping[Boot, ReceiverCounts]) -> Iterator[Metric]:
    for field in fields(ReceiverCounts):
        sums: dict[tuple[str, ...], float] = {}
        for boot, counted in counts.items():
            sums[(boot.robot,)] = sums.get((boot.robot,), 0.0) + getattr(counted, field.name)
        samples: list[Sample] = list(sums.items())
        yield Metric(name=_COUNTS[field.name], samples=samples)
