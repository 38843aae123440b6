# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""An input of the loop as a JSON object."""

from __future__ import annotations

from base64 import b64decode, b64encode
from collections.abc import Callable, Mapping
from typing import Any

from smarttestudo.domain.observation import (
    LinkBudget,
    ListenersChanged,
    ReceiversReckon,
    SourceChanged,
    Undecodable,
)
from smarttestudo.loop.inputs import (
    ChangeInput,
    MessageInput,
    RecordedInput,
    RuleTextsInput,
    WakeInput,
)
from smarttestudo.pacing.sample import WhenSlow


def input_to_json(given: RecordedInput) -> dict[str, object]:
    """The object of one line; what is absent or usual has no key."""
    match given:
        case MessageInput():
            return {"event": "message", "stamp_ns": given.stamp_ns, **_message(given)}
        case WakeInput():
            return {"event": "wake", "stamp_ns": given.stamp_ns}
        case ChangeInput():
            return _change(given)
        case RuleTextsInput():
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


def _change(given: ChangeInput) -> dict[str, object]:
    stamp_ns = given.stamp_ns
    match given.change:
        case SourceChanged() as source:
            return {
                "event": "source",
                "stamp_ns": stamp_ns,
                "topic": source.topic,
                "publishers": source.publishers,
                "transient_local": source.transient_local,
                "type": source.type_name,
            }
        case ListenersChanged(topic=topic, are_there=are_there):
            return {"event": "listeners", "stamp_ns": stamp_ns, "topic": topic, "are_there": are_there}
        case LinkBudget(link_kb_per_s=budget_kb_per_s, is_measured=is_measured):
            record: dict[str, object] = {"event": "budget", "stamp_ns": stamp_ns}
            record["budget_kb_per_s"] = budget_kb_per_s
            return record | {"measured": True} if is_measured else record
        case ReceiversReckon(topics=topics):
            return {"event": "reckoned", "stamp_ns": stamp_ns, "topics": sorted(topics)}


def _message(given: MessageInput) -> dict[str, object]:
    record: dict[str, object] = {"topic": given.topic, "size_bytes": given.size_bytes}
    if payload := given.payload[:]:
        record["payload"] = b64encode(payload).decode("ascii")
    if isinstance(given.message, Undecodable):
        record["decodable"] = False
    if given.publisher is not None:
        record["publisher"] = given.publisher
    return record


def input_from_json(record: Mapping[str, Any]) -> RecordedInput:
    """The input of one line. Raises ``ValueError``, ``TypeError`` or ``LookupError`` where it is none."""
    readers: dict[str, Callable[[Mapping[str, Any]], RecordedInput]] = {
        "message": _read_message,
        "wake": lambda record: WakeInput(stamp_ns=int(record["stamp_ns"])),
        "source": _read_source,
        "listeners": _read_listeners,
        "budget": _read_budget,
        "reckoned": _read_reckoned,
        "rules": _read_rules,
    }
    return readers[record["event"]](record)


def _read_message(record: Mapping[str, Any]) -> MessageInput:
    return MessageInput(
        stamp_ns=int(record["stamp_ns"]),
        topic=str(record["topic"]),
        size_bytes=int(record["size_bytes"]),
        payload=b64decode(record.get("payload", ""), validate=True),
        message=None if record.get("decodable", True) else Undecodable(),
        publisher=record.get("publisher"),
    )


def _read_source(record: Mapping[str, Any]) -> ChangeInput:
    change = SourceChanged(
        topic=str(record["topic"]),
        publishers=int(record["publishers"]),
        transient_local=bool(record["transient_local"]),
        type_name=str(record["type"]),
    )
    return ChangeInput(stamp_ns=int(record["stamp_ns"]), change=change)


def _read_listeners(record: Mapping[str, Any]) -> ChangeInput:
    change = ListenersChanged(topic=str(record["topic"]), are_there=bool(record["are_there"]))
    return ChangeInput(stamp_ns=int(record["stamp_ns"]), change=change)


def _read_budget(record: Mapping[str, Any]) -> ChangeInput:
    budget = LinkBudget(
        link_kb_per_s=float(record["budget_kb_per_s"]), is_measured=bool(record.get("measured", False))
    )
    return ChangeInput(stamp_ns=int(record["stamp_ns"]), change=budget)


def _read_reckoned(record: Mapping[str, Any]) -> ChangeInput:
    change = ReceiversReckon(topics=frozenset(map(str, record["topics"])))
    return ChangeInput(stamp_ns=int(record["stamp_ns"]), change=change)


def _read_rules(record: Mapping[str, Any]) -> RuleTextsInput:
    budget_kb_per_s, relay_all = record["budget_kb_per_s"], record["relay_all"]
    return RuleTextsInput(
        stamp_ns=int(record["stamp_ns"]),
        rule_texts={str(path): str(text) for path, text in record["rules"].items()},
        profile_text=record["profile"],
        names={str(name): str(full) for name, full in record["names"].items()},
        when_slow=WhenSlow(record["when_slow"]),
        budget_kb_per_s=None if budget_kb_per_s is None else float(budget_kb_per_s),
        relay_all=None if relay_all is None else tuple(map(str, relay_all)),
    )
