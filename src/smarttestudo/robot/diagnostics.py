# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""A runtime's status in words, and as diagnostics with the keys of NVIDIA's greenwave_monitor."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

from smarttestudo.domain.action import Notice
from smarttestudo.domain.health import robot_health, topic_health
from smarttestudo.domain.incident import IncidentState
from smarttestudo.domain.link import CommandTopic
from smarttestudo.domain.metric import metered_fields
from smarttestudo.domain.rate import Rate
from smarttestudo.domain.record import to_json
from smarttestudo.domain.robot import Diagnostic, DiagnosticLevel
from smarttestudo.domain.status import RuntimeStatus, TopicStatus
from smarttestudo.domain.texts import visible
from smarttestudo.domain.units import BYTES_PER_MB, counted, grouped, utc_time
from smarttestudo.robot.status import TOLERANCE_PERCENT

_UNKNOWN = "N/A"


def diagnostics(status: RuntimeStatus) -> list[Diagnostic]:
    """One for the node, one for each topic, under the name of its output, and one for each notice."""
    topics = (_of_topic(status, source) for source in status.topics)
    return [_of_node(status), *topics, *(_of_notice(status, notice) for notice in status.notices)]


def _of_node(status: RuntimeStatus) -> Diagnostic:
    health = robot_health(status)
    return Diagnostic(
        name=status.node.lstrip("/"),
        level=health.level,
        message=health.message,
        hardware_id=status.node,
        values={
            "rules": ", ".join(status.rules.paths),
            "rules_sha256": status.rules.sha256,
            "rules_origin": status.rules.origin.value,
            "rules_problem": status.rules.problem or "",
            "topics": str(len(status.topics)),
            "in_kb_per_s": _number(status.in_kb_per_s),
            "out_kb_per_s": _number(status.out_kb_per_s),
            **_numbers(status),
            **({"budget_kb_per_s": "none"} if status.budget_kb_per_s is None else {}),
            **{
                key: value
                for name, section in _sections(status).items()
                for key, value in _section_values(name, section).items()
            },
        },
    )


def _sections(status: RuntimeStatus) -> Mapping[str, object]:
    """The records of a status by name, those of its parts last."""
    own = {"link": status.link, "incidents": status.incidents}
    return {**{name: section for name, section in own.items() if section is not None}, **status.sections}


def _section_values(name: str, section: object) -> Mapping[str, str]:
    """The entries of a record, each under the section's name and its own."""
    return {f"{name}_{key}": _said(value) for key, value in to_json(section).items()}


def _numbers(record: Any) -> Mapping[str, str]:
    """The numbers of a record itself that are metrics, too, by their names in JSON."""
    kind: Any = type(record)
    fields = ((one.keys, one.read(record)) for one in metered_fields(kind))
    return {keys[0]: _said(value) for keys, value in fields if len(keys) == 1}


def _said(value: object) -> str:
    if isinstance(value, bool):
        return str(value).lower()
    return _number(value) if value is None or isinstance(value, float) else str(value)


def _of_topic(status: RuntimeStatus, source: str) -> Diagnostic:
    topic = status.topics[source]
    link = topic.on_link
    health = topic_health(topic)
    return Diagnostic(
        name=topic.output,
        level=health.level,
        message=health.message,
        hardware_id=status.node,
        values={
            **_greenwave_values(topic),
            **_own_values(source, topic),
            **({} if link is None else {f"link_{key}": value for key, value in _numbers(link).items()}),
        },
    )


def _of_notice(status: RuntimeStatus, notice: Notice) -> Diagnostic:
    """A text that a rule notifies of now; it may be anything."""
    rule = visible(notice.rule or "")
    return Diagnostic(
        name=f"{status.node.lstrip('/')}: {rule}",
        level=DiagnosticLevel.WARN,
        message=visible(notice.text),
        hardware_id=status.node,
        values={"rule": rule, "since": utc_time(notice.since_ns)},
    )


def accepted_text(topic: CommandTopic) -> str:
    """State of a topic that is accepted of operators."""
    if topic.problem is not None:
        return topic.problem
    if topic.type_name is None:
        return "no node subscribes to it"
    age = "" if topic.age_ms is None else f", the last {topic.age_ms:.0f} ms old"
    return (
        f"{grouped(topic.delivered)} delivered, {grouped(topic.too_old)} too old, "
        f"{grouped(topic.refused)} refused{age}"
    )


def recording_text(state: IncidentState) -> str:
    """Messages held for incidents, and the incidents so far."""
    held, limit = state.held_bytes / BYTES_PER_MB, state.memory_bytes / BYTES_PER_MB
    ring = ""
    if state.ring_max_bytes is not None:
        on_disk, most = state.ring_bytes / BYTES_PER_MB, state.ring_max_bytes / BYTES_PER_MB
        ring = f", on disk {grouped(on_disk, 1)} of {grouped(most)} MB"
    further = f", {counted(state.further_moments, 'further moment')}" if state.further_moments else ""
    failed = f", {state.failed} failed" if state.failed else ""
    problem = f": {state.problem}" if state.problem else ""
    missing = f", {counted(state.missing, 'message')} missing" if state.missing else ""
    dropped = f", {counted(state.dropped, 'message')} faster than the disk" if state.dropped else ""
    return (
        f"{counted(state.topics, 'topic')} in {grouped(held, 1)} of {grouped(limit)} MB{ring}; "
        f"incidents: {state.open} open, {state.recorded} recorded{further}{failed}{missing}{dropped}{problem}"
    )


def _greenwave_values(topic: TopicStatus) -> Mapping[str, str]:
    """The keys that its user interfaces read; they use N/A too."""
    return {
        "frame_rate_node": _number(topic.actual_hz),
        "frame_rate_msg": _number(topic.stamped_hz),
        "current_delay_from_realtime_ms": _number(topic.delay_ms),
        "expected_frequency": _number(topic.expected_hz),
        "tolerance": _number(TOLERANCE_PERCENT),
    }


def _own_values(source: str, topic: TopicStatus) -> Mapping[str, str]:
    return {
        "source": source,
        "target": str(Rate(topic.target_hz)),
        "error_percent": _number(topic.error_percent),
        "reason": topic.reason.value,
        "rule": topic.rule or "",
        "publishers": str(topic.publishers),
        "subscribers": str(topic.subscribers),
        **_numbers(topic),
        **({} if topic.doubt is None else {"doubt": topic.doubt.value}),
    }


def _number(number: float | None) -> str:
    return _UNKNOWN if number is None else f"{number:.3f}"
