# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""What rules would have recorded of a bag, without writing it."""

from __future__ import annotations

from collections import Counter
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass, field

from msgspec import Struct

from smarttestudo.bags.mcap.record_bytes import StoredChannel
from smarttestudo.domain.incident import Missing
from smarttestudo.domain.units import BYTES_PER_KB, NS_PER_S
from smarttestudo.incidents.recorder import Incident
from smarttestudo.incidents.topic_ring import IncidentMessage, SourceMessage
from smarttestudo.ruler.answers.missing_messages import MissingMessages, missing_messages


class TryIncidentTopic(Struct, frozen=True, kw_only=True):
    """What would have been recorded of a topic."""

    topic: str
    messages: int
    size_kb: float


class TryIncident(Struct, frozen=True, kw_only=True):
    """What a ``Record`` would have kept, ``t`` seconds after the start: the ``number``-th, 0 first.

    ``title`` is its name, ``line`` its own, ``rule`` that of its block. The window is from ``before_s``
    before to ``after_s`` after that; sizes are those of the messages.
    """

    number: int
    t: float
    title: str
    rule: str
    line: int
    before_s: float
    after_s: float
    messages: int
    size_kb: float
    topics: tuple[TryIncidentTopic, ...]
    missing: tuple[MissingMessages, ...]


@dataclass(slots=True, kw_only=True)
class _Tally:
    """What one incident holds so far."""

    number: int
    incident: Incident
    messages: Counter[str] = field(default_factory=Counter)
    size_bytes: Counter[str] = field(default_factory=Counter)
    missing: Sequence[Missing] = ()

    def add(self, message: IncidentMessage) -> None:
        self.messages[message.topic] += 1
        self.size_bytes[message.topic] += len(message.payload)


class IncidentTally:
    """An ``IncidentSink`` that counts, and keeps no message: of the first ``most`` incidents."""

    def __init__(self, most: int) -> None:
        self._most = most
        self._tallies: dict[Incident, _Tally] = {}
        self.count = 0

    def opened(self, _channels: Mapping[str, StoredChannel]) -> IncidentTally:
        """This one, whatever the topics are."""
        return self

    def begin(
        self, incident: Incident, latched: Sequence[SourceMessage], messages: Iterable[IncidentMessage]
    ) -> None:
        """As ``IncidentSink``."""
        self.count += 1
        if len(self._tallies) < self._most:
            tally = self._tallies[incident] = _Tally(number=self.count - 1, incident=incident)
            for message in (*latched, *messages):
                tally.add(message)

    def write(self, message: SourceMessage, incidents: Sequence[Incident]) -> None:
        """As ``IncidentSink``."""
        for incident in incidents:
            if incident in self._tallies:
                self._tallies[incident].add(message)

    def end(self, incident: Incident, missing: Sequence[Missing]) -> None:
        """As ``IncidentSink``."""
        if incident in self._tallies:
            self._tallies[incident].missing = missing

    def incidents(self, start_ns: int) -> tuple[TryIncident, ...]:
        """What was counted, in the order in which it began, in a recording that starts then."""
        return tuple(_told(tally, start_ns) for tally in self._tallies.values())


def _told(tally: _Tally, start_ns: int) -> TryIncident:
    trigger, recording = tally.incident.trigger, tally.incident.recording
    return TryIncident(
        number=tally.number,
        t=(trigger.stamp_ns - start_ns) / NS_PER_S,
        title=recording.name,
        rule=trigger.block.label,
        line=recording.line,
        before_s=recording.before_ns / NS_PER_S,
        after_s=recording.after_ns / NS_PER_S,
        messages=tally.messages.total(),
        size_kb=tally.size_bytes.total() / BYTES_PER_KB,
        topics=tuple(
            TryIncidentTopic(
                topic=topic,
                messages=tally.messages[topic],
                size_kb=tally.size_bytes[topic] / BYTES_PER_KB,
            )
            for topic in sorted({*recording.topics, *tally.messages})
        ),
        missing=missing_messages(tally.missing, trigger.stamp_ns),
    )
