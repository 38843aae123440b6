# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""Writes rosbag2 recordings that appear under their name only when they are whole."""

from __future__ import annotations

import sqlite3
from collections.abc import Iterator, Mapping
from contextlib import ExitStack, contextmanager, suppress
from pathlib import Path
from typing import TYPE_CHECKING, Literal, cast

from rosbags.interfaces import Connection, Qos
from rosbags.rosbag2 import CompressionMode, StoragePlugin, Writer, WriterError
from rosbags.rosbag2.storage_mcap import McapWriter, Schema, write_schema
from rosbags.rosbag2.storage_sqlite3 import Sqlite3Writer

from smarttestudo.bags.channel_reader import ChannelKey, key_of
from smarttestudo.bags.definitions import TypeLibrary
from smarttestudo.bags.mcap.record_bytes import StoredChannel
from smarttestudo.bags.qos import qos_text
from smarttestudo.bags.recording import with_declared_bytes
from smarttestudo.domain.errors import RecordingError
from smarttestudo.domain.recording import Channel, ForeignSchema, RecordingWriter, Storage
from smarttestudo.files.outputs import require_new, write_error
from smarttestudo.files.removal import temporary_folder
from smarttestudo.files.whole_file import PARTIAL_SUFFIX

if TYPE_CHECKING:
    from rosbags.rosbag2.writer import StorageWriter


_VERSION: Literal[8] = 8
"""Of the metadata, which ``ros2 bag play`` reads from Humble on."""
_PLUGINS = {Storage.SQLITE3: StoragePlugin.SQLITE3, Storage.MCAP: StoragePlugin.MCAP}


@contextmanager
def create_recording(
    path: Path,
    *,
    storage: Storage = Storage.SQLITE3,
    declared_bytes: Mapping[str, int] | None = None,
    custom_data: Mapping[str, str] | None = None,
) -> Iterator[RecordingWriter]:
    """A new rosbag2 folder at ``path``, in place once the block ends well, and gone if it does not.

    ``declared_bytes`` are the sizes that messages of a topic stand for, and go into ``custom_data``.

    Raises:
        RecordingError: ``path`` exists, cannot be written, or the disk is full.
    """
    require_new(path)
    with ExitStack() as opened:
        with _errors_at(path):
            path.parent.mkdir(parents=True, exist_ok=True)
            made = temporary_folder(path.parent, prefix=f".{path.name}-", suffix=PARTIAL_SUFFIX)
            workshop = opened.enter_context(made)
            writer = RosbagWriter(workshop / path.name, version=_VERSION, storage_plugin=_PLUGINS[storage])
            for key, value in with_declared_bytes(custom_data or {}, declared_bytes or {}).items():
                writer.set_custom_data(key, value)
            writer.open()
        try:
            yield _RosbagRecordingWriter(path, writer)
            with _errors_at(path):
                writer.close()
                require_new(path)
                (workshop / path.name).rename(path)
        except BaseException:
            with suppress(Exception):
                writer.abort()
            raise


class _RosbagRecordingWriter:
    def __init__(self, path: Path, writer: RosbagWriter) -> None:
        self._path = path
        self._writer = writer
        self._types = TypeLibrary()
        self._connections: dict[ChannelKey, Connection] = {}

    def add(self, channel: Channel) -> None:
        """Announce ``channel``, so that it is listed even if no message of it follows."""
        if key_of(channel) in self._connections:
            return
        definition, digest = self._types.definition_and_digest(channel)
        if channel.foreign_schema is not None and not definition:
            definition = _ForeignText(channel.foreign_schema)
        with _errors_at(self._path):
            self._connections[key_of(channel)] = self._writer.add_channel(
                channel.topic,
                channel.type_name,
                definition=definition,
                digest=digest,
                serialization_format=channel.serialization_format,
                qos=cast("list[Qos]", list(channel.qos)),
            )

    def write(self, channel: Channel, stamp_ns: int, payload: bytes) -> None:
        """Append one message, adding its channel on first use."""
        connection = self._connections.get(key_of(channel))
        if connection is None:
            self.add(channel)
            connection = self._connections[key_of(channel)]
        try:
            self._writer.write(connection, stamp_ns, payload)
        except (OSError, sqlite3.Error, WriterError) as error:
            raise write_error(self._path, error) from error
        except OverflowError as error:
            cause = f"a message at {stamp_ns} ns is from a time that the file cannot hold"
            remedy = "write to SQLite (--storage sqlite3), which holds times before 1970 too"
            raise RecordingError(cause, place=str(self._path), remedy=remedy) from error


@contextmanager
def _errors_at(path: Path) -> Iterator[None]:
    try:
        yield
    except (OSError, sqlite3.Error, WriterError) as error:
        raise write_error(path, error) from error


# rosbags insists on a hash that is not empty; this one never reaches the file.
_UNKNOWN_DIGEST = "unknown"


def _without_unknown(connection: Connection) -> Connection:
    return connection._replace(digest="") if connection.digest == _UNKNOWN_DIGEST else connection


