# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""A runtime's status as JSON, there and back: in few bytes, since it goes over the robot's radio."""

from __future__ import annotations

import json
import math

from smarttestudo.domain.block_status_json import block_to_json, blocks_from_json
from smarttestudo.domain.decision import BoundReason, Reason
from smarttestudo.domain.incident import IncidentState
from smarttestudo.domain.json_record import JsonRecord
from smarttestudo.domain.link_state import AcceptedTopic, LinkState, StreamCounts, TopicOnLink
from smarttestudo.domain.status import (
    RulesInForce,
    RulesOrigin,
    RuntimeStatus,
    Silence,
    TopicCounts,
    TopicStatus,
)


def status_to_json(status: RuntimeStatus) -> dict[str, object]:
    """The object on ``/testudo/status``. Rates of Full are ``null``, as in decisions."""
    return {
        **({"robot": status.robot} if status.robot else {}),
        "node": status.node,
        "stamp_ns": status.stamp_ns,
        "uptime_s": round(status.uptime_s, 3),
        "status_hz": _rounded(status.status_hz),
        "rules": _rules_to_json(status.rules),
        "fallback": status.is_fallback,
        "budget_kb_per_s": status.budget_kb_per_s,
        "floors_break_budget": status.floors_break_budget,
        "in_kb_per_s": _rounded(status.in_kb_per_s),
        "out_kb_per_s": _rounded(status.out_kb_per_s),
        "cpu_percent": _rounded(status.cpu_percent),
        "memory_mb": _rounded(status.memory_mb),
        "topics": {source: _topic_to_json(topic) for source, topic in status.topics.items()},
        "blocks": [block_to_json(block) for block in status.blocks],
        **({} if status.link is None else {"link": _link_to_json(status.link)}),
        **(
            {"accepted": {one.topic: _accepted_to_json(one) for one in status.accepted}}
            if status.accepted
            else {}
        ),
        **({} if status.incidents is None else {"incidents": _incidents_to_json(status.incidents)}),
    }


def status_from_text(text: str) -> RuntimeStatus:
    """The status that ``text`` holds; ``ValueError`` where it is none, or one of another version.

    What an older version does not say is as it was then; what a newer one adds is left out.
    """
    try:
        record = json.loads(text)
    except RecursionError as error:
        raise ValueError(str(error)) from error
    return status_from_json(record)


def status_from_json(value: object) -> RuntimeStatus:
    """The status that a stranger's JSON value holds; ``ValueError`` as from ``status_from_text``."""
    try:
        record = JsonRecord(value)
        return RuntimeStatus(
            node=record.text("node"),
            stamp_ns=record.integer("stamp_ns"),
            uptime_s=record.number("uptime_s"),
            rules=_rules(record.record("rules")),
            budget_kb_per_s=record.optional(record.number, "budget_kb_per_s"),
            floors_break_budget=record.flag("floors_break_budget"),
            cpu_percent=record.optional(record.number, "cpu_percent"),
            memory_mb=record.optional(record.number, "memory_mb"),
            topics={
                source: _topic(JsonRecord(topic)) for source, topic in record.record("topics").entries.items()
            },
            status_hz=record.optional(record.number, "status_hz") or 1.0,
            blocks=blocks_from_json(record.entries.get("blocks")),
            link=_link(record.optional(record.record, "link")),
            robot=record.optional(record.text, "robot") or "",
            accepted=_accepted(record.optional(record.record, "accepted")),
            incidents=_incidents(record.optional(record.record, "incidents")),
        )
    except TypeError as error:
        raise ValueError(str(error)) from error


def _rules_to_json(rules: RulesInForce) -> dict[str, object]:
    return {
        "files": list(rules.paths),
        "sha256": rules.sha256,
        "origin": rules.origin.value,
        "waits_s": _rounded(rules.waits_s),
    }


