# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""The record of an incident in the folder of its recording, and what it says, in words."""

from __future__ import annotations

import stat
from collections.abc import Iterator, Mapping
from contextlib import contextmanager
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING

from smarttestudo.bags.statistics import RecordingSpan
from smarttestudo.domain.errors import RecordingError
from smarttestudo.domain.signal import Value
from smarttestudo.domain.units import NS_PER_S, counted, grouped, utc_time
from smarttestudo.language.formatter import value_text

if TYPE_CHECKING:
    from smarttestudo.domain.incident import IncidentRecord, Missing

RECORD_NAME = "incident.json"


def read_record(folder: Path) -> IncidentRecord:
    """The record of the incident in ``folder``. Raises ``RecordingError`` where it cannot be read."""
    from smarttestudo.domain.incident import MAX_RECORD_BYTES, read_incident  # noqa: PLC0415  most are no incident

    place = folder / RECORD_NAME
    with errors_at(place):
        found = place.lstat()
        if not stat.S_ISREG(found.st_mode):
            raise RecordingError("is not a file", place=str(place))
        if found.st_size > MAX_RECORD_BYTES:
            raise RecordingError(
                "is too large for the record of an incident", place=str(place), remedy="was it edited?"
            )
        text = place.read_bytes()
    return read_incident(text, str(place))


def record_beside(recording: Path) -> IncidentRecord | None:
    """The record of a recording that is an incident. Raises ``RecordingError`` where it cannot be read."""
    return read_record(recording) if (recording / RECORD_NAME).is_file() else None


@contextmanager
def errors_at(path: Path) -> Iterator[None]:
    """Turn what the system refuses at ``path`` into ``RecordingError``."""
    try:
        yield
    except OSError as error:
        remedy = (
            "check its permissions and those of its folder" if isinstance(error, PermissionError) else None
        )
        raise RecordingError(error.strerror or str(error), place=str(path), remedy=remedy) from error


@dataclass(frozen=True, slots=True, kw_only=True)
class IncidentMark:
    """The moment at which a rule began to hold, in s since the start of its recording, and it in words."""

    name: str
    at_s: float
    text: str


def incident_mark(record: IncidentRecord, span: RecordingSpan) -> IncidentMark:
    """Where in ``span`` the incident is."""
    at_s = (record.triggered_ns - span.start_ns) / NS_PER_S
    text = f"{record.name} at {grouped(at_s, 1)} s, {utc_time(record.triggered_ns)}: {_reason(record)}"
    return IncidentMark(name=record.name, at_s=at_s, text=text)


def incident_text(record: IncidentRecord) -> str:
    """The name and time of an incident, the rule, what its condition read, and how often it held again."""
    return f"{record.name} at {utc_time(record.triggered_ns)}: {_reason(record)}"


def incident_subtitles(record: IncidentRecord | None) -> tuple[str, ...]:
    """The line that follows the name of a recording that is an incident; none for any other."""
    return () if record is None else (f"incident {incident_text(record)}",)


def _reason(record: IncidentRecord) -> str:
    further = record.moments - 1
    more = (counted(further, "further moment"),) if further else ()
    return ", ".join((f"rule {record.rule}", *signal_texts(record.values), *more))


def signal_texts(values: Mapping[str, Value | None]) -> Iterator[str]:
    """Values that the condition read, a text each; former versions wrote infinite ones as unknown ones."""
    for signal, value in values.items():
        known = value_text(value) if isinstance(value, str) else format(value or 0.0, "g")
        yield f"{signal} = {'unknown or infinite' if value is None else known}"


def incident_notices(record: IncidentRecord, span: RecordingSpan) -> Iterator[str]:
    """Notices on an incident: what numbers over ``span`` hold beside the window, and what they lack of it."""
    extra_s = (record.from_ns - span.start_ns) / NS_PER_S
    if extra_s > 0:
        yield (
            f"the first {grouped(extra_s, 1)} s are from before the window of {record.name}: "
            "they share a file with an earlier incident"
        )
    for missing in record.missing:
        yield f"missing: {missing_text(missing)}"


def missing_text(missing: Missing) -> str:
    """Of which topic, how much, from when to when, and why."""
    messages = "what came" if missing.messages is None else counted(missing.messages, "message")
    between = f"{utc_time(missing.from_ns)} to {utc_time(missing.to_ns)}"
    return f"{missing.topic}: {messages} from {between} ({missing.reason.value})"
