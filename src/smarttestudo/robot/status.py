# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""Status of a live run: from its loop, what its topics are linked to, and the time between measurements."""

from __future__ import annotations

import math
import secrets
import struct
from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from typing import NamedTuple

from smarttestudo.domain.profile import TopicProfile
from smarttestudo.domain.rate_meter import FlowMeter, RateWindow
from smarttestudo.domain.status import (
    STATUS_HZ,
    ProcessReading,
    RulesInForce,
    RuntimeStatus,
    Silence,
    ThinningDoubt,
    TopicCounts,
    TopicStatus,
)
from smarttestudo.domain.units import BYTES_PER_MB, NS_PER_MS, NS_PER_S, ns_from_s
from smarttestudo.loop.relay import Relayed
from smarttestudo.loop.relay_loop import RelayLoop
from smarttestudo.loop.statistics import FrameFlows, RelayStatistics
from smarttestudo.pacing.cdr import STAMPED_BYTES, header_stamp
from smarttestudo.pacing.sample import StreamKind, is_patch
from smarttestudo.pacing.stream import WHOLE_FROM_PERIOD_NS
from smarttestudo.robot.losses import SourceLoss


@dataclass(frozen=True, slots=True, kw_only=True)
class TopicLink:
    """Connections of a relayed topic on the graph.

    Unless it ``is_subscribed``, the source is not subscribed to; it was ``subscriptions`` times.
    Of the ``subscribers`` of the output, its QoS cannot serve ``unserved``, which are of the nodes
    ``incompatible``.
    """

    output: str
    type_name: str | None = None
    publishers: int = 0
    is_subscribed: bool = True
    subscriptions: int = 0
    transient_local: bool = False
    has_header: bool = False
    subscribers: int = 0
    unserved: int = 0
    incompatible: tuple[str, ...] = ()
    problem: str | None = None

    @property
    def is_received(self) -> bool:
        """Whether somebody receives what is relayed."""
        return self.subscribers > self.unserved


TOLERANCE_PERCENT = 5.0
_CPU_OVER_NS = NS_PER_S * 9 // 10
_ERROR_AFTER_NS = 5 * NS_PER_S
# What a pacer's credit and the edges of a window may add or take.
_MESSAGES_EXPLAINED = 3
# Of a source of which nearly all is lost, its rate cannot be measured.
_LEAST_SHARE = 0.01
_SOON_NS = 2 * NS_PER_S
_OVERDUE_NS = 10 * NS_PER_S
_BEGINNING = slice(STAMPED_BYTES)


class MessageAge:
    """The rate of a topic by its messages' own stamps, and the age of the last one when it was relayed.

    Means something only for messages that begin with a std_msgs/Header. Both are ``None`` while unknown.
    """

    __slots__ = ("_beginning", "_relayed_ns", "_window", "delay_ms", "stamped_hz")

    def __init__(self) -> None:
        self.delay_ms: float | None = None
        self.stamped_hz: float | None = None
        self._beginning = b""
        self._relayed_ns = 0
        self._window = RateWindow()

    def note(self, beginning: bytes, relayed_ns: int) -> None:
        """A message was relayed; ``beginning`` are its bytes up to the end of a header's stamp."""
        self._beginning = beginning
        self._relayed_ns = relayed_ns

    def measure(self, now_ns: int, messages: int) -> None:
        """Read the last stamp; ``messages`` were relayed so far."""
        stamp = header_stamp(self._beginning)
        if stamp is None:
            return
        sec, nanosec = struct.unpack("<iI", stamp)
        stamp_ns = sec * NS_PER_S + nanosec
        self._window.measure(now_ns, messages, stamp_ns)
        self.stamped_hz = self._window.rate_hz
        # A driver that does not stamp leaves zeros.
        self.delay_ms = (self._relayed_ns - stamp_ns) / NS_PER_MS if stamp_ns else None


class _Rates(NamedTuple):
    """Rates in Hz: of the source, as the output should have, and as it has; ``None`` if unknown."""

    source_hz: float | None
    expected_hz: float | None
    actual_hz: float | None


_NO_RATES = _Rates(None, None, None)


