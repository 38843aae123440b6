# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""Incidents as folders: a rosbag2 (mcap) beside ``incident.json``."""

from __future__ import annotations

import heapq
import struct
from array import array
from bisect import bisect_left
from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from contextlib import suppress
from dataclasses import dataclass, field, replace
from itertools import chain
from operator import attrgetter
from pathlib import Path

from smarttestudo.bags.incident_record import RECORD_NAME
from smarttestudo.bags.mcap.record_bytes import StoredChannel
from smarttestudo.bags.mcap.writer import FileContent, McapWriter, complete_files
from smarttestudo.domain.errors import TestudoError, testudo_error
from smarttestudo.domain.incident import IncidentRecord, Missing, MissingReason
from smarttestudo.domain.units import NS_PER_S
from smarttestudo.files.whole_file import PARTIAL_SUFFIX, not_written
from smarttestudo.incidents.folder import (
    ChannelOf,
    as_if_killed,
    channel_of,
    finish_folder,
    finished_record,
    first_record,
    free_reserve,
    make_reserve,
    unused_name,
    write_record,
)
from smarttestudo.incidents.missing import LostMessages, missing_for_memory
from smarttestudo.incidents.ring_files import RingFiles
from smarttestudo.incidents.sink import Incident, Past
from smarttestudo.incidents.store import remove_begun, remove_incident
from smarttestudo.incidents.topic_ring import GivenUp, IncidentMessage, SourceMessage
from smarttestudo.loop.step import Trigger

_NUMBER = attrgetter("number")
_WRITE_ERRORS = (OSError, struct.error, TestudoError)
_RECORD_NS = NS_PER_S // 2
"""How long further moments may be missing in the record of an incident that is open."""
Ended = Callable[[Path, IncidentRecord], None]
"""Takes the folder of an incident that ended, with its record.

If the end cannot be written, the folder is still hidden, or gone where nothing could be written at all.
"""
Failed = Callable[[str, TestudoError], None]
"""Takes the name of an incident that ends early, and why."""


@dataclass(slots=True, kw_only=True, eq=False)
class _OpenFolder:
    """An incident that is being written, or that was until it could not be: ``writer`` is ``None`` then.

    ``numbers`` are those of the messages in it, which rise; later ones than could be written are ``lost``.
    ``record`` was written last at ``written_ns``, on the clock; ``is_noted`` says whether it still is that.
    """

    path: Path
    name: str
    record: IncidentRecord
    written_ns: int
    is_noted: bool = True
    writer: McapWriter | None = None
    numbers: array[int] = field(default_factory=lambda: array("q"))
    given_up: list[Mapping[str, Sequence[GivenUp]]] = field(default_factory=list)
    lost: LostMessages = field(default_factory=LostMessages)

    @property
    def file(self) -> Path:
        """Path of the recording."""
        return self.path / f"{self.name}_0.mcap"

    def holds(self, number: int) -> bool:
        """Whether the message of that number is in it."""
        at = bisect_left(self.numbers, number)
        return at < len(self.numbers) and self.numbers[at] == number


