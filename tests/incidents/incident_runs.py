# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""A recorder that is fed in virtual time, and what its incidents hold."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from dataclasses import dataclass, field

from smarttestudo.domain.incident import Missing
from smarttestudo.domain.names import resolve_topic
from smarttestudo.incidents.recorder import Incident, IncidentRecorder, Store
from smarttestudo.incidents.topic_ring import IncidentMessage, SourceMessage
from smarttestudo.language.parser import parse
from smarttestudo.language.rule_set import RuleSet, compile_rules
from smarttestudo.loop.step import Trigger

AMPLE_BYTES = 10_000_000


@dataclass
class Kept:
    """One incident as its sink was told of it."""

    incident: Incident
    latched: list[SourceMessage]
    messages: list[IncidentMessage]
    missing: tuple[Missing, ...] | None = None


@dataclass
class KeepingSink:
    """An ``IncidentSink`` that keeps everything."""

    kept: list[Kept] = field(default_factory=list)

    def begin(
        self, incident: Incident, latched: Sequence[SourceMessage], messages: Iterable[IncidentMessage]
    ) -> None:
        self.kept.append(Kept(incident, list(latched), list(messages)))

    def write(self, message: SourceMessage, incidents: Sequence[Incident]) -> None:
        for incident in incidents:
            one = self._of(incident)
            assert one.missing is None
            one.messages.append(message)

    def end(self, incident: Incident, missing: Sequence[Missing]) -> None:
        self._of(incident).missing = tuple(missing)

    def _of(self, incident: Incident) -> Kept:
        return next(one for one in self.kept if one.incident is incident)


def rules_of(text: str) -> RuleSet:
    result = parse(f"begin\n{text}\nend\n", "rules.adirf")
    assert result.findings == ()
    return compile_rules([result.file], resolve_topic)


def recording_rules(*records: str) -> RuleSet:
    lines = "\n".join(records)
    return rules_of(f"If CheckValue /odom speed > 1 Then\n{lines}\nSetFrequency /scan 5\nEndIf")


def recorder_for(
    rule_set: RuleSet,
    *,
    memory_bytes: int = AMPLE_BYTES,
    topics: Sequence[str] = ("/odom", "/scan"),
    store: Store | None = None,
) -> tuple[IncidentRecorder, KeepingSink]:
    sink = KeepingSink()
    recorder = IncidentRecorder(rule_set, sink, memory_bytes, 0, store=store)
    for topic in topics:
        recorder.hear(topic, 0, transient_local=False)
    return recorder, sink


def trigger(rule_set: RuleSet, stamp_ns: int) -> Trigger:
    return Trigger(stamp_ns=stamp_ns, block=rule_set.blocks[0], values={})
