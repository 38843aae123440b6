# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""Messages between the two ends of a link, beside chunks and statuses."""

from __future__ import annotations

import math
from collections.abc import Collection, Iterable, Mapping, Sequence
from dataclasses import dataclass, field
from typing import NamedTuple

from smarttestudo.domain.errors import LinkError, TestudoError
from smarttestudo.domain.link import (
    MAX_COMMAND_BYTES,
    MAX_COMMAND_TOPICS,
    CommandTopic,
    Prediction,
    StreamInfo,
)
from smarttestudo.domain.names import TypeName, has_topic_form
from smarttestudo.domain.parameter import GetParameters, GetTopics, SetParameters, Values
from smarttestudo.domain.texts import visible
from smarttestudo.link.protocol.chunks import (
    MAX_DATAGRAM_SPANS,
    MAX_ENDED,
    MAX_STREAMS,
    NOTHING_RECEIVED,
    Acknowledgement,
)
from smarttestudo.link.protocol.wire import FrameType, Kind, Reader, frame, zigzag

MAX_SENDERS = 4
"""Operators that send at the same time."""
MAX_PREDICTED = 64
"""How many topics an operator's end reckons."""
MAX_QUESTION_BYTES = 1_100_000
"""How large a question or an answer may be: rules of about a megabyte fit."""
MAX_PROBLEM = 300

_MAX_DEPTH = 1_000
_MAX_DEFINITION = 256_000
_MAX_DURATION_MS = 1e9
_MAX_NAMES = 32
_MAX_NAME = 255
_MAX_VALUES = 1_000
_MAX_TEXT = 1_000
_MAX_REVISION = 2**16


@dataclass(frozen=True, slots=True, kw_only=True)
class Report:
    """The state of the operator's end: what it ``received`` of the newest session, and of ``ended`` ones.

    ``receiver`` is a random number that tells it from others. ``ages_ms`` says how old the last message of
    each stream was when it arrived; it is there about once a second, and so is what it ``predicts``: the
    topics that it reckons where the robot's end does so too.
    """

    receiver: int
    received: Acknowledgement
    ended: Sequence[Acknowledgement] = ()
    ages_ms: Mapping[int, float] = field(default_factory=dict)
    predicts: frozenset[str] = frozenset()


@dataclass(frozen=True, slots=True, kw_only=True)
class Announcement:
    """A stream of the robot's end; without ``info``, it is closed.

    Its prediction is for the receivers in ``predicted_for``: others may lack what it is made of.
    """

    stream: int
    info: StreamInfo | None
    predicted_for: frozenset[int] = frozenset()


@dataclass(frozen=True, slots=True, kw_only=True)
class LinkTimes:
    """The least round trip that the robot's end has measured, and how often it needs a report."""

    round_trip_ms: float
    report_period_ms: float


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


@dataclass(frozen=True, slots=True, kw_only=True)
class SentNames:
    """The topics that an operator's end sends, by the robot's names."""

    sender: int
    topics: tuple[str, ...]


@dataclass(frozen=True, slots=True, kw_only=True)
class AcceptedStream:
    """An accepted topic; ``revision`` changes with its type, so that no bytes are taken for another type."""

    topic: CommandTopic
    revision: int


@dataclass(frozen=True, slots=True, kw_only=True)
class CommandReport:
    """The state of the robot's end: the newest ``acknowledged`` number by sender, at ``sent_ns`` there.

    ``streams`` are there now and then, in the order that gives them their numbers.
    """

    sent_ns: int
    acknowledged: Mapping[int, int]
    streams: Sequence[AcceptedStream] = ()


class NoAnswer(NamedTuple):
    """Why there is no answer, as a ``TestudoError`` has it."""

    cause: str
    place: str | None
    remedy: str | None

    @staticmethod
    def of(error: TestudoError) -> NoAnswer:
        return NoAnswer(error.cause[:_MAX_TEXT], error.place, error.remedy)

    def error(self) -> LinkError:
        """The refusal in the robot's words, in one line that moves no cursor."""
        place, remedy = (None if text is None else _one_line(text) for text in (self.place, self.remedy))
        return LinkError(_one_line(self.cause), place=place, remedy=remedy)


def _one_line(text: str) -> str:
    return visible(" ".join(text[:_MAX_TEXT].split()))


def _require(condition: object, what: str) -> None:
    if not condition:
        raise ValueError(what)


def _require_topics(names: Iterable[str]) -> None:
    # A name that ROS 2 does not take is reported where it would be published.
    _require(all(len(name) <= _MAX_NAME and has_topic_form(name) for name in names), "no name of a topic")


def _require_duration(number_ms: float) -> None:
    _require(0 <= number_ms <= _MAX_DURATION_MS, "no duration")


def _check_report(report: Report) -> None:
    for age_ms in report.ages_ms.values():
        _require_duration(age_ms)
    _require(len(report.predicts) <= MAX_PREDICTED, "too many topics")
    _require_topics(report.predicts)
    _require(len(report.ended) <= MAX_ENDED, "too many sessions")
    for session in (report.received, *report.ended):
        _require(0 <= session.session < 2**32 and session.received_bytes >= 0, "no session")
        _require(len(session.lost) <= MAX_DATAGRAM_SPANS, "too many lost messages")


def _check_control(said: Announcement | LinkTimes) -> None:
    if isinstance(said, LinkTimes):
        _require_duration(said.round_trip_ms)
        _require_duration(said.report_period_ms)
        return
    _require(0 < said.stream < MAX_STREAMS, "no number of a stream")
    info = said.info
    if info is not None:
        _require_topics([info.topic])
        _require(TypeName.read(info.type_name), "no type")
        _require(0 < info.qos.depth <= _MAX_DEPTH, "no depth of a queue")
        _require(len(info.definition) <= _MAX_DEFINITION, "a definition that is too long")
        if info.prediction is not None:
            _check_prediction(info.prediction)


