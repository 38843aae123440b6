# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""Incidents that rules would have recorded of a bag, without writing them."""

from __future__ import annotations

from collections import Counter
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field, replace

from smarttestudo.bags.mcap.record_bytes import StoredChannel
from smarttestudo.domain.incident import IncidentRecord, Missing
from smarttestudo.domain.units import NS_PER_S
from smarttestudo.incidents.folder import first_record, record_holding
from smarttestudo.incidents.sink import Incident, Past
from smarttestudo.incidents.topic_ring import IncidentMessage, SourceMessage
from smarttestudo.loop.step import Trigger


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
