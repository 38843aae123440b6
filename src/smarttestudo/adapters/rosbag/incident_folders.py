# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""Incidents as folders: a rosbag2 (mcap) beside ``incident.json``."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from contextlib import ExitStack
from dataclasses import dataclass, field
from pathlib import Path

from smarttestudo.adapters.files.incident_store import RECORD_NAME
from smarttestudo.adapters.files.whole_file import whole_file
from smarttestudo.adapters.json.incidents import incident_text
from smarttestudo.adapters.rosbag.writer import create_recording, require_new, write_error
from smarttestudo.domain.incident import (
    IncidentRecord,
    IncidentTopic,
    LatchedSample,
    Missing,
    incident_folder_name,
)
from smarttestudo.domain.recording import Channel, RecordingWriter, Storage
from smarttestudo.runtime.incidents.recorder import Incident
from smarttestudo.runtime.incidents.topic_ring import SourceMessage


@dataclass(frozen=True, slots=True, kw_only=True)
class _OpenFolder:
    """``messages`` and ``size_bytes`` are by topic."""

    path: Path
    opened: ExitStack
    writer: RecordingWriter
    latched: tuple[LatchedSample, ...]
    messages: dict[str, int] = field(default_factory=dict)
    size_bytes: dict[str, int] = field(default_factory=dict)


class IncidentFolders:
    """An ``IncidentSink`` that writes each incident into a folder of its own below ``folder``.

    A folder is there when its incident is whole. ``channels`` are the topics by name; messages of others are
    left out. ``written`` are the folders so far, in order.

    Raises:
        RecordingError: ``folder`` exists or cannot be made; later, when an incident cannot be written.
    """

    def __init__(self, folder: Path, channels: Mapping[str, Channel], rules_sha256: str) -> None:
        require_new(folder)
        try:
            folder.mkdir(parents=True)
        except OSError as error:
            raise write_error(folder, error) from error
        self._folder = folder
        self._channels = channels
        self._rules_sha256 = rules_sha256
        self._open: dict[Incident, _OpenFolder] = {}
        self._names: set[str] = set()
        self.written: list[Path] = []

    def begin(
        self, incident: Incident, latched: Sequence[SourceMessage], messages: Sequence[SourceMessage]
    ) -> None:
        """Write what came before; ``latched`` with the stamp of the window's start."""
        path = self._folder / self._unused_name(incident)
        opened = ExitStack()
        folder = _OpenFolder(
            path=path,
            opened=opened,
            writer=opened.enter_context(create_recording(path, storage=Storage.MCAP)),
            latched=tuple(
                LatchedSample(topic=one.topic, stamp_ns=one.stamp_ns)
                for one in latched
                if one.stamp_ns < incident.from_ns
            ),
        )
        self._open[incident] = folder
        for topic in sorted({*incident.recording.topics, *(one.topic for one in latched)}):
            if topic in self._channels:
                folder.writer.add(self._channels[topic])
        for one in latched:
            self._write(folder, one, max(one.stamp_ns, incident.from_ns))
        for one in messages:
            self._write(folder, one, one.stamp_ns)

    def take(self, incident: Incident, message: SourceMessage) -> None:
        """Write one more."""
        self._write(self._open[incident], message, message.stamp_ns)

    def end(self, incident: Incident, missing: Sequence[Missing]) -> None:
        """Have the folder appear with its record."""
        folder = self._open.pop(incident)
        folder.opened.close()
        trigger, recording = incident.trigger, incident.recording
        record = IncidentRecord(
            name=recording.name,
            rule=trigger.block.label,
            path=trigger.block.path,
            line=recording.line,
            triggered_ns=trigger.stamp_ns,
            from_ns=incident.from_ns,
            to_ns=incident.to_ns,
            values=trigger.values,
            rules_sha256=self._rules_sha256,
            topics=self._topics(folder, recording.topics),
            latched=folder.latched,
            missing=tuple(missing),
        )
        with whole_file(folder.path / RECORD_NAME, "the record of an incident") as write:
            write(incident_text(record))
        self.written.append(folder.path)

    def abort(self) -> None:
        """Leave nothing of incidents that have not ended."""
        while self._open:
            _, folder = self._open.popitem()
            folder.opened.__exit__(KeyboardInterrupt, KeyboardInterrupt(), None)

    def _topics(self, folder: _OpenFolder, recorded: Sequence[str]) -> Mapping[str, IncidentTopic]:
        return {
            topic: IncidentTopic(
                type_name=self._channels[topic].type_name if topic in self._channels else "",
                messages=folder.messages.get(topic, 0),
                size_bytes=folder.size_bytes.get(topic, 0),
            )
            for topic in sorted({*recorded, *folder.messages})
        }

    def _unused_name(self, incident: Incident) -> str:
        plain = incident_folder_name(incident.recording.name, incident.trigger.stamp_ns)
        name, number = plain, 1
        while name in self._names:
            number += 1
            name = f"{plain}-{number}"
        self._names.add(name)
        return name

    def _write(self, folder: _OpenFolder, message: SourceMessage, stamp_ns: int) -> None:
        topic = message.topic
        channel = self._channels.get(topic)
        if channel is None:
            return
        folder.writer.write(channel, stamp_ns, message.payload)
        folder.messages[topic] = folder.messages.get(topic, 0) + 1
        folder.size_bytes[topic] = folder.size_bytes.get(topic, 0) + len(message.payload)