class _FrameMeters:
    """Both sides of each child frame of a topic of transforms, which is what its target is about."""

    __slots__ = ("_arrived", "_flows", "_relayed")

    def __init__(self, flows: FrameFlows) -> None:
        self._flows = flows
        self._arrived: dict[str, FlowMeter] = {}
        self._relayed: dict[str, FlowMeter] = {}

    def __len__(self) -> int:
        return len(self._flows)

    def restart_arrived(self) -> None:
        """Measure what comes from the next message on."""
        for meter in self._arrived.values():
            meter.restart()

    def restart_relayed(self) -> None:
        """Measure what is relayed from the next message on."""
        for meter in self._relayed.values():
            meter.restart()

    def measure(self, now_ns: int, *, stale_after_ns: int | None, transient_local: bool) -> None:
        """Measure anew."""
        for flows, meters in ((self._flows.arrived, self._arrived), (self._flows.relayed, self._relayed)):
            for frame, flow in flows.items():
                if frame not in meters:
                    meters[frame] = FlowMeter(flow)
                meters[frame].measure(now_ns, stale_after_ns=stale_after_ns, transient_local=transient_local)

    def rates(self, target_hz: float) -> _Rates:
        """The means over the streams that come and go."""
        known = [
            _Rates(arrived.rate_hz, min(arrived.rate_hz, target_hz), relayed.rate_hz)
            for frame, arrived in self._arrived.items()
            if arrived.rate_hz and (relayed := self._relayed.get(frame)) is not None and relayed.rate_hz
        ]
        if not known:
            return _NO_RATES
        return _Rates(*(math.fsum(column) / len(column) for column in zip(*known, strict=True)))


class TopicMeters:
    """Both sides of one relay, measured at each status."""

    __slots__ = (
        "_changes",
        "_subscriptions",
        "age",
        "arrived",
        "frames",
        "is_subscribed",
        "lost_share",
        "measured_ns",
        "relayed",
        "statistics",
        "target_hz",
    )

    def __init__(self, statistics: RelayStatistics) -> None:
        self.statistics = statistics
        self.frames = _FrameMeters(statistics.frames)
        self.arrived = FlowMeter(statistics.arrived)
        self.relayed = FlowMeter(statistics.relayed)
        self.age = MessageAge()
        self.target_hz = statistics.target.rate_hz
        self.is_subscribed = True
        self.lost_share = 0.0
        self._changes = statistics.target.changes
        self._subscriptions = 0
        self.measured_ns = 0

    def note(self, relayed: Relayed) -> None:
        """A message was relayed."""
        self.age.note(relayed.payload[_BEGINNING], relayed.stamp_ns)

    def measure(self, link: TopicLink, profile: TopicProfile, now_ns: int) -> None:
        """Measure anew; the output's rate from its last change of target on, or its last subscription."""
        target, measured_ns = self.statistics.target, self.measured_ns
        # Within a second there and back says nothing.
        has_changed = now_ns - measured_ns > _SOON_NS and target.changes != self._changes
        is_subscribed_anew = link.is_subscribed and not (
            self.is_subscribed and self._subscriptions == link.subscriptions
        )
        if is_subscribed_anew:
            # What came meanwhile is not known, and none of it was relayed.
            self.arrived.restart()
            self.frames.restart_arrived()
        if is_subscribed_anew or has_changed or self.target_hz != target.rate_hz:
            self.target_hz = target.rate_hz
            self.relayed.restart()
            self.frames.restart_relayed()
        self.is_subscribed, self._subscriptions = link.is_subscribed, link.subscriptions
        self._changes, self.measured_ns = target.changes, now_ns
        stale_after_s = profile.stale_after_s
        stale_after_ns = None if stale_after_s is None else ns_from_s(stale_after_s)
        self.arrived.measure(now_ns, stale_after_ns=stale_after_ns, transient_local=link.transient_local)
        self.frames.measure(now_ns, stale_after_ns=stale_after_ns, transient_local=link.transient_local)
        self.relayed.measure(now_ns, transient_local=link.transient_local)
        self.age.measure(now_ns, self.statistics.relayed.messages)

    @property
    def rates(self) -> _Rates:
        """Of messages, or of transforms by frame; unknown where nothing is received of the source."""
        if not self.is_subscribed:
            return _NO_RATES
        if self.frames:
            return self.frames.rates(self.target_hz)
        came_hz = self.arrived.rate_hz
        source_hz = None if came_hz is None else came_hz / max(1 - self.lost_share, _LEAST_SHARE)
        expected_hz = None if source_hz is None else min(self.target_hz, source_hz)
        return _Rates(source_hz, expected_hz, self.relayed.rate_hz)


