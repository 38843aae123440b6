# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""An input of the loop as a JSON object."""

from __future__ import annotations

from base64 import b64decode, b64encode
from collections.abc import Mapping
from typing import Any

from smarttestudo.domain.observation import (
    LinkBudget,
    ListenersChanged,
    ReceiversReckon,
    SourceChanged,
    Undecodable,
)
from smarttestudo.domain.record import from_json, to_json
from smarttestudo.loop.inputs import (
    ChangeInput,
    MessageInput,
    RecordedInput,
    RuleTextsInput,
    WakeInput,
)

_CHANGES: Mapping[str, type[SourceChanged | ListenersChanged | LinkBudget | ReceiversReckon]] = {
    "source": SourceChanged,
    "listeners": ListenersChanged,
    "budget": LinkBudget,
    "reckoned": ReceiversReckon,
}
_OTHERS: Mapping[str, type[WakeInput | RuleTextsInput]] = {"wake": WakeInput, "rules": RuleTextsInput}
_EVENTS: Mapping[type, str] = {kind: event for event, kind in (*_CHANGES.items(), *_OTHERS.items())}


def input_to_json(given: RecordedInput) -> dict[str, object]:
    """The object of one line; what is absent or usual has no key."""
    match given:
        case MessageInput():
            return {"event": "message", "stamp_ns": given.stamp_ns, **_message(given)}
        case ChangeInput(stamp_ns=stamp_ns, change=change):
            return {"event": _EVENTS[type(change)], "stamp_ns": stamp_ns, **to_json(change)}
        case _:
            return {"event": _EVENTS[type(given)], **to_json(given)}


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
    event = record["event"]
    if event == "message":
        return _read_message(record)
    if event in _CHANGES:
        change = from_json(_CHANGES[event], record)
        return ChangeInput(stamp_ns=int(record["stamp_ns"]), change=change)
    return from_json(_OTHERS[event], record)


def _read_message(record: Mapping[str, Any]) -> MessageInput:
    return MessageInput(
        stamp_ns=int(record["stamp_ns"]),
        topic=str(record["topic"]),
        size_bytes=int(record["size_bytes"]),
        payload=b64decode(record.get("payload", ""), validate=True),
        message=None if record.get("decodable", True) else Undecodable(),
        publisher=record.get("publisher"),
    )
