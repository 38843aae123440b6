# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""Streams of a topic whose receiver's estimate is kept within bounds."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Annotated

from smarttestudo.domain.record import JsonEntry
from smarttestudo.pacing.grid import NEVER_NS, Grid, Pace
from smarttestudo.pacing.reckoning.estimate import Estimate
from smarttestudo.pacing.sample import Pass, Sample
from smarttestudo.pacing.stream import VolatileStream
from smarttestudo.pacing.streams import Streams

HEARTBEAT_HZ = 0.5
"""Without a floor, one message in 2 s passes all the same, so that silence is a failure."""


@dataclass(slots=True)
class BoundRecord:
    """How a bound was kept while it was in force, over the messages of the source that have a value.

    Of a property with many bounds, a record stands for several, and ``bound`` is the widest of them.
    ``worst`` is the estimate's largest finite error after one, ``None`` where it never had one. ``broken``
    counts those after which the estimate was more than the bound off, or said nothing. ``last`` is the error
    after the newest message, infinite where the estimate, or the message, says nothing. A message without a
    value is judged by no bound.
    """

    bound: float
    worst: float | None = None
    last: Annotated[float, JsonEntry(is_absent=True)] = math.inf
    broken: int = 0


BoundRecords = dict[str, dict[float, BoundRecord]]
"""By property, and then by bound."""

MOST_BOUNDS = 16
"""Bounds of a property that have a record of their own: a budget that widens them gives ever new ones."""


def _new_record(by_bound: dict[float, BoundRecord], bound: float) -> BoundRecord:
    """The record of a bound that has none: a new one, or where there are many, that of the next wider one."""
    if len(by_bound) < MOST_BOUNDS:
        return by_bound.setdefault(bound, BoundRecord(bound))
    record = by_bound[min((larger for larger in by_bound if larger > bound), default=max(by_bound))]
    record.bound = max(record.bound, bound)
    return record


class BoundStream(VolatileStream):
    """One stream of a bound topic: its grid is the heartbeat's, ``ceiling`` that of the topic's rate.

    A held sample that is ``overdue``, because the estimate is out of bounds without it, passes as soon as the
    ceiling lets it.
    """

    __slots__ = ("ceiling", "overdue")

    def __init__(self, heartbeat: Pace, ceiling: Pace, now_ns: int) -> None:
        super().__init__(heartbeat, now_ns)
        self.ceiling = Grid(ceiling, now_ns)
        self.overdue = False

    def charge(self, now_ns: int) -> None:
        """Something passes now that counts for this stream."""
        super().charge(now_ns)
        self.ceiling.charge(now_ns, self._ceiling_slack_ns)

    def settle(self, now_ns: int) -> None:
        super().settle(now_ns)
        self.overdue = False

    @property
    def release_ns(self) -> int:
        """When the held sample passes without a newer one."""
        if self.held is None:
            return NEVER_NS
        return self.ceiling.due_ns if self.overdue else max(super().release_ns, self.ceiling.due_ns)

    def change_pace(self, pace: Pace, now_ns: int) -> None:
        """Take another ceiling; held messages stay held, also while Off."""
        self.ceiling.change_pace(pace, now_ns, self._ceiling_slack_ns)

    def change_heartbeat(self, pace: Pace, now_ns: int) -> None:
        self.grid.change_pace(pace, now_ns, self.slack_ns)

    def restart(self, now_ns: int) -> None:
        """Begin anew on a clock that jumped back."""
        super().restart(now_ns)
        self.ceiling.start(now_ns)

    def is_idle(self, now_ns: int) -> bool:
        """Whether a fresh stream would do as well."""
        ceiling = self.ceiling
        is_ahead = ceiling.due_ns >= now_ns - self._ceiling_slack_ns and not ceiling.pace.is_off
        return not is_ahead and super().is_idle(now_ns)

    @property
    def _ceiling_slack_ns(self) -> int:
        return self.ceiling.pace.slack_ns(self.source.longest_ns)


