# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""Incidents that a killed run left behind."""

from __future__ import annotations

import struct
from collections.abc import Iterator, Mapping
from dataclasses import replace
from pathlib import Path

from smarttestudo.bags.incident_record import RECORD_NAME, read_record
from smarttestudo.bags.mcap.writer import FileContent
from smarttestudo.bags.mcap.written_file import complete_files
from smarttestudo.domain.dataclass import dataclass
from smarttestudo.domain.errors import RecordingError, TestudoError
from smarttestudo.domain.incident import IncidentRecord, Missing, MissingReason
from smarttestudo.domain.remote_incidents import OUTAGE_RULE
from smarttestudo.domain.units import counted, utc_time
from smarttestudo.files.whole_file import PARTIAL_SUFFIX, not_written
from smarttestudo.incidents.folders import finish_folder, finished_record
from smarttestudo.incidents.outage_folder import spanning


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
    files = complete_files(path)
    filled = {name: content for name, content in files.items() if content.message_count}
    if record.rule == OUTAGE_RULE:
        record = spanning(record, filled.values())
        last_ns = record.to_ns
    else:
        last_ns = _last_written_ns(record, filled)
        record = replace(record, missing=(*record.missing, *_cut_off(record, last_ns)))
    record = finished_record(record, files, {})
    finish_folder(path, record, files, {})
    path.rename(target)
    messages = sum(content.message_count for content in files.values())
    return CompletedIncident(name=target.name, messages=messages, last_ns=last_ns)


def _cut_off(record: IncidentRecord, last_ns: int) -> Iterator[Missing]:
    """All that the window lacks after its last message."""
    for topic in record.topics:
        if last_ns < record.to_ns:
            yield Missing(
                topic=topic, reason=MissingReason.KILLED, messages=None, from_ns=last_ns, to_ns=record.to_ns
            )


def _last_written_ns(record: IncidentRecord, files: Mapping[str, FileContent]) -> int:
    """Stamp of the message of a window that was written last, in one of ``files``, which have messages.

    It is not the greatest one where the clock was set back.
    """
    for name in sorted(files, key=lambda name: (len(name), name), reverse=True):
        if not _is_of_latched(record, files[name]):
            return files[name].final_ns
    return record.triggered_ns


def _is_of_latched(record: IncidentRecord, content: FileContent) -> bool:
    """Whether it is the file of the messages from before the window, which all have the same stamp."""
    return (
        content.first_ns == content.last_ns <= max(0, record.from_ns)
        and content.message_count <= len(record.latched)
        and content.messages.keys() <= {one.topic for one in record.latched}
    )
