# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""A runtime's status as JSON, there and back."""

from __future__ import annotations

import json
from collections.abc import Mapping

from smarttestudo.domain.record import from_json, measured_names
from smarttestudo.domain.status import STATUS_HZ, RuntimeStatus
from smarttestudo.domain.units import NS_PER_MS

_DIGITS = 4


def compact_status(status: Mapping[str, object]) -> dict[str, object]:
    """The object that goes over a link of a status in JSON.

    Measured to four digits, the stamp to the millisecond below; nothing in a block is a measurement.
    """
    record = {key: one if key == "blocks" else _shortened(one, key) for key, one in status.items()}
    stamp_ns = status["stamp_ns"]
    assert isinstance(stamp_ns, int)
    return {**record, "stamp_ns": stamp_ns // NS_PER_MS * NS_PER_MS}


def is_measured(path: tuple[str | int, ...]) -> bool:
    """Whether a number there is a measurement or a count, of which one a second is enough."""
    return path[-1:] != () and path[-1] in measured_names(RuntimeStatus)


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
    return from_json(RuntimeStatus, _upgraded(value))


def _upgraded(value: object) -> object:
    """Add what an older version did not say: a topic is losing messages on the link if it ever did."""
    if not isinstance(value, dict):
        return value
    known = dict(value)
    if (hz := known.get("status_hz")) is None or (hz == 0 and not isinstance(hz, bool)):
        known["status_hz"] = STATUS_HZ
    if isinstance(topics := value.get("topics"), dict):
        known["topics"] = {name: _upgraded_topic(topic) for name, topic in topics.items()}
    return known


def _upgraded_topic(topic: object) -> object:
    if not isinstance(topic, dict) or not isinstance(link := topic.get("link"), dict):
        return topic
    return {**topic, "link": {"losing": bool(link.get("overflowed")), **link}}


def _shortened(value: object, name: str = "") -> object:
    if isinstance(value, dict):
        return {key: _shortened(entry, key) for key, entry in value.items()}
    if isinstance(value, float) and name in measured_names(RuntimeStatus):
        return float(f"{value:.{_DIGITS}g}")
    return value