class _ForeignText(str):
    """A schema of another language, which rosbags takes for a text that it stores as UTF-8."""

    def __new__(cls, schema: ForeignSchema) -> _ForeignText:
        text = super().__new__(cls, schema.data.decode("utf-8", "replace"))
        text.schema = schema
        return text

    schema: ForeignSchema

    def encode(self, *_: str) -> bytes:
        """The bytes as they were."""
        return self.schema.data


_STAMPS = 1 << 63
_ADD_FOREIGN = (
    "INSERT INTO message_definitions"
    " (topic_type, encoding, encoded_message_definition, type_description_hash) VALUES (?, ?, ?, ?)"
)
_MOST_ROWS = 256
_MOST_ROWS_BYTES = 1_000_000


class _Sqlite3Storage(Sqlite3Writer):
    def __init__(self, path: Path, compression: CompressionMode) -> None:
        if compression is not CompressionMode.NONE:
            raise ValueError("compressed SQLite bags are not written")
        # Not rosbags' own: it takes the path as an address, in which ?, # and % mean something else.
        self.path = path / f"{path.name}.db3"
        self.conn = sqlite3.connect(self.path)
        self.conn.executescript(self.SQLITE_SCHEMA)
        self.cursor = self.conn.cursor()
        self._rows: list[tuple[int, int, bytes]] = []
        self._rows_bytes = 0

    def write(self, connection: Connection, timestamp: int, data: bytes | memoryview) -> None:
        """Keep the message until there are some: SQLite takes many rows in a fraction of the time."""
        if not -_STAMPS <= timestamp < _STAMPS:
            raise OverflowError("SQLite holds 64 bits")
        # A view may be of memory that its owner uses again.
        self._rows.append((connection.id, timestamp, bytes(data)))
        self._rows_bytes += len(data)
        if len(self._rows) >= _MOST_ROWS or self._rows_bytes >= _MOST_ROWS_BYTES:
            self._write_rows()

    def close(self, version: int, metadata: str) -> None:
        """Write what is kept, and the metadata."""
        self._write_rows()
        super().close(version, metadata)

    def _write_rows(self) -> None:
        rows, self._rows, self._rows_bytes = self._rows, [], 0
        self.cursor.executemany("INSERT INTO messages (topic_id, timestamp, data) VALUES (?, ?, ?)", rows)

    def add_msgtype(self, connection: Connection) -> None:
        definition, known = connection.msgdef.data, _without_unknown(connection)
        if isinstance(definition, _ForeignText):
            row = connection.msgtype, definition.schema.encoding, definition.schema.data, known.digest
            self.cursor.execute(_ADD_FOREIGN, row)
        elif definition:
            super().add_msgtype(known)

    def add_connection(self, connection: Connection, offered_qos_profiles: str) -> None:
        super().add_connection(_without_unknown(connection), offered_qos_profiles)


class _TypeName(str):
    """The name of a type, which is another one where its definition is: rosbags takes one for each name."""

    definition: str

    def __new__(cls, name: str, definition: str) -> _TypeName:
        made = super().__new__(cls, name)
        made.definition = definition
        return made

    def __eq__(self, other: object) -> bool:
        is_same = isinstance(other, _TypeName) and self.definition == other.definition
        return is_same and str.__eq__(self, other)

    __hash__ = str.__hash__


class _McapStorage(McapWriter):
    def add_msgtype(self, connection: Connection) -> None:
        definition = connection.msgdef.data
        if definition and not isinstance(definition, _ForeignText):
            super().add_msgtype(connection)
            return
        encoding = definition.schema.encoding if isinstance(definition, _ForeignText) else ""
        schema = Schema(len(self.schemas) + 1, connection.msgtype, encoding, definition)
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
            _TypeName(type_name, definition),
            msgdef=definition,
            rihs01=digest or _UNKNOWN_DIGEST,
            serialization_format=serialization_format,
            offered_qos_profiles=qos,
        )
        self.connections[-1] = _without_unknown(connection)
        return self.connections[-1]

    def close(self) -> None:
        """Write what is kept, and the metadata."""
        self.connections = [one._replace(msgtype=str(one.msgtype)) for one in self.connections]
        super().close()

    def write(self, connection: Connection, timestamp: int, data: bytes | memoryview) -> None:
        """Append a message of a connection of ours; rosbags would look for it among all of them each time."""
        assert self.storage is not None
        self.storage.write(connection, timestamp, data)
        self.counts[connection.id] += 1
        self.min_timestamp = min(self.min_timestamp, timestamp)
        self.max_timestamp = max(self.max_timestamp, timestamp)


def stored_channels(channels: Mapping[str, Channel]) -> dict[str, StoredChannel]:
    """``channels``, with definitions where the recording has none and ROS 2 knows the type."""
    types = TypeLibrary()
    return {topic: _stored(channel, types) for topic, channel in channels.items()}


def _stored(channel: Channel, types: TypeLibrary) -> StoredChannel:
    definition, digest = types.definition_and_digest(channel)
    return StoredChannel(
        topic=channel.topic,
        type_name=channel.type_name,
        definition=definition,
        digest=digest,
        qos_text=qos_text(channel.qos),
        serialization_format=channel.serialization_format,
    )
