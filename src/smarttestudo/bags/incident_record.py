# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""The record of an incident, in the folder of its recording."""

from __future__ import annotations

import stat
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import TYPE_CHECKING

from smarttestudo.domain.errors import RecordingError

if TYPE_CHECKING:
    from smarttestudo.domain.incident import IncidentRecord

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