class _Error(NamedTuple):
    """How far the output's rate is off, and whether that is as it should be."""

    percent: float | None
    is_explained: bool


class MeasuredTopic(NamedTuple):
    """A relayed topic as its status sees it; its loss is ``None`` where that is not known."""

    link: TopicLink
    meters: TopicMeters
    loss: SourceLoss | None


class LiveStatus:
    """Measures a live run at each ``measure``: once a second, or every ten while nobody asks."""

    def __init__(self, node: str, start: ProcessReading) -> None:
        self._cpu_percent: float | None = None
        self._node = node
        self._run = secrets.token_hex(4)
        self._start = self._process = start

    def measure(
        self,
        loop: RelayLoop,
        topics: Mapping[str, MeasuredTopic],
        rules: RulesInForce,
        process: ProcessReading,
        now_ns: int,
        *,
        status_hz: float = STATUS_HZ,
    ) -> RuntimeStatus:
        """The status at ``now_ns`` on the node's clock, by when what time alone does was done.

        ``topics`` are all relayed ones. The blocks are left to the caller.
        """
        resident = process.resident_bytes
        return RuntimeStatus(
            node=self._node,
            run=self._run,
            stamp_ns=now_ns,
            uptime_s=(process.steady_ns - self._start.steady_ns) / NS_PER_S,
            rules=rules,
            budget_kb_per_s=loop.knowledge.budget_kb_per_s,
            floors_break_budget=loop.knowledge.floors_break_budget,
            cpu_percent=self._share_of_cpu(process),
            memory_mb=None if resident is None else resident / BYTES_PER_MB,
            topics={name: _topic_status(name, topic, loop, now_ns) for name, topic in topics.items()},
            status_hz=status_hz,
        )

    def _share_of_cpu(self, process: ProcessReading) -> float | None:
        """Over about a second: less is too short to say."""
        elapsed_ns = process.steady_ns - self._process.steady_ns
        if elapsed_ns >= _CPU_OVER_NS:
            self._cpu_percent = 100 * (process.cpu_ns - self._process.cpu_ns) / elapsed_ns
            self._process = process
        return self._cpu_percent


def _topic_status(name: str, topic: MeasuredTopic, loop: RelayLoop, now_ns: int) -> TopicStatus:
    (link, meters, loss), planned = topic, loop.knowledge.plan[name]
    meters.lost_share = 0.0 if loss is None else loss.share
    meters.measure(link, loop.knowledge.profile.topic(name), now_ns)
    counts = _counts(name, meters.statistics, loop, loss)
    rates = meters.rates
    error = _Error(None, is_explained=True) if planned.within else _error(meters, rates, link)
    is_silent = meters.arrived.is_silent and meters.is_subscribed
    is_still = is_silent or meters.target_hz == 0
    return TopicStatus(
        output=link.output,
        type_name=link.type_name,
        reason=planned.reason,
        rule=planned.rule,
        line=planned.line,
        target_hz=meters.target_hz,
        source_hz=0.0 if is_silent else rates.source_hz,
        expected_hz=rates.expected_hz,
        actual_hz=0.0 if is_still else rates.actual_hz,
        error_percent=error.percent,
        keeps_rate=error.is_explained,
        stamped_hz=meters.age.stamped_hz if link.has_header else None,
        delay_ms=meters.age.delay_ms if link.has_header else None,
        in_kb_per_s=meters.arrived.kb_per_s,
        out_kb_per_s=meters.relayed.kb_per_s if meters.target_hz and link.is_received else 0.0,
        publishers=link.publishers,
        subscribers=link.subscribers,
        incompatible=link.incompatible,
        problem=link.problem,
        silence=_silence(link, meters),
        counts=counts,
        frames=len(meters.frames) or None,
        loss=None if loss is None else loss.state,
        doubt=_doubt(link, meters, counts),
        within=planned.within,
        bound_reasons=planned.bound_reasons,
    )


