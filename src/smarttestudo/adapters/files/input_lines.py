# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""An input of the loop as a JSON object."""

from __future__ import annotations

from base64 import b64decode, b64encode
from collections.abc import Callable, Mapping
from typing import Any

from smarttestudo.domain.observation import SourceChanged
from smarttestudo.pacing.sample import WhenSlow
from smarttestudo.runtime.inputs import (
    BudgetInput,
    LoopInput,
    MessageInput,
    RulesInput,
    SourceInput,
    WakeInput,
)


def input_to_json(given: LoopInput) -> dict[str, object]:
    """The object of one line; what is absent or usual has no key."""
    match given:
        case MessageInput():
            return {"event": "message", "stamp_ns": given.stamp_ns, **_message(given)}
        case WakeInput():
            return {"event": "wake", "stamp_ns": given.stamp_ns}
        case SourceInput(change=change):
            return {
                "event": "source",
                "stamp_ns": given.stamp_ns,
                "topic": change.topic,
                "publishers": change.publishers,
                "transient_local": change.transient_local,
                "type": change.type_name,
            }
        case BudgetInput():
            return {"event": "budget", "stamp_ns": given.stamp_ns, "budget_kb_per_s": given.budget_kb_per_s}
        case RulesInput():
            return {
                "event": "rules",
                "stamp_ns": given.stamp_ns,
                "rules": dict(given.rule_texts),
                "profile": given.profile_text,
                "names": dict(given.names),
                "when_slow": given.when_slow.value,
                "budget_kb_per_s": given.budget_kb_per_s,
                "relay_all": given.relay_all,
            }


def _message(given: MessageInput) -> dict[str, object]:
    record: dict[str, object] = {"topic": given.topic, "size_bytes": given.size_bytes}
    if given.payload is not None:
        record["payload"] = b64encode(given.payload).decode("ascii")
    if not given.decodable:
        record["decodable"] = False
    if given.publisher is not None:
        record["publisher"] = given.publisher
    return record


def input_from_json(record: Mapping[str, Any]) -> LoopInput:
    """The input of one line. Raises ``ValueError``, ``TypeError`` or ``LookupError`` where it is none."""
    readers: dict[str, Callable[[Mapping[str, Any]], LoopInput]] = {
        "message": _read_message,
        "wake": lambda record: WakeInput(stamp_ns=int(record["stamp_ns"])),
        "source": _read_source,
        "budget": lambda record: BudgetInput(
            stamp_ns=int(record["stamp_ns"]), budget_kb_per_s=float(record["budget_kb_per_s"])
        ),
        "rules": _read_rules,
    }
    return readers[record["event"]](record)


def _read_message(record: Mapping[str, Any]) -> MessageInput:
    payload = record.get("payload")
    return MessageInput(
        stamp_ns=int(record["stamp_ns"]),
        topic=str(record["topic"]),
        size_bytes=int(record["size_bytes"]),
        payload=None if payload is None else b64decode(payload, validate=True),
        decodable=bool(record.get("decodable", True)),
        publisher=record.get("publisher"),
    )


def _read_source(record: Mapping[str, Any]) -> SourceInput:
    change = SourceChanged(
        topic=str(record["topic"]),
        publishers=int(record["publishers"]),
        transient_local=bool(record["transient_local"]),
        type_name=str(record["type"]),
    )
    return SourceInput(stamp_ns=int(record["stamp_ns"]), change=change)


def _read_rules(record: Mapping[str, Any]) -> RulesInput:
    budget_kb_per_s, relay_all = record["budget_kb_per_s"], record["relay_all"]
    return RulesInput(
        stamp_ns=int(record["stamp_ns"]),
        rule_texts={str(path): str(text) for path, text in record["rules"].items()},
        profile_text=record["profile"],
        names={str(name): str(full) for name, full in record["names"].items()},
        when_slow=WhenSlow(record["when_slow"]),
        budget_kb_per_s=None if budget_kb_per_s is None else float(budget_kb_per_s),
        relay_all=None if relay_all is None else tuple(map(str, relay_all)),
    )
