# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""Ways to send a topic, and how far the picture of its receiver is off over time."""

from __future__ import annotations

import math
from collections import Counter
from collections.abc import Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass
from itertools import groupby
from operator import attrgetter

from smarttestudo.accuracy.track import Message
from smarttestudo.pacing.bound import HEARTBEAT_HZ, BoundRecords
from smarttestudo.pacing.reckoning.estimate import Estimate
from smarttestudo.pacing.reckoning.gauges import Gauge
from smarttestudo.pacing.sample import Pass, Sample, StreamKind
from smarttestudo.pacing.topic_pacer import Accuracy, TopicPacer


@dataclass(frozen=True, slots=True, kw_only=True)
class PacedPicture:
    """Messages that passed, and how far the receiver's picture was off after each message of the source.

    ``rmse`` is over time, ``worst`` is the largest error, both without the ``unknown`` messages after which
    nothing was shown, or which have no value themselves.
    """

    messages: int
    rmse: float
    worst: float
    unknown: int


class ErrorOverTime:
    """Adds up an error that counts until the next one: RMSE = √(Σ d·e² / Σ d).

    It is taken at each message of the source, after what passed until then. An infinite one is unknown, and
    counts in ``unknown`` alone.
    """

    __slots__ = ("_error", "_now_ns", "_squares", "_total_ns", "is_known", "unknown", "worst")

    def __init__(self, now_ns: int) -> None:
        self._now_ns, self._error = now_ns, math.inf
        self._squares, self._total_ns = 0.0, 0
        self.worst, self.unknown, self.is_known = 0.0, 0, False

    def add(self, error: float, now_ns: int) -> None:
        """Count the error after a message of the source."""
        self._pass_time(now_ns)
        self._error = error
        if error < math.inf:
            self.worst, self.is_known = max(self.worst, error), True
        else:
            self.unknown += 1

    def finish(self, end_ns: int, messages: int) -> PacedPicture:
        """End at ``end_ns``, when ``messages`` passed; an error that lasts no time is as large as it is."""
        self._pass_time(end_ns)
        rmse = math.sqrt(self._squares / self._total_ns) if self._total_ns else self.worst
        return PacedPicture(messages=messages, rmse=rmse, worst=self.worst, unknown=self.unknown)

    def _pass_time(self, now_ns: int) -> None:
        lasted_ns = max(0, now_ns - self._now_ns)
        if self._error < math.inf:
            self._squares += lasted_ns * self._error * self._error
            self._total_ns += lasted_ns
        self._now_ns = now_ns


Later = Mapping[int, int]
"""How many messages of one stamp are still to come, by digest."""

_stamp_of = attrgetter("stamp_ns")


def with_later(sent: Iterable[Message]) -> Iterator[tuple[Message, Later]]:
    """Messages, each with those of its stamp that come after it; valid until the next one is taken."""
    for _, group in groupby(sent, key=_stamp_of):
        of_stamp = list(group)
        later = Counter(message.digest for message in of_stamp)
        for message in of_stamp:
            later[message.digest] -= 1
            yield message, later


class Receiver:
    """The picture of who gets the messages ``received``, compared with each message that the robot sends.

    With ``reckons`` it shows dead reckoning. A message that was received at the stamp at which it was sent is
    shown from then on, and not already with one of the same stamp that was sent before it.
    """

    __slots__ = ("_coming", "_next", "_picture", "_reckons", "last", "messages")

    def __init__(self, gauges: Sequence[Gauge], received: Iterable[Message], *, reckons: bool) -> None:
        self._picture = Estimate(gauges, reckons=reckons)
        self._reckons = reckons
        self._coming = iter(received)
        self._next = next(self._coming, None)
        self.last: Message | None = None
        self.messages = 0

    def catch_up(self, sent: Message, later: Later) -> None:
        """Show what was received until ``sent``, which ``later`` messages of its stamp follow."""
        is_due = True
        while self._next is not None and self._next.stamp_ns <= sent.stamp_ns:
            if self._next.stamp_ns == sent.stamp_ns:
                if is_due and self._next.digest == sent.digest:
                    is_due = False
                elif later.get(self._next.digest):
                    return
            self._show_next(self._next)

    def finish(self, end_ns: int) -> None:
        """Show what was received until ``end_ns``."""
        while self._next is not None and self._next.stamp_ns <= end_ns:
            self._show_next(self._next)

    def errors(self, sent: Message) -> dict[str, float]:
        """How far each property that ``sent`` says is off in the picture, which has caught up with it."""
        errors = self._picture.judged_errors(sent.readings, None)
        return dict.fromkeys(errors, 0.0) if self._has_just_shown(sent) else errors

    def _show_next(self, message: Message) -> None:
        self.last, self._next = message, next(self._coming, None)
        self.messages += 1
        self._picture.show(message.readings, None)

    def _has_just_shown(self, sent: Message) -> bool:
        """Whether the picture was made from this very message: it is right then, whatever is in it."""
        last = self.last
        if last is None or last.digest != sent.digest:
            return False
        return not self._reckons or last.stamp_ns == sent.stamp_ns


