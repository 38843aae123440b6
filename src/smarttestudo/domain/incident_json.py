# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""The record of an incident as a JSON object."""

from __future__ import annotations

import json
import math
from collections.abc import Callable, Mapping
from typing import TypeVar

from smarttestudo.domain.errors import RecordingError
from smarttestudo.domain.incident import (
    INCIDENT_VERSION,
    IncidentRecord,
    IncidentTopic,
    LatchedSample,
    Missing,
    MissingReason,
)
from smarttestudo.domain.json_text import json_text
from smarttestudo.domain.units import LAST_STAMP_NS, utc_time

MAX_RECORD_BYTES = 4_000_000
_Item = TypeVar("_Item")


def incident_to_json(incident: IncidentRecord) -> dict[str, object]:
    """The object in ``incident.json``; times that end in ``_ns`` count from 1970."""
    return {
        "version": INCIDENT_VERSION,
        "name": incident.name,
        "rule": incident.rule,
        "file": incident.path,
        "line": incident.line,
        "time": utc_time(incident.triggered_ns),
        "triggered_ns": incident.triggered_ns,
        "from_ns": incident.from_ns,
        "to_ns": incident.to_ns,
        "values": dict(incident.values),
        "rules_sha256": incident.rules_sha256,
        "topics": {
            name: {"type": topic.type_name, "messages": topic.messages, "bytes": topic.size_bytes}
            for name, topic in incident.topics.items()
        },
        "latched": [{"topic": one.topic, "stamp_ns": one.stamp_ns} for one in incident.latched],
        "missing": [
            {
                "topic": one.topic,
                "reason": one.reason.value,
                "messages": one.messages,
                "from_ns": one.from_ns,
                "to_ns": one.to_ns,
            }
            for one in incident.missing
        ],
    }


def incident_text(incident: IncidentRecord) -> str:
    """What ``incident.json`` holds."""
    return f"{json_text(incident_to_json(incident), indent=2)}\n"


def read_incident(text: bytes, place: str) -> IncidentRecord:
    """The record that ``incident.json`` at ``place`` holds.

    Raises ``RecordingError`` for a text that is cut, edited or of another version.
    """
    try:
        found = _object(json.loads(text))
        version = found.get("version")
        if version != INCIDENT_VERSION:
            raise RecordingError(
                f"version {str(version)[:20]} of an incident is not known",
                place=place,
                remedy="read it with the SmartTestudo that wrote it",
            )
        return _incident(found)
    except (ValueError, KeyError, TypeError, OverflowError, RecursionError) as error:
        raise RecordingError(
            "does not hold the record of an incident", place=place, remedy="was it cut or edited?"
        ) from error


def _incident(found: Mapping[str, object]) -> IncidentRecord:
    values = _object(found["values"])
    from_ns, triggered_ns, to_ns = (_whole(found[key]) for key in ("from_ns", "triggered_ns", "to_ns"))
    if not from_ns <= triggered_ns <= to_ns:
        raise ValueError(triggered_ns)
    return IncidentRecord(
        name=_text(found["name"]),
        rule=_text(found["rule"]),
        path=_text(found["file"]),
        line=_whole(found["line"]),
        triggered_ns=triggered_ns,
        from_ns=from_ns,
        to_ns=to_ns,
        values={name: None if value is None else _number(value) for name, value in values.items()},
        rules_sha256=_text(found["rules_sha256"]),
        topics={name: _topic(_object(topic)) for name, topic in _object(found["topics"]).items()},
        latched=_list(found["latched"], _latched),
        missing=_list(found["missing"], _missing),
    )


def _topic(found: Mapping[str, object]) -> IncidentTopic:
    return IncidentTopic(
        type_name=_text(found["type"]),
        messages=_whole(found["messages"]),
        size_bytes=_whole(found["bytes"]),
    )


def _latched(found: Mapping[str, object]) -> LatchedSample:
    return LatchedSample(topic=_text(found["topic"]), stamp_ns=_whole(found["stamp_ns"]))


def _missing(found: Mapping[str, object]) -> Missing:
    count = found["messages"]
    return Missing(
        topic=_text(found["topic"]),
        reason=MissingReason(found["reason"]),
        messages=None if count is None else _whole(count),
        from_ns=_whole(found["from_ns"]),
        to_ns=_whole(found["to_ns"]),
    )


def _object(value: object) -> Mapping[str, object]:
    if not isinstance(value, dict):
        raise TypeError(value)
    return value


def _list(value: object, item: Callable[[Mapping[str, object]], _Item]) -> tuple[_Item, ...]:
    if not isinstance(value, list):
        raise TypeError(value)
    return tuple(item(_object(one)) for one in value)


def _text(value: object) -> str:
    if not isinstance(value, str):
        raise TypeError(value)
    return value


def _whole(value: object) -> int:
    if not isinstance(value, int) or isinstance(value, bool) or abs(value) > LAST_STAMP_NS:
        raise TypeError(value)
    return value


def _number(value: object) -> float:
    if not isinstance(value, int | float) or isinstance(value, bool) or not math.isfinite(value):
        raise TypeError(value)
    return value
