# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""An .mcap file with a whole index."""

from __future__ import annotations

from collections.abc import Iterator
from functools import partial
from pathlib import Path
from typing import cast

from mcap.reader import make_reader
from rosbags.interfaces import Connection, ConnectionExtRosbag2, MessageDefinitionFormat
from rosbags.rosbag2 import Reader

from smarttestudo.bags.definition_text import normal_definition
from smarttestudo.bags.mcap.outlines import mcap_outlines
from smarttestudo.bags.mcap.records import BROKEN
from smarttestudo.bags.mcap.recovered import RecoveredMcapFile
from smarttestudo.bags.qos import is_transient_local
from smarttestudo.bags.stored_file import ChannelsByNumber, ContinuedFile, Outline
from smarttestudo.domain.errors import RecordingError
from smarttestudo.domain.recording import Channel, RecordedMessage
from smarttestudo.domain.units import LAST_STAMP_NS


def has_full_index(path: Path) -> bool:
    """Whether the summary lists every channel, and every chunk with its messages.

    Without that, rosbags skips chunks without a word, and refuses messages that are out of order. Nor do
    times count that no clock of ROS has.
    """
    try:
        with path.open("rb") as file:
            summary = make_reader(file).get_summary()
    except BROKEN:
        return False
    if summary is None or summary.statistics is None:
        return False
    if summary.statistics.message_count and not summary.chunk_indexes:
        return False
    if summary.statistics.message_end_time > LAST_STAMP_NS:
        return False
    described = all(
        number in summary.channels and summary.channels[number].schema_id in summary.schemas
        for number in summary.statistics.channel_message_counts
    )
    return described and all(chunk.message_index_offsets for chunk in summary.chunk_indexes)


class McapFile(ContinuedFile):
    """Reads with rosbags; where that fails half-way, the file is reopened as a damaged one and read on.

    Raises ``RecordingError`` where rosbags cannot open it.
    """

    def __init__(self, path: Path) -> None:
        self._path = path
        try:
            self._reader = Reader(path)
            self._reader.open()
        except Exception as error:  # rosbags leaks the errors of zstd, lz4, struct and ord()
            raise RecordingError(f"rosbags cannot read it: {error}", place=str(path)) from error
        self.channels: ChannelsByNumber = {
            connection.id: _channel(connection) for connection in self._reader.connections
        }
        super().__init__(
            partial(RecoveredMcapFile, path),
            message_count=self._reader.message_count,
            start_ns=self._reader.start_time,
            end_ns=self._reader.end_time - 1,
        )

    def outlines(self, channels: ChannelsByNumber, head_bytes: int) -> Iterator[Outline]:
        """The outlines of ``messages``, without reading payloads."""
        return mcap_outlines(self._path, channels, head_bytes)

    def close(self) -> None:
        """Let go of the file."""
        self._reader.close()

    def _as_stored(self, channels: ChannelsByNumber) -> Iterator[RecordedMessage]:
        wanted = [connection for connection in self._reader.connections if connection.id in channels]
        # To rosbags, no connection means all of them.
        for connection, stamp_ns, payload in self._reader.messages(wanted) if wanted else ():
            if not (isinstance(stamp_ns, int) and isinstance(payload, bytes)):
                raise TypeError("a message without stamp or payload")
            yield channels[connection.id], stamp_ns, payload


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
