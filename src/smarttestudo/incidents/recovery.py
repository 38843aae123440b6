# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""Incidents that a killed run left behind."""

from __future__ import annotations

import struct
from collections.abc import Iterator
from dataclasses import dataclass, replace
from pathlib import Path

from smarttestudo.bags.incident_record import RECORD_NAME, read_record
from smarttestudo.bags.mcap.written_file import complete_files
from smarttestudo.domain.errors import RecordingError, TestudoError
from smarttestudo.domain.incident import Missing, MissingReason
from smarttestudo.domain.units import counted, utc_time
from smarttestudo.files.whole_file import PARTIAL_SUFFIX, not_written
from smarttestudo.incidents.folders import finish_folder, finished_record


@dataclass(frozen=True, slots=True, kw_only=True)
class CompletedIncident:
    """Result for a folder that was not whole; ``error`` says why it stays as it was."""

    name: str
    messages: int = 0
    last_ns: int = 0
    error: TestudoError | None = None

    def __str__(self) -> str:
        if self.error is not None:
            return f"{self.name}: was not ended, and cannot be completed: {self.error}"
        until = f" until {utc_time(self.last_ns)}" if self.messages else ""
        return f"{self.name}: was not ended; completed with {counted(self.messages, 'message')}{until}"


def complete_incidents(folder: Path) -> Iterator[CompletedIncident]:
    """Complete the incidents in ``folder`` that are not whole; what is missing is in their records."""
    for path in sorted(folder.glob(f".*{PARTIAL_SUFFIX}")):
        name = path.name[1 : -len(PARTIAL_SUFFIX)]
        if not path.is_dir() or path.is_symlink() or not (path / RECORD_NAME).exists():
            continue
        try:
            yield _completed(path, folder / name)
        except OSError as error:
            yield CompletedIncident(name=name, error=not_written(path, "what is missing", error))
        except (TestudoError, struct.error) as error:
            known = error if isinstance(error, TestudoError) else RecordingError(f"damaged: {error}")
            yield CompletedIncident(name=name, error=known)


def _completed(path: Path, target: Path) -> CompletedIncident:
    record = read_record(path)
    files, channels = complete_files(path)
    last_ns = max((content.last_ns for content in files.values()), default=record.triggered_ns)
    missing = [
        Missing(topic=topic, reason=MissingReason.KILLED, messages=None, from_ns=last_ns, to_ns=record.to_ns)
        for topic in record.topics
        if last_ns < record.to_ns
    ]
    record = finished_record(replace(record, missing=(*record.missing, *missing)), files, channels)
    finish_folder(path, record, files, channels)
    path.rename(target)
    messages = sum(content.message_count for content in files.values())
    return CompletedIncident(name=target.name, messages=messages, last_ns=last_ns)