def _link_to_json(link: LinkState) -> dict[str, object]:
    return {
        "connected": link.is_connected,
        "capacity_kb_per_s": _rounded(link.capacity_kb_per_s),
        "round_trip_ms": _rounded(link.round_trip_ms),
        "outages": link.outages,
    }


def _link(record: JsonRecord | None) -> LinkState | None:
    if record is None:
        return None
    return LinkState(
        is_connected=record.flag("connected"),
        capacity_kb_per_s=record.optional(record.number, "capacity_kb_per_s"),
        round_trip_ms=record.optional(record.number, "round_trip_ms"),
        outages=record.integer("outages"),
    )


def _accepted_to_json(topic: AcceptedTopic) -> dict[str, object]:
    return {
        "type": topic.type_name,
        "problem": topic.problem,
        "received": topic.received,
        "delivered": topic.delivered,
        "too_old": topic.too_old,
        "refused": topic.refused,
        "age_ms": _rounded(topic.age_ms),
    }


def _accepted(record: JsonRecord | None) -> tuple[AcceptedTopic, ...]:
    records = () if record is None else ((name, JsonRecord(one)) for name, one in record.entries.items())
    return tuple(
        AcceptedTopic(
            topic=name,
            type_name=one.optional(one.text, "type"),
            problem=one.optional(one.text, "problem"),
            received=one.integer("received"),
            delivered=one.integer("delivered"),
            too_old=one.integer("too_old"),
            refused=one.integer("refused"),
            age_ms=one.optional(one.number, "age_ms"),
        )
        for name, one in records
    )


def _incidents_to_json(state: IncidentState) -> dict[str, object]:
    return {
        "held_bytes": state.held_bytes,
        "memory_bytes": state.memory_bytes,
        "topics": state.topics,
        "open": state.open,
        "recorded": state.recorded,
        "failed": state.failed,
        "problem": state.problem,
        "ring_bytes": state.ring_bytes,
        "ring_max_bytes": state.ring_max_bytes,
    }


def _incidents(record: JsonRecord | None) -> IncidentState | None:
    if record is None:
        return None
    return IncidentState(
        held_bytes=record.integer("held_bytes"),
        memory_bytes=record.integer("memory_bytes"),
        topics=record.integer("topics"),
        open=record.integer("open"),
        recorded=record.integer("recorded"),
        failed=record.integer("failed"),
        problem=record.optional(record.text, "problem"),
        ring_bytes=record.optional(record.integer, "ring_bytes") or 0,
        ring_max_bytes=record.optional(record.integer, "ring_max_bytes"),
    )


def _on_link_to_json(topic: TopicOnLink) -> dict[str, object]:
    counts = topic.counts
    return {
        "age_ms": _rounded(topic.age_ms),
        "sent": counts.sent,
        "replaced": counts.replaced,
        "overflowed": counts.overflowed,
        "losing": counts.is_losing,
        "queued_bytes": counts.queued_bytes,
    }


def _on_link(record: JsonRecord | None) -> TopicOnLink | None:
    if record is None:
        return None
    overflowed, is_losing = record.integer("overflowed"), record.optional(record.flag, "losing")
    counts = StreamCounts(
        sent=record.integer("sent"),
        replaced=record.integer("replaced"),
        overflowed=overflowed,
        is_losing=overflowed > 0 if is_losing is None else is_losing,
        queued_bytes=record.integer("queued_bytes"),
    )
    return TopicOnLink(counts=counts, age_ms=record.optional(record.number, "age_ms"))


