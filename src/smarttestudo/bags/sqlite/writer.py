# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""Writes storage files of SQLite as rosbag2 does from Iron on; Humble's reads them, too."""

from __future__ import annotations

import sqlite3
from collections import Counter
from pathlib import Path

from smarttestudo.bags.mcap.record_bytes import Schema, StoredChannel
from smarttestudo.bags.mcap.writer import FileContent, file_content

_TABLES = """
CREATE TABLE schema (schema_version INTEGER PRIMARY KEY, ros_distro TEXT NOT NULL);
CREATE TABLE metadata (id INTEGER PRIMARY KEY, metadata_version INTEGER NOT NULL, metadata TEXT NOT NULL);
CREATE TABLE topics (
    id INTEGER PRIMARY KEY, name TEXT NOT NULL, type TEXT NOT NULL, serialization_format TEXT NOT NULL,
    offered_qos_profiles TEXT NOT NULL, type_description_hash TEXT NOT NULL
);
CREATE TABLE message_definitions (
    id INTEGER PRIMARY KEY, topic_type TEXT NOT NULL, encoding TEXT NOT NULL,
    encoded_message_definition TEXT NOT NULL, type_description_hash TEXT NOT NULL
);
CREATE TABLE messages (
    id INTEGER PRIMARY KEY, topic_id INTEGER NOT NULL, timestamp INTEGER NOT NULL, data BLOB NOT NULL
);
CREATE INDEX timestamp_idx ON messages (timestamp ASC);
INSERT INTO schema VALUES (4, 'smarttestudo');
"""
_ADD_DEFINITION = (
    "INSERT INTO message_definitions"
    " (topic_type, encoding, encoded_message_definition, type_description_hash) VALUES (?, ?, ?, ?)"
)
_ADD_MESSAGES = "INSERT INTO messages (topic_id, timestamp, data) VALUES (?, ?, ?)"
_ADD_METADATA = "INSERT INTO metadata (metadata_version, metadata) VALUES (8, ?)"
_MOST_ROWS = 256
_MOST_ROWS_BYTES = 1_000_000
_STAMPS = 1 << 63


class SqliteWriter:
    """A new file at ``path``. Calls raise ``sqlite3.Error``."""

    def __init__(self, path: Path) -> None:
        self._database = sqlite3.connect(path)
        self._database.executescript(_TABLES)
        self._channels: dict[StoredChannel, int] = {}
        self._schemas: set[Schema] = set()
        self._messages, self._payload_bytes = Counter[int](), Counter[int]()
        self._stamps_ns: tuple[int, int, int] | None = None
        """The least, the greatest and the last one."""
        self._rows: list[tuple[int, int, bytes]] = []
        self._rows_bytes = 0

    def add(self, channel: StoredChannel) -> int:
        """Have the channel listed though no message of it follows; its number."""
        return self._channels.get(channel) or self._add(channel)

    def write(self, channel: StoredChannel, stamp_ns: int, payload: bytes) -> None:
        """Append a message; ``OverflowError`` for a stamp that the file cannot hold."""
        if not -_STAMPS <= stamp_ns < _STAMPS:
            raise OverflowError("SQLite holds 64 bits")
        number = self.add(channel)
        self._messages[number] += 1
        self._payload_bytes[number] += len(payload)
        first_ns, last_ns, _ = self._stamps_ns or (stamp_ns, stamp_ns, stamp_ns)
        self._stamps_ns = min(first_ns, stamp_ns), max(last_ns, stamp_ns), stamp_ns
        # SQLite takes many rows in a fraction of the time; a view may be of memory that is used again.
        self._rows.append((number, stamp_ns, bytes(payload)))
        self._rows_bytes += len(payload)
        if len(self._rows) >= _MOST_ROWS or self._rows_bytes >= _MOST_ROWS_BYTES:
            self._write_rows()

    def content(self) -> FileContent:
        """Content so far."""
        first_ns, last_ns, final_ns = self._stamps_ns or (0, 0, 0)
        return file_content(
            self._channels,
            self._messages,
            self._payload_bytes,
            first_ns=first_ns,
            last_ns=last_ns,
            final_ns=final_ns,
        )

    def close(self, metadata: str) -> FileContent:
        """Write what is kept, and the ``metadata`` of the bag."""
        self._write_rows()
        self._database.execute(_ADD_METADATA, (metadata,))
        self._database.commit()
        self._database.close()
        return self.content()

    def abandon(self) -> None:
        """Leave the file as it is."""
        self._database.close()

    def _add(self, channel: StoredChannel) -> int:
        number = self._channels[channel] = len(self._channels) + 1
        row = (channel.topic, channel.type_name, channel.serialization_format, channel.qos_text)
        self._database.execute("INSERT INTO topics VALUES (?, ?, ?, ?, ?, ?)", (number, *row, channel.digest))
        self._define(channel)
        return number

    def _define(self, channel: StoredChannel) -> None:
        name, encoding, definition = channel.schema
        is_none = not definition and channel.encoding is None
        if is_none or channel.schema in self._schemas:
            return
        self._schemas.add(channel.schema)
        stored = definition if channel.encoding is None else definition.encode("utf-8", "surrogateescape")
        self._database.execute(_ADD_DEFINITION, (name, encoding, stored, channel.digest))

    def _write_rows(self) -> None:
        rows, self._rows, self._rows_bytes = self._rows, [], 0
        self._database.executemany(_ADD_MESSAGES, rows)