def picture_errors(
    sent: Iterable[Message], receivers: Sequence[Receiver], end_ns: int
) -> list[dict[str, PacedPicture]]:
    """For each receiver, the error of each property until ``end_ns``; none of one that is never known."""
    found: list[dict[str, ErrorOverTime]] = [{} for _ in receivers]
    for message, later in with_later(sent):
        now_ns = message.stamp_ns
        for receiver, properties in zip(receivers, found, strict=True):
            receiver.catch_up(message, later)
            errors = receiver.errors(message)
            for name in {**properties, **errors}:
                error = errors.get(name, math.inf)
                properties.setdefault(name, ErrorOverTime(now_ns)).add(error, now_ns)
    for receiver in receivers:
        receiver.finish(end_ns)
    return [
        {name: one.finish(end_ns, receiver.messages) for name, one in properties.items() if one.is_known}
        for receiver, properties in zip(receivers, found, strict=True)
    ]


@dataclass(frozen=True, slots=True, kw_only=True)
class Strategy:
    """A way to send a topic: within ``bound`` of a property, or at a fixed ``rate_hz``.

    With ``reckons`` the receiver shows dead reckoning, else it holds the last message.
    """

    reckons: bool
    bound: float | None = None
    rate_hz: float = math.inf


class Arm:
    """A topic sent by one strategy, and how far its receiver's picture of the property ``name`` is off."""

    __slots__ = ("_error", "_kept", "_messages", "_name", "_pacer", "_picture", "_strategy")

    def __init__(self, picture: Estimate, name: str, kind: StreamKind, strategy: Strategy) -> None:
        self._picture, self._name, self._strategy = picture, name, strategy
        self._pacer = TopicPacer(kind=kind)
        self._kept: BoundRecords = {}
        self._messages = 0
        self._error: ErrorOverTime | None = None

    def send(self, message: Message) -> None:
        """Offer a message of the source to the pacer, and compare the picture with it."""
        now_ns = message.stamp_ns
        if self._error is None:
            self._error = ErrorOverTime(now_ns)
            self._start(now_ns)
        self._wake_until(now_ns)
        sample = Sample(b"", 0, None, message.frames, None, message.readings)
        passes = self._pacer.offer(sample, now_ns)
        self._pass(passes)
        self._error.add(self._error_after(sample, passes), now_ns)

    def finish(self, end_ns: int) -> PacedPicture:
        """End with the recording: what was found."""
        self._pacer.finish()
        self._wake_until(end_ns)
        return (self._error or ErrorOverTime(end_ns)).finish(end_ns, self._messages)

    def _error_after(self, sample: Sample, passes: Sequence[Pass]) -> float:
        """How far off the picture is; a pacer with bounds keeps it itself, and has compared already."""
        if self._strategy.bound is not None:
            return self._kept[self._name][self._strategy.bound].last
        if any(one.sample is sample for one in passes):
            return 0.0
        return self._picture.judged_errors(sample.readings, None).get(self._name, math.inf)

    def _start(self, now_ns: int) -> None:
        strategy = self._strategy
        self._pacer.set_rate(strategy.rate_hz, now_ns)
        if strategy.bound is not None:
            accuracy = Accuracy(
                estimate=self._picture,
                bounds={self._name: strategy.bound},
                heartbeat_hz=HEARTBEAT_HZ,
                records=self._kept,
            )
            self._pacer.set_accuracy(accuracy, now_ns)

    def _wake_until(self, now_ns: int) -> None:
        for _, passes in self._pacer.wake_until(now_ns):
            self._pass(passes)

    def _pass(self, passes: Sequence[Pass]) -> None:
        self._messages += len(passes)
        if self._strategy.bound is None:
            for sample, _ in passes:
                self._picture.show(sample.readings, None)