def _check_prediction(prediction: Prediction) -> None:
    bounds = prediction.within.values()
    _require(all(0 <= bound < math.inf for bound in bounds), "no bound of a prediction")
    _require(0 < prediction.heartbeat_hz < math.inf, "no rate of a heartbeat")


def _check_command(command: CommandMessage | SentNames) -> None:
    if isinstance(command, SentNames):
        _require(len(command.topics) <= MAX_COMMAND_TOPICS, "too many topics")
        _require_topics(command.topics)
    else:
        _require(len(command.payload) <= MAX_COMMAND_BYTES, "a payload that is too large")
        _require(command.topic >= 0, "no number of a topic")


def _check_command_report(report: CommandReport) -> None:
    _require(len(report.acknowledged) <= MAX_SENDERS, "too many senders")
    _require(len(report.streams) <= MAX_COMMAND_TOPICS, "too many topics")
    _require_topics(stream.topic.topic for stream in report.streams)
    for stream in report.streams:
        topic = stream.topic
        _require(topic.type_name is None or TypeName.read(topic.type_name), "no type")
        _require(len(topic.problem or "") <= MAX_PROBLEM, "a problem that is too long")
        _require(topic.age_ms is None or math.isfinite(topic.age_ms), "no age")
        counts = (topic.received, topic.delivered, topic.too_old, topic.refused)
        _require(0 <= stream.revision < _MAX_REVISION and min(counts) >= 0, "no count")


def _check_names(names: Collection[str], most: int) -> None:
    _require(len(names) <= most, "too many names")
    _require(all(len(name) <= _MAX_NAME for name in names), "a name that is too long")


def _check_reading(question: GetParameters | GetTopics) -> None:
    if isinstance(question, GetParameters):
        _check_names(question.names, _MAX_NAMES)


REPORTS: FrameType[Report] = FrameType(Kind.REPORT, Report, _check_report, most_bytes=256_000)
CONTROL: FrameType[Announcement | LinkTimes] = FrameType(
    Kind.CONTROL, Announcement | LinkTimes, _check_control
)
COMMANDS: FrameType[CommandMessage | SentNames] = FrameType(
    Kind.COMMAND, CommandMessage | SentNames, _check_command
)
COMMAND_REPORTS: FrameType[CommandReport] = FrameType(
    Kind.COMMAND_REPORT, CommandReport, _check_command_report, most_bytes=32_000
)
READING_QUESTIONS: FrameType[GetParameters | GetTopics] = FrameType(
    Kind.READING_QUESTION, GetParameters | GetTopics, _check_reading
)
CHANGING_QUESTIONS: FrameType[SetParameters] = FrameType(
    Kind.CHANGING_QUESTION,
    SetParameters,
    lambda question: _check_names(question.values, _MAX_VALUES),
    most_bytes=MAX_QUESTION_BYTES,
)
ANSWERS: FrameType[Values] = FrameType(
    Kind.ANSWER, Values, lambda values: _check_names(values, _MAX_VALUES), most_bytes=MAX_QUESTION_BYTES
)
REFUSALS: FrameType[NoAnswer] = FrameType(Kind.REFUSAL, NoAnswer)


_MAX_RECEIVED = 2**64


class _Frame:
    """The bytes before and after the number of received ones, in reports that say nothing else."""

    def __init__(self, receiver: int, received: Acknowledgement, ended: Sequence[Acknowledgement]) -> None:
        self.receiver = receiver
        self.said = (received.session, received.lost, received.is_cut, ended)
        self.head = frame(Kind.REPORT, zigzag(receiver) + zigzag(received.session))
        self.tail = REPORTS.to_bytes(self.report(0))[len(self.head) + len(zigzag(0)) :]

    def report(self, received_bytes: int) -> Report:
        """The report that so many bytes were received."""
        session, lost, is_cut, ended = self.said
        received = Acknowledgement(session=session, received_bytes=received_bytes, lost=lost, is_cut=is_cut)
        return Report(receiver=self.receiver, received=received, ended=ended)


class ReportWriter:
    """Gives what ``REPORTS.to_bytes`` gives for the reports of one ``receiver``, in less time."""

    def __init__(self, receiver: int) -> None:
        self._frame = _Frame(receiver, NOTHING_RECEIVED, ())

    def to_bytes(self, received: Acknowledgement, ended: Sequence[Acknowledgement]) -> bytes:
        """The report of what was received, and of nothing else."""
        if self._frame.said != (received.session, received.lost, received.is_cut, ended):
            self._frame = _Frame(self._frame.receiver, received, ended)
        return self._frame.head + zigzag(received.received_bytes) + self._frame.tail


class ReportReader:
    """Gives what ``REPORTS.from_bytes`` gives, in less time where reports come from one receiver."""

    def __init__(self) -> None:
        self._frame = _Frame(0, NOTHING_RECEIVED, ())

    def from_bytes(self, data: bytes) -> Report:
        """The report of these bytes. Raises ``LinkError`` for anything else."""
        if data.startswith(self._frame.head):
            reader = Reader(data, len(self._frame.head))
            received_bytes = reader.zigzag()
            if reader.rest() == self._frame.tail and 0 <= received_bytes < _MAX_RECEIVED:
                return self._frame.report(received_bytes)
        report = REPORTS.from_bytes(data)
        self._frame = _Frame(report.receiver, report.received, report.ended)
        return report