def _topic_to_json(topic: TopicStatus) -> dict[str, object]:
    counts = topic.counts
    return {
        "output": topic.output,
        "type": topic.type_name,
        "source_hz": _rounded(topic.source_hz),
        "target_hz": None if math.isinf(topic.target_hz) else topic.target_hz,
        "expected_hz": _rounded(topic.expected_hz),
        "actual_hz": _rounded(topic.actual_hz),
        "error_percent": _rounded(topic.error_percent),
        "keeps_rate": topic.keeps_rate,
        "stamped_hz": _rounded(topic.stamped_hz),
        "delay_ms": _rounded(topic.delay_ms),
        "in_kb_per_s": _rounded(topic.in_kb_per_s),
        "out_kb_per_s": _rounded(topic.out_kb_per_s),
        "reason": topic.reason.value,
        "rule": topic.rule,
        "line": topic.line,
        "publishers": topic.publishers,
        "subscribers": topic.subscribers,
        "incompatible": list(topic.incompatible),
        "problem": topic.problem,
        "silent": None if topic.silence is None else topic.silence.value,
        "received": counts.received,
        "relayed": counts.relayed,
        "dropped": counts.dropped,
        "repeated": counts.repeated,
        "discarded": counts.discarded,
        "undecodable": counts.undecodable,
        **({} if topic.frames is None else {"frames": topic.frames}),
        **({} if topic.on_link is None else {"link": _on_link_to_json(topic.on_link)}),
        **({"within": dict(topic.within)} if topic.within else {}),
        **_bound_reasons_to_json(topic),
    }


def _bound_reasons_to_json(topic: TopicStatus) -> dict[str, object]:
    reasons = {name: one.to_json() for name, one in topic.bound_reasons.items()}
    return {"bound_reasons": reasons} if reasons else {}


def _rounded(number: float | None) -> float | None:
    return None if number is None else round(number, 3)


def _rules(record: JsonRecord) -> RulesInForce:
    named = record.entries.get("origin")
    return RulesInForce(
        paths=record.texts("files"),
        sha256=record.text("sha256"),
        origin=next((origin for origin in RulesOrigin if origin.value == named), RulesOrigin.FILES),
        waits_s=record.optional(record.number, "waits_s"),
    )


def _topic(record: JsonRecord) -> TopicStatus:
    def optional_number(name: str) -> float | None:
        return record.optional(record.number, name)

    target_hz, silence = optional_number("target_hz"), record.optional(record.text, "silent")
    return TopicStatus(
        output=record.text("output"),
        type_name=record.optional(record.text, "type"),
        reason=Reason(record.text("reason")),
        rule=record.optional(record.text, "rule"),
        line=record.optional(record.integer, "line"),
        target_hz=math.inf if target_hz is None else target_hz,
        source_hz=optional_number("source_hz"),
        expected_hz=optional_number("expected_hz"),
        actual_hz=optional_number("actual_hz"),
        error_percent=optional_number("error_percent"),
        keeps_rate=record.flag("keeps_rate"),
        stamped_hz=optional_number("stamped_hz"),
        delay_ms=optional_number("delay_ms"),
        in_kb_per_s=record.number("in_kb_per_s"),
        out_kb_per_s=record.number("out_kb_per_s"),
        publishers=record.integer("publishers"),
        subscribers=record.integer("subscribers"),
        incompatible=record.texts("incompatible"),
        problem=record.optional(record.text, "problem"),
        silence=None if silence is None else Silence(silence),
        counts=TopicCounts(
            received=record.integer("received"),
            relayed=record.integer("relayed"),
            repeated=record.integer("repeated"),
            discarded=record.integer("discarded"),
            undecodable=record.integer("undecodable"),
        ),
        frames=record.optional(record.integer, "frames"),
        on_link=_on_link(record.optional(record.record, "link")),
        within=_within(record.optional(record.record, "within")),
        bound_reasons=_bound_reasons(record.optional(record.record, "bound_reasons")),
    )


def _within(record: JsonRecord | None) -> dict[str, float]:
    return {} if record is None else {name: record.number(name) for name in record.entries}


def _bound_reasons(record: JsonRecord | None) -> dict[str, BoundReason]:
    if record is None:
        return {}
    return {name: _bound_reason(record.record(name)) for name in record.entries}


def _bound_reason(record: JsonRecord) -> BoundReason:
    return BoundReason(
        reason=Reason(record.text("reason")),
        rule=record.optional(record.text, "rule"),
        line=record.optional(record.integer, "line"),
    )
