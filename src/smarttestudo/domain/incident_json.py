# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""The record of an incident as a JSON object."""

from __future__ import annotations

import json
from dataclasses import replace

from smarttestudo.domain.errors import RecordingError
from smarttestudo.domain.incident import INCIDENT_VERSION, IncidentRecord
from smarttestudo.domain.infinite_values import infinite_entry, with_infinite
from smarttestudo.domain.json_text import json_text
from smarttestudo.domain.record import from_json, to_json
from smarttestudo.domain.units import utc_time

MAX_RECORD_BYTES = 4_000_000


def incident_to_json(incident: IncidentRecord) -> dict[str, object]:
    """The object in ``incident.json``; times that end in ``_ns`` count from 1970."""
    return {
        "version": INCIDENT_VERSION,
        "time": utc_time(incident.triggered_ns),
        **to_json(incident),
        **infinite_entry(incident.values),
    }


def incident_text(incident: IncidentRecord) -> str:
    """Content of ``incident.json``."""
    return f"{json_text(incident_to_json(incident), indent=2)}\n"


def read_incident(text: bytes, place: str) -> IncidentRecord:
    """The record that ``incident.json`` at ``place`` holds.

    Raises ``RecordingError`` for a text that is cut, edited or of another version.
    """
    try:
        found = json.loads(text)
        if isinstance(found, dict) and (version := found.get("version")) != INCIDENT_VERSION:
            raise RecordingError(
                f"version {str(version)[:20]} of an incident is not known",
                place=place,
                remedy="read it with the SmartTestudo that wrote it",
            )
        record = from_json(IncidentRecord, found)
        return _ordered(replace(record, values=with_infinite(record.values, found)))
    except (ValueError, RecursionError) as error:
        raise RecordingError(
            "does not hold the record of an incident", place=place, remedy="was it cut or edited?"
        ) from error


def _ordered(incident: IncidentRecord) -> IncidentRecord:
    if not incident.from_ns <= incident.triggered_ns <= incident.to_ns:
        raise ValueError(incident.triggered_ns)
    return incident
