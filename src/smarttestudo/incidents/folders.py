# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""Incidents as folders: a rosbag2 (mcap) beside ``incident.json``."""

from __future__ import annotations

import errno
import heapq
import os
import struct
from collections import Counter
from collections.abc import Callable, Collection, Hashable, Iterable, Mapping, Sequence
from contextlib import suppress
from dataclasses import dataclass, field, replace
from itertools import chain
from operator import attrgetter
from pathlib import Path

from smarttestudo.bags.incident_record import RECORD_NAME
from smarttestudo.bags.mcap.record_bytes import StoredChannel
from smarttestudo.bags.mcap.writer import FileContent
from smarttestudo.bags.mcap.written_file import complete_files
from smarttestudo.bags.metadata_text import METADATA_NAME, metadata_text
from smarttestudo.domain.errors import TestudoError, testudo_error
from smarttestudo.domain.incident import (
    IncidentRecord,
    IncidentTopic,
    LatchedSample,
    Missing,
    MissingReason,
    incident_folder_name,
    incident_text,
)
from smarttestudo.domain.units import NS_PER_S
from smarttestudo.files.removal import remove, temporary_folder
from smarttestudo.files.whole_file import PARTIAL_SUFFIX, not_written, whole_file
from smarttestudo.incidents.lost_messages import LostMessages
from smarttestudo.incidents.missing import missing_for_memory
from smarttestudo.incidents.recorder import Incident
from smarttestudo.incidents.ring_files import RingFiles
from smarttestudo.incidents.segments import (
    BagFolder,
    ChannelOf,
    Segment,
    SharedMessages,
    channel_of,
    link_file,
)
from smarttestudo.incidents.store import RESERVE_NAME, remove_begun, remove_incident
from smarttestudo.incidents.topic_ring import IncidentMessage, SourceMessage

SEGMENTS_OF_A_WINDOW = 10
LEAST_SEGMENT_NS = NS_PER_S
_WRITE_ERRORS = (OSError, struct.error, TestudoError)

_NO_RESERVES = (errno.EOPNOTSUPP, errno.EINVAL)
"""What disks answer that give none."""
RESERVE_BYTES = 64_000
"""Room for the end of an incident beside the definitions of its messages."""

Ended = Callable[[Path, IncidentRecord], None]
"""Takes the folder of an incident that ended, with its record.

If the end cannot be written, the folder is still hidden, or gone where nothing could be written at all.
"""
Failed = Callable[[str, TestudoError], None]
"""Takes the name of an incident that ends early, and why."""


@dataclass(slots=True, kw_only=True, eq=False)
class _OpenFolder:
    """An incident that is being written, or that was until it could not be: ``shared`` is ``None`` then.

    Messages that come later are ``lost``.
    """

    bag: BagFolder
    shared: SharedMessages | None
    record: IncidentRecord
    lost: LostMessages = field(default_factory=LostMessages)


