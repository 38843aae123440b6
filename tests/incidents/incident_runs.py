# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""A recorder that is fed in virtual time, and what its incidents hold."""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass, field

from smarttestudo.domain.incident import Missing
from smarttestudo.domain.names import resolve_topic
from smarttestudo.domain.signal import Value
from smarttestudo.incidents.recorder import IncidentRecorder
from smarttestudo.incidents.sink import Incident, Past, Store
from smarttestudo.incidents.topic_ring import GivenUp, IncidentMessage, SourceMessage
from smarttestudo.language.parser import parse
from smarttestudo.language.rule_set import RuleSet, compile_rules
from smarttestudo.loop.step import Trigger

AMPLE_BYTES = 10_000_000


@dataclass
class Kept:
    """One incident as its sink was told of it; ``stamps_ns`` are its moments."""

    incident: Incident
    latched: list[SourceMessage]
    messages: list[IncidentMessage]
    given_up: dict[str, list[GivenUp]]
    stamps_ns: list[int]
    to_ns: int
    missing: tuple[Missing, ...] | None = None

    def take(self, past: Past) -> None:
        self.messages += past.messages
        for topic, given_up in past.given_up.items():
            self.given_up.setdefault(topic, []).extend(given_up)


@dataclass
class KeepingSink:
    """An ``IncidentSink`` that keeps everything."""

    kept: list[Kept] = field(default_factory=list)

    def begin(self, incident: Incident, past: Past) -> None:
        kept = Kept(incident, list(past.latched), [], {}, [incident.trigger.stamp_ns], incident.to_ns)
        kept.take(past)
        self.kept.append(kept)

    def extend(self, incident: Incident, trigger: Trigger, to_ns: int, past: Past) -> None:
        one = self._of(incident)
        assert one.missing is None
        one.stamps_ns.append(trigger.stamp_ns)
        one.to_ns = to_ns
        one.take(past)

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
        recorder.on_subscribed(topic, 0, transient_local=False)
    return recorder, sink


def trigger(
    rule_set: RuleSet, stamp_ns: int, block: int = 0, values: Mapping[str, Value | None] | None = None
) -> Trigger:
    return Trigger(stamp_ns=stamp_ns, block=rule_set.blocks[block], values=values or {})


def windows(begun_ms: Iterable[int], before_ms: int, after_ms: int) -> list[list[int]]:
    """The moments of each window that blocks open which begin to hold then: a naive second opinion."""
    found: list[list[int]] = []
    for at_ms in begun_ms:
        for moments_ms in found:
            is_open = at_ms <= moments_ms[-1] + max(after_ms, min(before_ms, 500))
            if is_open and at_ms + after_ms <= moments_ms[0] - before_ms + 10 * (before_ms + after_ms):
                moments_ms.append(at_ms)
                break
        else:
            found.append([at_ms])
    return found