def _counts(topic: str, statistics: RelayStatistics, loop: RelayLoop, loss: SourceLoss | None) -> TopicCounts:
    return TopicCounts(
        received=statistics.arrived.messages,
        lost=None if loss is None else loss.messages,
        relayed=statistics.relayed.messages,
        repeated=statistics.repeated,
        discarded=loop.relays.discarded.get(topic, 0),
        undecodable=loop.knowledge.undecodable.get(topic, 0),
    )


def _error(meters: TopicMeters, rates: _Rates, link: TopicLink) -> _Error:
    expected_hz, actual_hz, span_ns = rates.expected_hz, rates.actual_hz, meters.relayed.span_ns
    kind = StreamKind.of(type_name=link.type_name or "", transient_local=link.transient_local)
    is_latched = kind is StreamKind.TRANSIENT_LOCAL
    if not expected_hz or meters.statistics.repeated:
        return _Error(None, is_explained=True)
    if meters.relayed.is_silent and not meters.arrived.is_silent and not is_latched:
        return _Error(-100.0, is_explained=meters.statistics.video is not None)
    if not actual_hz or span_ns < _ERROR_AFTER_NS:
        return _Error(None, is_explained=True)
    if kind is not StreamKind.NAMED and link.publishers > 1 and actual_hz > expected_hz:
        # Where publishers are told apart, each has the rate for itself.
        return _Error(None, is_explained=True)
    percent = 100 * (actual_hz / expected_hz - 1)
    if is_latched and percent > TOLERANCE_PERCENT:
        # All of it passes in the first seconds, and while it is slow.
        is_thinned = (rates.source_hz or 0) * WHOLE_FROM_PERIOD_NS > NS_PER_S
        return _Error(percent if is_thinned else None, is_explained=True)
    if meters.statistics.video is not None:
        # Of long groups less passes, and all where no key frame is found; a doubt says so.
        return _Error(percent, is_explained=True)
    messages_off = abs(actual_hz - expected_hz) * span_ns / NS_PER_S
    return _Error(percent, abs(percent) <= TOLERANCE_PERCENT or messages_off <= _MESSAGES_EXPLAINED)


def _doubt(link: TopicLink, meters: TopicMeters, counts: TopicCounts) -> ThinningDoubt | None:
    if not 0 < meters.target_hz < math.inf:
        return None
    if is_patch(link.type_name or ""):
        return ThinningDoubt.PATCHES if counts.dropped > 0 else None
    video = meters.statistics.video
    if video is None or meters.measured_ns - video.since_ns < _OVERDUE_NS:
        return None
    if not video.keys:
        return ThinningDoubt.NO_KEY_FRAME
    rests_ns = meters.measured_ns - meters.statistics.relayed.last_ns
    is_overdue = rests_ns * meters.target_hz > 2 * NS_PER_S and rests_ns >= _OVERDUE_NS
    return ThinningDoubt.KEY_FRAME_OVERDUE if is_overdue and not meters.arrived.is_silent else None


def doubt_lines(topics: Mapping[str, TopicStatus]) -> Iterator[str]:
    """A line for each topic that is not shown as its rate says."""
    for topic, status in topics.items():
        if status.doubt is not None:
            yield f"{topic}: {status.doubt.value}: {status.doubt.details}"


def _silence(link: TopicLink, meters: TopicMeters) -> Silence | None:
    reasons = (
        (Silence.OFF, meters.target_hz == 0),
        (Silence.NO_PUBLISHER, link.publishers == 0),
        (Silence.CANNOT_RELAY, link.problem is not None),
        (Silence.NO_SUBSCRIBER, link.subscribers == 0),
        (Silence.INCOMPATIBLE_QOS, link.subscribers == link.unserved),
        (Silence.NO_MESSAGE, meters.statistics.arrived.messages == 0),
        (Silence.SOURCE_SILENT, meters.arrived.is_silent),
    )
    for reason, holds in reasons:
        if holds:
            return reason
    return None
