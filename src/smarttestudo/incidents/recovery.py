# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""Incidents that a killed run left behind."""

from __future__ import annotations

import struct
from collections.abc import Iterator, Mapping
from contextlib import suppress
from dataclasses import dataclass, replace
from pathlib import Path

from smarttestudo.bags.incident_record import RECORD_NAME, read_record
from smarttestudo.bags.mcap.writer import FileContent, McapWriter
from smarttestudo.bags.mcap.written_file import complete_files
from smarttestudo.domain.errors import RecordingError, TestudoError
from smarttestudo.domain.incident import OUTAGE_RULE, IncidentRecord, Missing, MissingReason
from smarttestudo.domain.units import counted, utc_time
from smarttestudo.files.removal import remove
from smarttestudo.files.whole_file import PARTIAL_SUFFIX, not_written
from smarttestudo.incidents.folders import finish_folder, finished_record
from smarttestudo.incidents.outage_folder import spanning
from smarttestudo.incidents.store import RESERVE_NAME, remove_begun


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
    """Complete the incidents in ``folder`` that are not whole; what is missing is in their records.

    One of which not even the record was written is removed, unless there is something else in its folder.
    """
    for path in sorted(folder.glob(f".*{PARTIAL_SUFFIX}")):
        name = path.name[1 : -len(PARTIAL_SUFFIX)]
        if not path.is_dir() or path.is_symlink():
            continue
        if not (path / RECORD_NAME).exists():
            with suppress(OSError):
                remove_begun(path)
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
    if not files:
        # A bag without files is none.
        name = f"{target.name}_0.mcap"
        files = {name: McapWriter(path / name).close()}
    filled = {name: content for name, content in files.items() if content.message_count}
    if record.rule == OUTAGE_RULE:
        record = spanning(record, filled.values())
        last_ns = record.to_ns
    else:
        last_ns = _last_written_ns(record, filled)
        if (reason := _why_unended(record, has_reserve=(path / RESERVE_NAME).exists())) is not None:
            record = replace(record, missing=tuple(_cut_off(record, last_ns, reason)))
    record = finished_record(record, files, {})
    finish_folder(path, record, files, {})
    remove(path, [RESERVE_NAME])
    path.rename(target)
    messages = sum(content.message_count for content in files.values())
    return CompletedIncident(name=target.name, messages=messages, last_ns=last_ns)


def _why_unended(record: IncidentRecord, *, has_reserve: bool) -> MissingReason | None:
    """Why an incident has no end, as its first record says that; ``None`` where it says what is missing.

    A run that ends by itself gives up the reserve, and then its disk did not take the end.
    """
    if any(one.type_name for one in record.topics.values()):
        return None
    reasons = {one.reason for one in record.missing}
    if reasons == {MissingReason.KILLED}:
        return MissingReason.KILLED if has_reserve else MissingReason.DISK
    # An older version writes a first record that says nothing of it.
    return None if reasons else MissingReason.KILLED


def _cut_off(record: IncidentRecord, last_ns: int, reason: MissingReason) -> Iterator[Missing]:
    """All that the window lacks after its last message."""
    for topic in record.topics:
        if last_ns < record.to_ns:
            yield Missing(topic=topic, reason=reason, messages=None, from_ns=last_ns, to_ns=record.to_ns)


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
