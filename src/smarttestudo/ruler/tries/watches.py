# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""Watches that count and note while a recording is replayed for the page."""

from __future__ import annotations

from collections import Counter
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field, replace

from smarttestudo.bags.definitions import RosbagDecoder
from smarttestudo.bags.mcap.record_bytes import StoredChannel
from smarttestudo.bags.robot_path import PathPoint
from smarttestudo.bags.statistics import TraceAccumulator
from smarttestudo.domain.errors import RecordingError
from smarttestudo.domain.incident import IncidentRecord, Missing
from smarttestudo.domain.recording import Channel, RecordingReader, first_of_topics
from smarttestudo.domain.signal import Truth
from smarttestudo.domain.units import NS_PER_S
from smarttestudo.incidents.folder import first_record, record_holding
from smarttestudo.incidents.sink import Incident, Past
from smarttestudo.incidents.topic_ring import IncidentMessage, SourceMessage
from smarttestudo.language.rule_set import RuleBlock, RuleSet
from smarttestudo.loop.relay_loop import RelayLoop
from smarttestudo.loop.step import Trigger
from smarttestudo.ruler.tries.loss import LossWatch

ODOMETRY = "nav_msgs/msg/Odometry"
MAX_POINTS = 1000


class ArrivalWatch:
    """Counts the messages of ``recording`` as they are read, and follows its odometry.

    Of a topic with two types one counts, as in the replay.
    """

    def __init__(self, recording: RecordingReader, decoder: RosbagDecoder, loss: LossWatch) -> None:
        self._decoder = decoder
        self._loss = loss
        self._declared_bytes = recording.declared_bytes
        self._start_ns = self._due_ns = recording.start_ns
        self._step_ns = max((recording.end_ns - recording.start_ns) // MAX_POINTS, 1)
        self._sources = first_of_topics(recording.channels)
        self.traces = {topic: TraceAccumulator() for topic in self._sources}
        self.path: list[PathPoint] = []
        odometry = [channel.topic for channel in recording.channels if channel.type_name == ODOMETRY]
        self._odometry = "/odom" if "/odom" in odometry else next(iter(odometry), None)

    def arrived(self, channel: Channel, stamp_ns: int, payload: bytes) -> None:
        """Take one message of the recording."""
        topic = channel.topic
        self._loss.arrived(channel, stamp_ns, payload)
        if self._sources[topic].type_name != channel.type_name:
            return
        self.traces[topic].add(stamp_ns, self._declared_bytes.get(topic, len(payload)))
        if topic == self._odometry and stamp_ns >= self._due_ns:
            self._due_ns = stamp_ns + self._step_ns
            self._follow(channel, stamp_ns, payload)

    def _follow(self, channel: Channel, stamp_ns: int, payload: bytes) -> None:
        try:
            position = self._decoder.decode(channel, payload).pose.pose.position  # type: ignore[attr-defined]
        except (RecordingError, AttributeError):
            # The replay itself reports what could not be decoded.
            return
        t_s = (stamp_ns - self._start_ns) / NS_PER_S
        self.path.append(PathPoint(t_s=t_s, x_m=float(position.x), y_m=float(position.y)))


class CountingWriter:
    """Counts what a replay relays, and keeps none of it; ``declared_bytes`` are by output topic."""

    def __init__(self, declared_bytes: Mapping[str, int], loss: LossWatch) -> None:
        self._declared_bytes = declared_bytes
        self._loss = loss
        self.traces: dict[str, TraceAccumulator] = {}

    def add(self, channel: Channel) -> None:
        """Expect messages of ``channel``."""
        self.traces.setdefault(channel.topic, TraceAccumulator())
        self._loss.add(channel)

    def write(self, channel: Channel, stamp_ns: int, payload: bytes) -> None:
        """Count one message."""
        size_bytes = self._declared_bytes.get(channel.topic, len(payload))
        self.traces[channel.topic].add(stamp_ns, size_bytes)
        self._loss.relayed(channel, stamp_ns, payload)


@dataclass(frozen=True, slots=True, kw_only=True)
class BlockTurns:
    """A rule, or its Else, by the line that it begins at, and what it turned to when; it starts unknown."""

    rule: str
    line: int
    turns: tuple[tuple[float, Truth], ...]


class TruthWatch:
    """Notes when blocks turn, the first ``max_turns`` times; what they are after ``cut_s`` is unknown."""

    def __init__(self, rule_set: RuleSet, start_ns: int, *, max_turns: int) -> None:
        self._start_ns = start_ns
        self._left = max_turns
        self._turns: list[tuple[RuleBlock, list[tuple[float, Truth]]]] = [
            (block, [(0.0, Truth.UNKNOWN)]) for block in rule_set.blocks
        ]
        self.cut_s: float | None = None

    @property
    def blocks(self) -> tuple[BlockTurns, ...]:
        """Turns that were noted, in the order of the rules."""
        return tuple(
            BlockTurns(
                rule=block.label,
                line=block.line,
                turns=tuple((round(t_s, 6), truth) for t_s, truth in turns),
            )
            for block, turns in self._turns
        )

    def stepped(self, now_ns: int, loop: RelayLoop) -> None:
        """Find the blocks that turned; called often, and mostly none did."""
        turned = loop.take_turned_blocks()
        if not turned or self.cut_s is not None:
            return
        now_s = (now_ns - self._start_ns) / NS_PER_S
        if len(turned) > self._left:
            self._cut(now_s)
            return
        for order, truth in turned.items():
            turns = self._turns[order][1]
            if turns[-1][1] is not truth:
                self._left -= 1
                turns.append((now_s, truth))

    def _cut(self, now_s: float) -> None:
        self.cut_s = now_s
        for _, turns in self._turns:
            turns.append((now_s, Truth.UNKNOWN))


@dataclass(frozen=True, slots=True, kw_only=True)
class TryIncident:
    """Incident of a try, ``t`` seconds after the start: the ``number``-th, 0 first."""

    number: int
    t: float
    record: IncidentRecord


@dataclass(slots=True, kw_only=True)
class _Tally:
    """Counts of one incident so far."""

    record: IncidentRecord
    messages: Counter[str] = field(default_factory=Counter)
    size_bytes: Counter[str] = field(default_factory=Counter)

    def add(self, message: IncidentMessage) -> None:
        self.messages[message.topic] += 1
        self.size_bytes[message.topic] += len(message.payload)


class IncidentTally:
    """An ``IncidentSink`` that counts, and keeps no message: of the first ``most`` incidents."""

    def __init__(self, most: int) -> None:
        self._most = most
        self._tallies: dict[Incident, _Tally] = {}
        self._channels: Mapping[str, StoredChannel] = {}
        self.count = 0

    def opened(self, channels: Mapping[str, StoredChannel]) -> IncidentTally:
        """This one, for incidents of these topics."""
        self._channels = channels
        return self

    def begin(self, incident: Incident, past: Past) -> None:
        """As ``IncidentSink``."""
        self.count += 1
        if len(self._tallies) < self._most:
            tally = self._tallies[incident] = _Tally(record=first_record(incident, past.latched))
            for message in (*past.latched, *past.messages):
                tally.add(message)

    def extend(self, incident: Incident, trigger: Trigger, to_ns: int, past: Past) -> None:
        """As ``IncidentSink``."""
        if incident in self._tallies:
            tally = self._tallies[incident]
            tally.record = tally.record.extended(trigger.stamp_ns, trigger.values, to_ns)
            for message in past.messages:
                tally.add(message)

    def write(self, message: SourceMessage, incidents: Sequence[Incident]) -> None:
        """As ``IncidentSink``."""
        for incident in incidents:
            if incident in self._tallies:
                self._tallies[incident].add(message)

    def end(self, incident: Incident, missing: Sequence[Missing]) -> None:
        """As ``IncidentSink``."""
        if incident in self._tallies:
            tally = self._tallies[incident]
            tally.record = replace(tally.record, missing=tuple(missing))

    def incidents(self, start_ns: int) -> tuple[TryIncident, ...]:
        """Incidents that were counted, in the order in which they began, in a recording that starts then."""
        return tuple(
            TryIncident(
                number=number,
                t=(tally.record.triggered_ns - start_ns) / NS_PER_S,
                record=record_holding(tally.record, tally.messages, tally.size_bytes, self._channels),
            )
            for number, tally in enumerate(self._tallies.values())
        )
