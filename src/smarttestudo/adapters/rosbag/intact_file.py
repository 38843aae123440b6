# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""A storage file that rosbags reads."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from functools import partial
from pathlib import Path
from typing import cast

from rosbags.interfaces import Connection, ConnectionExtRosbag2, MessageDefinitionFormat
from rosbags.rosbag2 import Reader

from smarttestudo.adapters.rosbag.definitions import normal_definition
from smarttestudo.adapters.rosbag.qos import is_transient_local
from smarttestudo.adapters.rosbag.stored_file import ChannelsByNumber, ContinuedFile, Outline, StoredFile
from smarttestudo.domain.errors import RecordingError
from smarttestudo.domain.recording import Channel

OutlineReader = Callable[[Path, ChannelsByNumber, int], Iterator[Outline]]


class IntactFile(ContinuedFile):
    """Reads with rosbags; where that fails half-way, ``recover`` reopens the file and reading goes on.

    ``outline`` reads the outlines of the messages in the file, as ``StoredFile.outlines`` does.
    """

    def __init__(self, path: Path, recover: Callable[[Path], StoredFile], outline: OutlineReader) -> None:
        self._path = path
        self._outline = outline
        try:
            self._reader = Reader(path)
            self._reader.open()
        except Exception as error:  # rosbags leaks the errors of apsw, zstd, lz4, struct and ord()
            raise RecordingError(f"rosbags cannot read it: {error}", place=str(path)) from error
        self.channels: ChannelsByNumber = {
            connection.id: _channel(connection) for connection in self._reader.connections
        }
        self.start_ns = self._reader.start_time
        self.end_ns = self._reader.end_time - 1
        super().__init__(partial(recover, path), self._reader.message_count)

    def outlines(self, channels: ChannelsByNumber, head_bytes: int) -> Iterator[Outline]:
        """The outlines of ``messages``, without reading payloads."""
        return self._outline(self._path, channels, head_bytes)

    def close(self) -> None:
        """Let go of the file."""
        self._reader.close()

    def _rows(self) -> Iterator[tuple[object, object, object]]:
        return ((connection.id, stamp_ns, data) for connection, stamp_ns, data in self._reader.messages())


def _channel(connection: Connection) -> Channel:
    stored = cast("ConnectionExtRosbag2", connection.ext)
    definition = connection.msgdef
    return Channel(
        topic=connection.topic,
        type_name=connection.msgtype,
        definition=normal_definition(
            definition.data,
            type_name=connection.msgtype,
            is_idl=definition.format is MessageDefinitionFormat.IDL,
        ),
        digest=connection.digest,
        qos=tuple(stored.offered_qos_profiles),
        serialization_format=stored.serialization_format,
        transient_local=is_transient_local(stored.offered_qos_profiles),
    )
