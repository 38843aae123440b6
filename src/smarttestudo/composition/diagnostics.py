# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""A runtime's status as diagnostics, with the keys of NVIDIA's greenwave_monitor."""

from __future__ import annotations

from collections.abc import Mapping

from smarttestudo.composition.live_status import TOLERANCE_PERCENT
from smarttestudo.domain.diagnostic import Diagnostic, DiagnosticLevel
from smarttestudo.domain.rate import Rate
from smarttestudo.domain.status import RuntimeStatus, Silence, TopicStatus

_UNKNOWN = "N/A"
_LEVELS = {
    Silence.OFF: DiagnosticLevel.OK,
    Silence.NO_PUBLISHER: DiagnosticLevel.STALE,
    Silence.CANNOT_RELAY: DiagnosticLevel.ERROR,
    Silence.NO_SUBSCRIBER: DiagnosticLevel.OK,
    Silence.INCOMPATIBLE_QOS: DiagnosticLevel.WARN,
    Silence.NO_MESSAGE: DiagnosticLevel.OK,
    Silence.SOURCE_SILENT: DiagnosticLevel.STALE,
}


def diagnostics(status: RuntimeStatus) -> list[Diagnostic]:
    """One for the node, then one for each topic, under the name of its output."""
    return [_of_node(status), *(_of_topic(status, source) for source in status.topics)]


def _of_node(status: RuntimeStatus) -> Diagnostic:
    level, message = _node_health(status)
    return Diagnostic(
        name=status.node.lstrip("/"),
        level=level,
        message=message,
        hardware_id=status.node,
        values={
            "rules": ", ".join(status.rules.paths),
            "rules_sha256": status.rules.sha256,
            "topics": str(len(status.topics)),
            "in_kb_per_s": _number(status.in_kb_per_s),
            "out_kb_per_s": _number(status.out_kb_per_s),
            "budget_kb_per_s": "none" if status.budget_kb_per_s is None else _number(status.budget_kb_per_s),
            "cpu_percent": _number(status.cpu_percent),
            "memory_mb": _number(status.memory_mb),
        },
    )


def _node_health(status: RuntimeStatus) -> tuple[DiagnosticLevel, str]:
    if status.floors_break_budget:
        return DiagnosticLevel.ERROR, "the floors alone are more than the budget"
    if status.is_fallback:
        return DiagnosticLevel.WARN, "no valid rules: everything is relayed at full rate"
    return DiagnosticLevel.OK, f"relaying {len(status.topics)} topics"


def _of_topic(status: RuntimeStatus, source: str) -> Diagnostic:
    topic = status.topics[source]
    level, message = _topic_health(topic)
    return Diagnostic(
        name=topic.output,
        level=level,
        message=message,
        hardware_id=status.node,
        values={**_greenwave_values(topic), **_own_values(source, topic)},
    )


def _topic_health(topic: TopicStatus) -> tuple[DiagnosticLevel, str]:
    if topic.silence is not None:
        return _LEVELS[topic.silence], topic.problem or topic.silence.value
    if topic.incompatible:
        return DiagnosticLevel.WARN, f"incompatible QoS: {', '.join(topic.incompatible)}"
    if not topic.keeps_rate:
        return DiagnosticLevel.WARN, f"the rate is {topic.error_percent:+.1f} % off"
    return DiagnosticLevel.OK, "OK"


def _greenwave_values(topic: TopicStatus) -> Mapping[str, str]:
    """What its user interfaces read; N/A is their word too."""
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
        "source_hz": _number(topic.source_hz),
        "target": str(Rate(topic.target_hz)),
        "error_percent": _number(topic.error_percent),
        "in_kb_per_s": _number(topic.in_kb_per_s),
        "out_kb_per_s": _number(topic.out_kb_per_s),
        "reason": topic.reason.value,
        "rule": topic.rule or "",
        "publishers": str(topic.publishers),
        "subscribers": str(topic.subscribers),
        "dropped": str(topic.counts.dropped),
        "repeated": str(topic.counts.repeated),
        "undecodable": str(topic.counts.undecodable),
    }


def _number(number: float | None) -> str:
    return _UNKNOWN if number is None else f"{number:.3f}"
