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

from smarttestudo.accuracy.samples import Message, TopicSamples, thinned
from smarttestudo.domain.profile import TopicProfile
from smarttestudo.domain.units import BYTES_PER_KB, NS_PER_S
from smarttestudo.optimizer.problem import Demand, Piece, allocate, envelope_pieces, round_down
from smarttestudo.optimizer.profiling import proposed_tiers_hz
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


_WHOLE = 1 - 1e-9
_TRIES = 4
_NEAR_ENOUGH = 0.01
_HALVINGS = 16


@dataclass(frozen=True, slots=True, kw_only=True)
class Source:
    """A topic as it was sent: all its bytes, its mean rate from first to last message, and its profile.

    ``mean_hz`` is ``None`` where one message or stamp leaves it undefined.
    """

    topic: str
    size_bytes: int
    mean_hz: float | None
    entry: TopicProfile


def best_fixed_rates(sources: Sequence[Source], budget_bytes: float) -> dict[str, float]:
    """The rates in Hz of the greatest benefit that carry ``budget_bytes`` in all; infinite passes everything.

    It is OBI's benefit model, with the tiers of the profile or those proposed from the source's rate, and
    without floors. What is left once every topic is at its τ4 raises them to their source, the smallest
    messages first. A topic without a rate is passed whole.
    """
    paced = [source for source in sources if source.mean_hz]
    rates = {source.topic: math.inf for source in sources}
    whole_bytes = sum(source.size_bytes for source in sources if source not in paced)
    limit_kb = max(0.0, budget_bytes - whole_bytes) / BYTES_PER_KB
    by_benefit = _allocated([_demand(source) for source in paced], limit_kb)
    filled = [
        _demand(source)._replace(least_hz=hz, pieces=(Piece(max(0.0, _source_hz(source) - hz), 1.0),))
        for source, hz in zip(paced, by_benefit, strict=True)
    ]
    for source, hz in zip(paced, _allocated(filled, limit_kb), strict=True):
        if hz < _WHOLE * _source_hz(source):
            rates[source.topic] = round_down(hz)
    return rates


def _demand(source: Source) -> Demand:
    """The source in the terms of OBI; what one Hz costs is counted in KB over the whole recording."""
    source_hz = _source_hz(source)
    tiers_hz = source.entry.tiers_hz or proposed_tiers_hz(source_hz)
    return Demand(
        topic=source.topic,
        size_kb=source.size_bytes / BYTES_PER_KB / source_hz,
        least_hz=0.0,
        pieces=envelope_pieces(tiers_hz, least_hz=0.0, most_hz=source_hz, priority=source.entry.priority),
    )


def _allocated(demands: Sequence[Demand], limit_kb: float) -> list[float]:
    best = allocate(demands, limit_kb)
    return [best.rates_hz[one.topic] if best else one.least_hz for one in demands]


def _source_hz(source: Source) -> float:
    return source.mean_hz or 0.0


def rate_of_bytes(samples: TopicSamples, size_bytes: int, end_ns: int) -> float:
    """The fixed rate that carries about so many bytes of a topic, infinite for all.

    Named streams, such as transforms, have the rate for each. Slow ones pass whole, so that bytes are not in
    proportion to rates: theirs, which is not above the mean rate of the topic, is found by halving.
    """
    share = size_bytes / samples.size_bytes if samples.size_bytes else 1.0
    source_hz = samples.mean_hz
    if share >= 1 or not source_hz:
        return math.inf
    if samples.kind is not StreamKind.NAMED:
        return share * source_hz
    low_hz, high_hz = 0.0, source_hz
    for _ in range(_HALVINGS):
        rate_hz = (low_hz + high_hz) / 2
        passed = thinned(samples.stamps_ns, rate_hz, end_ns=end_ns, kind=samples.kind, frames=samples.frames)
        passed_bytes = sum(samples.sizes[index] for index in passed.indices)
        low_hz, high_hz = (rate_hz, high_hz) if passed_bytes <= size_bytes else (low_hz, rate_hz)
    return low_hz


def rate_of_messages(
    messages: int,
    stamps_ns: Sequence[int],
    *,
    end_ns: int,
    kind: StreamKind,
    frames: Sequence[tuple[str, ...]],
) -> float:
    """The fixed rate at which about so many of the messages at ``stamps_ns`` pass, infinite for all.

    Named streams, such as transforms, have the rate for each: messages at a rate must be counted.
    """
    lasted_s = (end_ns - stamps_ns[0]) / NS_PER_S if stamps_ns else 0.0
    if messages >= len(stamps_ns) or not lasted_s:
        return math.inf
    rate_hz = max(messages - 1, 1) / lasted_s
    for _ in range(_TRIES):
        passed = len(thinned(stamps_ns, rate_hz, end_ns=end_ns, kind=kind, frames=frames).indices)
        if abs(passed - messages) <= max(1, _NEAR_ENOUGH * messages):
            break
        rate_hz *= messages / passed
    return rate_hz
