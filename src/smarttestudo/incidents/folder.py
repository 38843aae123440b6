# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""The folder of one incident: what is written into it, and how one that is not whole is completed."""

from __future__ import annotations

import errno
import os
import struct
from collections import Counter
from collections.abc import Callable, Collection, Iterable, Iterator, Mapping, Sequence
from contextlib import suppress
from dataclasses import dataclass, replace
from pathlib import Path

from smarttestudo.bags.incident_record import RECORD_NAME, read_record
from smarttestudo.bags.mcap.record_bytes import StoredChannel
from smarttestudo.bags.mcap.writer import FileContent, McapWriter, complete_files
from smarttestudo.bags.metadata_text import METADATA_NAME, metadata_text
from smarttestudo.domain.errors import RecordingError, TestudoError
from smarttestudo.domain.incident import (
    OUTAGE_RULE,
    IncidentRecord,
    IncidentTopic,
    LatchedSample,
    Missing,
    MissingReason,
    incident_folder_name,
    incident_text,
)
from smarttestudo.domain.units import counted, utc_time
from smarttestudo.files.removal import remove
from smarttestudo.files.whole_file import PARTIAL_SUFFIX, not_written, whole_file
from smarttestudo.incidents.sink import Incident
from smarttestudo.incidents.store import RESERVE_NAME, remove_begun
from smarttestudo.incidents.topic_ring import IncidentMessage

_NO_RESERVES = (errno.EOPNOTSUPP, errno.EINVAL)
"""What disks answer that give none."""
RESERVE_BYTES = 64_000
"""Room for the end of an incident beside the definitions of its messages."""

ChannelOf = Callable[[str, int], StoredChannel | None]
"""Channel of a topic's message of some number; ``None`` where the topic is not known."""


def channel_of(channels: Mapping[str, StoredChannel]) -> ChannelOf:
    """For topics that never change."""
    return lambda topic, _: channels.get(topic)


def first_record(incident: Incident, latched: Sequence[IncidentMessage]) -> IncidentRecord:
    """Record of an incident as it begins."""
    trigger, recording = incident.trigger, incident.recording
    return IncidentRecord(
        name=recording.name,
        rule=trigger.block.label,
        path=trigger.block.path,
        line=recording.line,
        triggered_ns=trigger.stamp_ns,
        from_ns=incident.from_ns,
        to_ns=incident.to_ns,
        values=trigger.values,
        rules_sha256=incident.rules_sha256,
        topics={topic: IncidentTopic(type_name="", messages=0, size_bytes=0) for topic in recording.topics},
        latched=tuple(LatchedSample(topic=sample.topic, stamp_ns=sample.stamp_ns) for sample in latched),
    )


def as_if_killed(record: IncidentRecord) -> IncidentRecord:
    """``record`` of an incident that begins, as it stays if the run is killed."""
    killed = (
        Missing(
            topic=topic,
            reason=MissingReason.KILLED,
            messages=None,
            from_ns=record.triggered_ns,
            to_ns=record.to_ns,
        )
        for topic in record.topics
    )
    return replace(record, missing=tuple(killed))


def make_reserve(folder: Path, channels: Mapping[str, StoredChannel]) -> None:
    """Reserve room on the disk for the end of a recording in ``folder``. Raises ``OSError``."""
    # Topics may join meanwhile, on another thread.
    size_bytes = RESERVE_BYTES + sum(len(channel.definition) for channel in list(channels.values()))
    file = os.open(folder / RESERVE_NAME, os.O_WRONLY | os.O_CREAT | os.O_CLOEXEC, 0o644)
    try:
        if hasattr(os, "posix_fallocate"):
            os.posix_fallocate(file, 0, size_bytes)
    except OSError as error:
        if error.errno not in _NO_RESERVES:
            raise
    finally:
        os.close(file)


def free_reserve(folder: Path) -> None:
    """Give the reserved room back."""
    remove(folder, [RESERVE_NAME])


def unused_name(folder: Path, name: str, stamp_ns: int, taken: Collection[str] = ()) -> str:
    """The name of a folder in ``folder`` for the incident ``name``, with a number where others have it.

    ``taken`` are names of incidents whose folders could not be made.
    """
    plain = incident_folder_name(name, stamp_ns)
    found, number = plain, 1
    while found in taken or any(
        os.path.lexists(folder / one) for one in (found, f".{found}{PARTIAL_SUFFIX}")
    ):
        number += 1
        found = f"{plain}-{number}"
    return found


def finished_record(
    record: IncidentRecord, files: Mapping[str, FileContent], channels: Mapping[str, StoredChannel]
) -> IncidentRecord:
    """``record`` with what its files hold of each topic."""
    messages, size_bytes = Counter[str](), Counter[str]()
    for content in files.values():
        messages.update(content.messages)
        size_bytes.update(content.size_bytes)
    of_files = {channel.topic: channel for content in files.values() for channel in content.channels}
    return record_holding(record, messages, size_bytes, {**channels, **of_files})


def record_holding(
    record: IncidentRecord,
    messages: Counter[str],
    size_bytes: Counter[str],
    channels: Mapping[str, StoredChannel],
) -> IncidentRecord:
    """``record`` with so many messages and bytes of each topic."""
    return replace(
        record,
        topics={
            topic: IncidentTopic(
                type_name=channels[topic].type_name if topic in channels else "",
                messages=messages[topic],
                size_bytes=size_bytes[topic],
            )
            for topic in sorted({*record.topics, *messages})
        },
    )


def finish_folder(
    path: Path,
    record: IncidentRecord,
    files: Mapping[str, FileContent],
    channels: Mapping[str, StoredChannel],
) -> None:
    """Write what names the files of a bag, and the record. Raises ``OutputFileError``."""
    listed = {
        (channel.topic, channel.type_name): channel
        for content in files.values()
        for channel in content.channels
    }
    listed_topics = {one.topic for one in listed.values()}
    listed |= {
        (topic, ""): channels[topic]
        for topic in record.topics
        if topic in channels and topic not in listed_topics
    }
    with whole_file(path / METADATA_NAME, "the metadata of an incident") as write:
        write(metadata_text(files, [listed[key] for key in sorted(listed)]))
    write_record(path, record)


def write_record(path: Path, record: IncidentRecord) -> None:
    """Write the record into the folder ``path``. Raises ``OutputFileError``."""
    with whole_file(path / RECORD_NAME, "the record of an incident") as write:
        write(incident_text(record))


def spanning(record: IncidentRecord, contents: Iterable[FileContent]) -> IncidentRecord:
    """``record`` of an outage, from the first to the last message of its files, which have some."""
    listed = list(contents)
    return replace(
        record,
        from_ns=min((record.from_ns, *(one.first_ns for one in listed))),
        to_ns=max((record.to_ns, *(one.last_ns for one in listed))),
    )


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

    A folder of which not even the record was written is removed, unless there is something else in its
    folder.
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
    if any(topic.type_name for topic in record.topics.values()):
        return None
    reasons = {missing.reason for missing in record.missing}
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
        and content.messages.keys() <= {sample.topic for sample in record.latched}
    )