class IncidentFolders:
    """An ``IncidentSink`` that writes each incident into a folder of its own below ``folder``.

    A folder has its name when its incident is whole; until then it is hidden, and a bag all the same.
    ``channels`` are the topics by name; messages of others are left out. ``of_message`` is the channel of
    each message, where that of a topic may change. What memory gave up is taken from ``ring``. ``ended`` is
    called with each folder.

    What cannot be written ends the incident concerned: ``failed`` is called once with each, or, where there
    is none, it raises ``TestudoError``. When its window ends, it appears with what was written, and says how
    many messages were lost: each has a reserve of the disk for that. If it cannot be written all the same,
    it stays hidden for ``complete_incidents``, without its reserve, which says that it did end.
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
        except OSError as error:
            raise not_written(folder, "the incidents", error) from error
        self._folder = folder
        self._channels = channels
        self._of_message = of_message or channel_of(channels)
        self._ring = ring
        self._failed = failed
        self._ended = ended
        self._open: dict[Incident, _OpenFolder] = {}

    def begin(self, incident: Incident, past: Past) -> None:
        """Write what arrived already; latched messages as from the window's start."""
        stored = self._stored(past)
        was_latched = {one.number for one in chain.from_iterable(map(past.latched_of, past.given_up))}
        latched = sorted((*past.latched, *(one for one in stored if one.number in was_latched)), key=_NUMBER)
        taken = {found.name for found in self._open.values()}
        stamp_ns = incident.trigger.stamp_ns
        name = unused_name(self._folder, incident.recording.name, stamp_ns, taken)
        found = _OpenFolder(
            path=self._folder / f".{name}{PARTIAL_SUFFIX}",
            name=name,
            record=first_record(incident, latched),
            written_ns=stamp_ns,
            given_up=[past.given_up],
        )
        self._open[incident] = found
        try:
            found.path.mkdir()
            make_reserve(found.path, self._channels)
            # What a killed run leaves says what it was.
            write_record(found.path, as_if_killed(found.record))
            found.writer = McapWriter(found.file)
            # A window may begin before the simulated time does, and no stamp can.
            from_ns = max(0, incident.from_ns)
            for message in latched:
                self._append(found, message, from_ns)
            rest = [one for one in stored if one.number not in was_latched]
            for one in heapq.merge(rest, past.messages, key=_NUMBER):
                self._append(found, one, one.stamp_ns)
        except _WRITE_ERRORS as error:
            self._give_up(found, error)
            self._lose(found, chain(past.latched, past.messages))

    def extend(self, incident: Incident, trigger: Trigger, to_ns: int, past: Past) -> None:
        """Note a further moment, and write what arrived since the window was over."""
        found = self._open[incident]
        found.record = found.record.extended(trigger.stamp_ns, trigger.values, to_ns)
        found.is_noted = False
        found.given_up.append(past.given_up)
        if found.writer is not None:
            try:
                self._note(found, trigger.stamp_ns)
                for message in heapq.merge(self._stored(past), past.messages, key=_NUMBER):
                    self._append(found, message, message.stamp_ns)
            except _WRITE_ERRORS as error:
                self._give_up(found, error)
        if found.writer is None:
            self._lose(found, past.messages)

    def write(self, message: SourceMessage, incidents: Sequence[Incident]) -> None:
        """Write one more, for ``incidents``."""
        for incident in incidents:
            found = self._open[incident]
            if found.writer is not None:
                try:
                    self._append(found, message, message.stamp_ns)
                    self._note(found, message.stamp_ns)
                except _WRITE_ERRORS as error:
                    self._give_up(found, error)
            if found.writer is None:
                self._lose(found, [message])

    def end(self, incident: Incident, missing: Sequence[Missing]) -> None:
        """Give the folder its name, with the record."""
        found = self._open.pop(incident)
        missing = (*_still_missing(found, missing), *found.lost.missing())
        record = replace(found.record, missing=missing)
        if found.writer is not None:
            try:
                self._finish(found, record, {found.file.name: found.writer.close()})
            except _WRITE_ERRORS as error:
                self._give_up(found, error)
            else:
                return
        try:
            self._finish_lost(found, record)
        except _WRITE_ERRORS:
            # Why it cannot be written was said.
            self._ended(found.path, record)

    def abort(self) -> None:
        """Leave nothing of incidents that have not ended."""
        for found in self._open.values():
            if found.writer is not None:
                found.writer.abandon()
            with suppress(OSError, TestudoError):
                remove_incident(found.path)
        self._open.clear()

    def _stored(self, past: Past) -> Sequence[IncidentMessage]:
        """Messages that memory gave up and the disk has."""
        return () if self._ring is None else self._ring.messages(past.given_up)

    def _append(self, found: _OpenFolder, message: IncidentMessage, stamp_ns: int) -> None:
        assert found.writer is not None
        channel = self._of_message(message.topic, message.number)
        if channel is not None and message.topic in self._channels:
            found.writer.write(channel, stamp_ns, message.payload)
            found.numbers.append(message.number)

    def _note(self, found: _OpenFolder, now_ns: int) -> None:
        """Write further moments into the record as a killed run leaves it, at most twice a second."""
        if not found.is_noted and not 0 <= now_ns - found.written_ns < _RECORD_NS:
            write_record(found.path, as_if_killed(found.record))
            found.is_noted, found.written_ns = True, now_ns

    def _lose(self, found: _OpenFolder, messages: Iterable[IncidentMessage]) -> None:
        """Count those of ``messages`` that are not in the incident."""
        for message in messages:
            if message.topic in self._channels and not found.holds(message.number):
                found.lost.add(message.topic, message.stamp_ns)

    def _finish_lost(self, found: _OpenFolder, record: IncidentRecord) -> None:
        """Give the folder its name with what was written; if nothing was, without messages."""
        try:
            found.path.mkdir(exist_ok=True)
            free_reserve(found.path)
            # Whatever cannot be written from here on, the next run knows what is missing.
            write_record(found.path, finished_record(record, {}, self._channels))
            # A bag without files is none.
            files = complete_files(found.path) or {found.file.name: McapWriter(found.file).close()}
            self._finish(found, record, files)
        except _WRITE_ERRORS:
            if not (found.path / RECORD_NAME).exists():
                remove_begun(found.path)
            raise

    def _finish(self, found: _OpenFolder, record: IncidentRecord, files: Mapping[str, FileContent]) -> None:
        record = finished_record(record, files, self._channels)
        finish_folder(found.path, record, files, self._channels)
        # Not before: of a run that is killed until here the next one is to say so.
        free_reserve(found.path)
        self._ended(found.path.rename(self._folder / found.name), record)

    def _give_up(self, found: _OpenFolder, error: Exception) -> None:
        """End an incident that cannot be written."""
        problem = (
            not_written(self._folder / found.name, "an incident", error)
            if isinstance(error, OSError)
            else testudo_error(error)
        )
        if self._failed is None:
            raise problem from error
        if found.writer is not None:
            found.writer.abandon()
            found.writer = None
        self._failed(found.name, problem)


def _still_missing(found: _OpenFolder, missing: Sequence[Missing]) -> Iterator[Missing]:
    """``missing``, without what the memory lacked and the disk had."""
    yield from (entry for entry in missing if entry.reason is not MissingReason.MEMORY)
    for given_up in found.given_up:
        yield from missing_for_memory(given_up, found.holds)