class BoundStreams(Streams[BoundStream]):
    """A stream for each name in the messages, such as a child frame, or for each publisher.

    A message passes if the estimate without it is more than a bound off, or if the heartbeat of any of its
    streams is due; in both cases only where the ceiling of any of them lets it. So after every message of the
    source the estimate is within the bounds, unless the ceiling forbids it, which is counted in ``records``.
    There is a bound for each property that the estimate measures, infinite where none is in force.
    """

    __slots__ = ("_estimate", "_heartbeat", "bounds", "records")

    def __init__(
        self,
        estimate: Estimate,
        bounds: Mapping[str, float],
        records: BoundRecords,
        *,
        ceiling: Pace,
        heartbeat_hz: float,
    ) -> None:
        super().__init__(lambda pace, now_ns: BoundStream(self._heartbeat, pace, now_ns), ceiling)
        self._estimate = estimate
        estimate.expect_heartbeat(heartbeat_hz)
        self._heartbeat = Pace.at(heartbeat_hz)
        self.bounds = bounds
        self.records = records

    def offer(self, sample: Sample, now_ns: int) -> Sequence[Pass]:
        """Pace ``sample``, which arrived: return it if it passes now, else nothing."""
        streams = self._streams_of(sample, now_ns)
        errors = self._estimate.errors(sample.readings, sample.publisher)
        is_off_bound = self._is_off_bound(errors)
        is_wanted, may_pass = is_off_bound, False
        for stream in streams:
            stream.source.record(now_ns)
            is_wanted = is_wanted or now_ns >= stream.grid.due_ns
            may_pass = may_pass or now_ns >= stream.ceiling.due_ns
        if is_wanted and may_pass:
            self._record(sample, errors, passes=True)
            self._pass(sample, streams, now_ns)
            return (Pass(sample),)
        self._record(sample, errors, passes=False)
        for stream in streams:
            stream.hold(sample, now_ns)
            stream.overdue = is_off_bound
        self._arm(now_ns)
        return ()

    def holds(self, sample: Sample) -> bool:
        """Whether ``sample`` did not pass, but still may."""
        return any(stream.held is sample for stream in self._streams.values())

    def change_bounds(self, bounds: Mapping[str, float], heartbeat_hz: float, now_ns: int) -> None:
        """Keep the estimate within other ``bounds`` of the same properties from now on."""
        self.bounds = bounds
        self._estimate.expect_heartbeat(heartbeat_hz)
        pace = Pace.at(heartbeat_hz)
        for stream in self._streams.values():
            if pace != self._heartbeat:
                stream.change_heartbeat(pace, now_ns)
        self._heartbeat = pace
        self._judge_again(now_ns)

    def forget_receivers(self, now_ns: int) -> None:
        """Serve a new receiver, which has got nothing yet: the newest message is due at once."""
        self._estimate.forget()
        self._judge_again(now_ns)

    def _judge_again(self, now_ns: int) -> None:
        for stream in self._streams.values():
            if stream.held is not None:
                errors = self._estimate.errors(stream.held.readings, stream.held.publisher)
                stream.overdue = self._is_off_bound(errors)
        self._arm(now_ns)

    def _is_off_bound(self, errors: Mapping[str, float]) -> bool:
        bounds = self.bounds
        return any(error > bounds[name] for name, error in errors.items())

    def _record(self, sample: Sample, errors: Mapping[str, float], *, passes: bool) -> None:
        # A finite error is one of two values, so who has none is only asked for where one is infinite.
        judged = errors
        if math.inf in errors.values():
            judged = self._estimate.judged_errors(sample.readings, sample.publisher)
        for name in errors:
            bound = self.bounds[name]
            if bound == math.inf:
                continue
            by_bound = self.records.setdefault(name, {})
            record = by_bound.get(bound) or _new_record(by_bound, bound)
            if name not in judged:
                record.last = math.inf
                continue
            record.last = error = 0.0 if passes else judged[name]
            if error > bound:
                record.broken += 1
            if error < math.inf and (record.worst is None or error > record.worst):
                record.worst = error

    def _pass(self, sample: Sample, streams: Sequence[BoundStream], now_ns: int) -> None:
        for stream in streams:
            stream.settle(now_ns)
        self._estimate.show(sample.readings, sample.publisher)
        self._arm(now_ns)

    def _release(self, stream: BoundStream, now_ns: int) -> Sequence[Pass]:
        sample = stream.held
        if sample is None:
            return ()
        if not stream.overdue and self._estimate.is_taken_over(sample.readings, sample.publisher):
            # Else the last word of a node that was restarted arrived after the first one of its successor.
            stream.held = None
            return ()
        for other in {stream, *self._streams_of(sample, now_ns)}:
            other.charge(now_ns)
            if other.held is sample:
                other.held, other.overdue = None, False
        self._estimate.show(sample.readings, sample.publisher)
        return (Pass(sample),)
