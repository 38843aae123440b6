# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""The storage files of a bag as one recording."""

from __future__ import annotations

import heapq
from collections import Counter
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from itertools import chain
from operator import itemgetter
from pathlib import Path

from smarttestudo.adapters.rosbag import zstd_files
from smarttestudo.adapters.rosbag.channels import key_of, merged_channels
from smarttestudo.adapters.rosbag.custom_data import declared_bytes_in
from smarttestudo.adapters.rosbag.metadata import BagMetadata
from smarttestudo.adapters.rosbag.stored_file import StoredFile
from smarttestudo.domain.errors import RecordingError
from smarttestudo.domain.recording import Channel, RecordedMessage


@dataclass(frozen=True, slots=True, kw_only=True)
class RecordingPart:
    """One opened storage file: ``path`` as the user knows it, ``storage_path`` where it lies unpacked."""

    path: Path
    storage_path: Path
    file: StoredFile


class RosbagRecording:
    """A ``RecordingReader`` over storage files that may overlap in time."""

    def __init__(self, parts: Sequence[RecordingPart], metadata: BagMetadata, notices: Sequence[str]) -> None:
        self._parts = parts
        self._notices = list(notices)
        self._broken: Counter[str] = Counter()
        announced = (channel for part in parts for channel in part.file.channels.values())
        self._channels = merged_channels(chain(metadata.channels, announced))
        self.channels: Sequence[Channel] = tuple(self._channels.values())
        self.custom_data: Mapping[str, str] = metadata.custom_data
        self.declared_bytes: Mapping[str, int] = self._declared_bytes()
        filled = [part.file for part in parts if part.file.message_count]
        self.start_ns = min((file.start_ns for file in filled), default=0)
        self.end_ns = max((file.end_ns for file in filled), default=0)
        self.message_count: int | None = sum(file.message_count for file in filled)

    def messages(self) -> Iterator[RecordedMessage]:
        """All messages in time order; memory does not grow with their number."""
        filled = [part.file for part in self._parts if part.file.message_count]
        return self._messages_of(filled[0]) if len(filled) == 1 else self._merged(filled)

    def notices(self) -> Sequence[str]:
        """What was lost or odd, one line each; complete once all messages were read."""
        lost = [f"{part.path}: {notice}" for part in self._parts for notice in part.file.notices()]
        broken = [
            f"{topic}: {count} messages could not be decompressed and were left out"
            for topic, count in self._broken.items()
        ]
        return [*self._notices, *lost, *broken]

    def _merged(self, files: Sequence[StoredFile]) -> Iterator[RecordedMessage]:
        for channel, stamp_ns, payload in heapq.merge(*map(self._from_its_start, files), key=itemgetter(1)):
            if channel is not None:
                yield channel, stamp_ns, payload

    def _from_its_start(self, file: StoredFile) -> Iterator[tuple[Channel | None, int, bytes]]:
        # The merge takes the first item of all files at once; this one keeps a file unread until it is due.
        yield None, file.start_ns, b""
        yield from self._messages_of(file)

    def _messages_of(self, file: StoredFile) -> Iterator[RecordedMessage]:
        """The messages of ``file``, unpacked if the first is packed: rosbag2 packs all of a file or none."""
        channels = {number: self._channels[key_of(channel)] for number, channel in file.channels.items()}
        messages = file.messages(channels)
        first = next(messages, None)
        if first is None:
            return messages
        stored = chain((first,), messages)
        return self._unpacked(stored) if first[2].startswith(zstd_files.MAGIC) else stored

    def _unpacked(self, messages: Iterator[RecordedMessage]) -> Iterator[RecordedMessage]:
        for channel, stamp_ns, packed in messages:
            payload = zstd_files.unpack_message(packed)
            if payload is None:
                self._broken[channel.topic] += 1
            else:
                yield channel, stamp_ns, payload

    def _declared_bytes(self) -> Mapping[str, int]:
        try:
            return declared_bytes_in(self.custom_data)
        except RecordingError as error:
            self._notices.append(f"{error.cause}; the sizes in the bag are used")
            return {}