class IncidentFolders:
    """An ``IncidentSink`` that writes each incident into a folder of its own below ``folder``.

    A folder has its name when its incident is whole; until then it is hidden, and a bag all the same.
    ``channels`` are the topics by name; messages of others are left out. ``of_message`` is the channel of
    each message, where that of a topic may change. Incidents of the same topics share files where their
    windows overlap, if the disk has hard links. What memory gave up is taken from ``ring``.
    ``ended`` is told of each folder.

    What cannot be written ends the incidents concerned: ``failed`` is told once of each, or, where there is
    none, it raises ``TestudoError``. When their windows end, they appear with what was written, and say how
    many messages were lost: each has a reserve of the disk for that. If it cannot be written all the same,
    they stay hidden for ``complete_incidents``, without their reserve, so that it knows that they did end.
    """

    def __init__(
        self,
        folder: Path,
        channels: Mapping[str, StoredChannel],
        *,
        of_message: ChannelOf | None = None,
        ring: RingFiles | None = None,
        failed: Failed | None = None,
        ended: Ended = lambda _, __: None,
    ) -> None:
        try:
            folder.mkdir(parents=True, exist_ok=True)
            self._shares = _has_hard_links(folder)
        except OSError as error:
            raise not_written(folder, "the incidents", error) from error
        self._folder = folder
        self._channels = channels
        self._of_message = of_message or channel_of(channels)
        self._ring = ring
        self._failed = failed
        self._ended = ended
        self._open: dict[Incident, _OpenFolder] = {}
        self._shared: dict[Hashable, SharedMessages] = {}

    def begin(
        self, incident: Incident, latched: Sequence[SourceMessage], messages: Iterable[IncidentMessage]
    ) -> None:
        """Write what came already; ``latched`` as from the window's start."""
        shared = self._shared_of(incident)
        taken = {found.bag.name for found in self._open.values()}
        name = unused_name(self._folder, incident.recording.name, incident.trigger.stamp_ns, taken)
        bag = BagFolder(path=self._folder / f".{name}{PARTIAL_SUFFIX}", name=name)
        found = _OpenFolder(bag=bag, shared=shared, record=first_record(incident, latched))
        self._open[incident] = found
        try:
            bag.path.mkdir()
            make_reserve(bag.path, self._channels)
            # What a killed run leaves says what it was.
            write_record(bag.path, as_if_killed(found.record))
            self._begin(incident, bag, shared, latched, messages)
        except _WRITE_ERRORS as error:
            self._give_up(shared, name, error)
            for message in chain(latched, messages):
                if not bag.holds(message.number):
                    self._lose(found, message)

    def write(self, message: SourceMessage, incidents: Sequence[Incident]) -> None:
        """Write one more, for ``incidents``."""
        done: set[int] = set()
        for incident in incidents:
            found = self._open[incident]
            if found.shared is None:
                self._lose(found, message)
            elif id(found.shared) not in done:
                done.add(id(found.shared))
                try:
                    found.shared.write(message)
                except _WRITE_ERRORS as error:
                    self._give_up(found.shared, found.bag.name, error)
                    self._lose(found, message)

    def end(self, incident: Incident, missing: Sequence[Missing]) -> None:
        """Have the folder appear with its record."""
        found = self._open.pop(incident)
        bag, shared = found.bag, found.shared
        missing = (*self._still_missing(incident, bag, missing), *found.lost.missing())
        record = replace(found.record, missing=missing)
        if shared is not None:
            try:
                shared.end(bag)
                self._finish(bag, record, bag.contents())
            except _WRITE_ERRORS as error:
                self._give_up(shared, bag.name, error)
            else:
                # Later folders that share its last file would keep all that is known of its first.
                bag.files.clear()
                return
        try:
            self._finish_lost(bag, record)
        except _WRITE_ERRORS:
            # Why it cannot be written was said.
            self._ended(bag.path, record)

    def abort(self) -> None:
        """Leave nothing of incidents that have not ended."""
        for found in self._open.values():
            if found.shared is not None:
                found.shared.abandon()
        for found in self._open.values():
            with suppress(OSError, TestudoError):
                remove_incident(found.bag.path)
        self._open.clear()

    def _begin(
        self,
        incident: Incident,
        bag: BagFolder,
        shared: SharedMessages,
        latched: Sequence[SourceMessage],
        messages: Iterable[IncidentMessage],
    ) -> None:
        if self._ring is not None:
            stored = self._ring.messages(incident.given_up)
            messages = heapq.merge(stored, messages, key=attrgetter("number"))
        shared.begin(bag, incident.from_number, messages)
        shared.add_latched(bag, [one for one in latched if not bag.holds(one.number)], incident.from_ns)

    def _shared_of(self, incident: Incident) -> SharedMessages:
        recording = incident.recording
        length_ns = max(LEAST_SEGMENT_NS, (recording.before_ns + recording.after_ns) // SEGMENTS_OF_A_WINDOW)
        key: Hashable = recording.topics if self._shares else incident
        shared = self._shared.get(key)
        if shared is None:
            shared = SharedMessages(self._channels, length_ns, self._of_message)
            if self._shares:
                self._shared[key] = shared
        shared.forget_before(incident.trigger.stamp_ns, recording.before_ns)
        return shared

    def _still_missing(
        self, incident: Incident, bag: BagFolder, missing: Sequence[Missing]
    ) -> tuple[Missing, ...]:
        """``missing``, without what the memory lacked and the disk had."""
        if not any(one.reason is MissingReason.MEMORY for one in missing):
            return tuple(missing)
        return (
            *(one for one in missing if one.reason is not MissingReason.MEMORY),
            *missing_for_memory(incident.given_up, bag.holds),
        )

    def _lose(self, found: _OpenFolder, message: IncidentMessage) -> None:
        if message.topic in self._channels:
            found.lost.add(message.topic, message.stamp_ns)

    def _finish_lost(self, bag: BagFolder, record: IncidentRecord) -> None:
        """Have what was written appear, if nothing was as an incident without messages."""
        try:
            bag.path.mkdir(exist_ok=True)
            free_reserve(bag.path)
            # Whatever cannot be written from here on, the next run knows what is missing.
            write_record(bag.path, finished_record(record, {}, self._channels))
            files = complete_files(bag.path)
            if not files:
                Segment(bag).close()
                files = bag.contents()
            self._finish(bag, record, files)
        except _WRITE_ERRORS:
            if not (bag.path / RECORD_NAME).exists():
                remove_begun(bag.path)
            raise

    def _finish(self, bag: BagFolder, record: IncidentRecord, files: Mapping[str, FileContent]) -> None:
        record = finished_record(record, files, self._channels)
        finish_folder(bag.path, record, files, self._channels)
        # Not before: of a run that is killed until here the next one is to say so.
        free_reserve(bag.path)
        bag.path = bag.path.rename(self._folder / bag.name)
        self._ended(bag.path, record)

    def _give_up(self, shared: SharedMessages, name: str, error: Exception) -> None:
        """End the incidents that share what cannot be written."""
        problem = (
            not_written(self._folder / name, "an incident", error)
            if isinstance(error, OSError)
            else testudo_error(error)
        )
        if self._failed is None:
            raise problem from error
        concerned = [found for found in self._open.values() if found.shared is shared]
        shared.abandon()
        for key, one in list(self._shared.items()):
            if one is shared:
                del self._shared[key]
        for found in concerned:
            found.shared = None
        for one_name in dict.fromkeys((name, *(found.bag.name for found in concerned))):
            self._failed(one_name, problem)


def first_record(incident: Incident, latched: Sequence[SourceMessage]) -> IncidentRecord:
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
        latched=tuple(LatchedSample(topic=one.topic, stamp_ns=one.stamp_ns) for one in latched),
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
    """Have room on the disk for the end of a recording in ``folder``. Raises ``OSError``."""
    # Topics may join meanwhile, on another thread.
    size_bytes = RESERVE_BYTES + sum(len(one.definition) for one in list(channels.values()))
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
    """Give that room back."""
    remove(folder, [RESERVE_NAME])


def _has_hard_links(folder: Path) -> bool:
    """Whether files in ``folder`` can have several names. Raises ``OSError`` where none can be made."""
    with temporary_folder(folder, suffix=PARTIAL_SUFFIX) as workshop:
        file = workshop / "file"
        file.touch()
        return link_file(file, workshop / "link") is None


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
    of_files = {one.topic: one for content in files.values() for one in content.channels}
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
    listed = {(one.topic, one.type_name): one for content in files.values() for one in content.channels}
    heard = {one.topic for one in listed.values()}
    listed |= {
        (topic, ""): channels[topic] for topic in record.topics if topic in channels and topic not in heard
    }
    with whole_file(path / METADATA_NAME, "the metadata of an incident") as write:
        write(metadata_text(files, [listed[key] for key in sorted(listed)]))
    write_record(path, record)


def write_record(path: Path, record: IncidentRecord) -> None:
    """Write the record into the folder ``path``. Raises ``OutputFileError``."""
    with whole_file(path / RECORD_NAME, "the record of an incident") as write:
        write(incident_text(record))
