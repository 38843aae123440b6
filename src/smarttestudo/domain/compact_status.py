# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""A runtime's status as it goes over a link: JSON with the digits that anyone reads."""

from __future__ import annotations

from smarttestudo.domain.status import RuntimeStatus
from smarttestudo.domain.status_json import status_to_json
from smarttestudo.domain.units import NS_PER_MS

_DIGITS = 4
_MEASURED = frozenset(
    {
        *("uptime_s", "in_kb_per_s", "out_kb_per_s", "cpu_percent", "memory_mb", "waits_s"),
        *("capacity_kb_per_s", "round_trip_ms", "age_ms", "queued_bytes"),
        *("source_hz", "expected_hz", "actual_hz", "stamped_hz", "error_percent", "delay_ms"),
        *("received", "relayed", "dropped", "repeated", "discarded", "undecodable"),
        *("sent", "replaced", "overflowed"),
    }
)


def compact_status(status: RuntimeStatus) -> dict[str, object]:
    """The object on ``/testudo/status``: measured to four digits, the stamp to the millisecond below."""
    record = _shortened(status_to_json(status))
    assert isinstance(record, dict)
    return {**record, "stamp_ns": status.stamp_ns // NS_PER_MS * NS_PER_MS}


def is_measured(path: tuple[str | int, ...]) -> bool:
    """Whether a number there is a measurement or a count, of which one a second is enough."""
    return path[-1:] != () and path[-1] in _MEASURED


def _shortened(value: object, name: str = "") -> object:
    if isinstance(value, dict):
        return {key: _shortened(entry, key) for key, entry in value.items()}
    if isinstance(value, float) and name in _MEASURED:
        return float(f"{value:.{_DIGITS}g}")
    return value
