# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""rosbags' writer, extended by topics of which nobody knows the type's definition or hash.

``ros2 bag play`` needs neither, so such topics are written as rosbag2 itself does: an empty hash, no row of
definitions in SQLite, and in MCAP a schema without encoding (https://mcap.dev/spec#schema-op0x03).
"""

from __future__ import annotations

import sqlite3
from collections.abc import Mapping
from pathlib import Path
from typing import TYPE_CHECKING

from rosbags.interfaces import Connection, Qos
from rosbags.rosbag2 import CompressionMode, StoragePlugin, Writer
from rosbags.rosbag2.storage_mcap import McapWriter, Schema, write_schema
from rosbags.rosbag2.storage_sqlite3 import Sqlite3Writer

if TYPE_CHECKING:
    from rosbags.rosbag2.writer import StorageWriter

# rosbags insists on a hash that is not empty; this one never reaches the file.
_UNKNOWN_DIGEST = "unknown"


def _without_unknown(connection: Connection) -> Connection:
    return connection._replace(digest="") if connection.digest == _UNKNOWN_DIGEST else connection


class _Sqlite3Storage(Sqlite3Writer):
    def __init__(self, path: Path, compression: CompressionMode) -> None:
        if compression is not CompressionMode.NONE:
            raise ValueError("compressed SQLite bags are not written")
        # Not rosbags' own: it takes the path as an address, in which ?, # and % mean something else.
        self.path = path / f"{path.name}.db3"
        self.conn = sqlite3.connect(self.path)
        self.conn.executescript(self.SQLITE_SCHEMA)
        self.cursor = self.conn.cursor()

    def add_msgtype(self, connection: Connection) -> None:
        if connection.msgdef.data:
            super().add_msgtype(_without_unknown(connection))

    def add_connection(self, connection: Connection, offered_qos_profiles: str) -> None:
        super().add_connection(_without_unknown(connection), offered_qos_profiles)


class _McapStorage(McapWriter):
    def add_msgtype(self, connection: Connection) -> None:
        if connection.msgdef.data:
            super().add_msgtype(connection)
            return
        schema = Schema(len(self.schemas) + 1, connection.msgtype, "", "")
        self.schemas.append(schema)
        write_schema(self.chunk.bio, schema)


class RosbagWriter(Writer):
    """Writes channels whose definition or hash is empty, too."""

    STORAGE_PLUGINS: Mapping[StoragePlugin, type[StorageWriter]] = {
        StoragePlugin.SQLITE3: _Sqlite3Storage,
        StoragePlugin.MCAP: _McapStorage,
    }

    def add_channel(
        self,
        topic: str,
        type_name: str,
        *,
        definition: str,
        digest: str,
        serialization_format: str,
        qos: list[Qos],
    ) -> Connection:
        """Announce a topic; give the connection that its messages are written to."""
        connection = self.add_connection(
            topic,
            type_name,
            msgdef=definition,
            rihs01=digest or _UNKNOWN_DIGEST,
            serialization_format=serialization_format,
            offered_qos_profiles=qos,
        )
        self.connections[-1] = _without_unknown(connection)
        return self.connections[-1]

    def write(self, connection: Connection, timestamp: int, data: bytes | memoryview) -> None:
        """Append a message of a connection of ours; rosbags would look for it among all of them each time."""
        assert self.storage is not None
        self.storage.write(connection, timestamp, data)
        self.counts[connection.id] += 1
        self.min_timestamp = min(self.min_timestamp, timestamp)
        self.max_timestamp = max(self.max_timestamp, timestamp)
