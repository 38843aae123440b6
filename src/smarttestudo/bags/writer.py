# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""Writes rosbag2 recordings that appear under their name only when they are whole."""

from __future__ import annotations

import sqlite3
import struct
from collections.abc import Iterator, Mapping
from contextlib import ExitStack, contextmanager, suppress
from pathlib import Path

from smarttestudo.bags.channel_reader import ChannelKey, key_of
from smarttestudo.bags.definitions import TypeLibrary
from smarttestudo.bags.mcap.record_bytes import StoredChannel
from smarttestudo.bags.mcap.writer import McapWriter
from smarttestudo.bags.metadata_text import METADATA_NAME, information, metadata_text
from smarttestudo.bags.qos import qos_text
from smarttestudo.bags.recording import with_declared_bytes
from smarttestudo.bags.sqlite.writer import SqliteWriter
from smarttestudo.domain.errors import RecordingError
from smarttestudo.domain.recording import Channel, RecordingWriter, Storage
from smarttestudo.files.outputs import require_new, write_error
from smarttestudo.files.removal import temporary_folder
from smarttestudo.files.whole_file import PARTIAL_SUFFIX

_WRITERS = {Storage.SQLITE3: (SqliteWriter, "db3"), Storage.MCAP: (McapWriter, "mcap")}
_WRITE_ERRORS = (OSError, sqlite3.Error)


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
    notes = with_declared_bytes(custom_data or {}, declared_bytes or {})
    with ExitStack() as opened:
        with _errors_at(path):
            path.parent.mkdir(parents=True, exist_ok=True)
            made = temporary_folder(path.parent, prefix=f".{path.name}-", suffix=PARTIAL_SUFFIX)
            folder = opened.enter_context(made) / path.name
            folder.mkdir()
            writer = _FolderWriter(folder, path, storage)
        try:
            yield writer
            with _errors_at(path):
                writer.close(notes)
                require_new(path)
                folder.rename(path)
        except BaseException:
            with suppress(Exception):
                writer.abandon()
            raise


class _FolderWriter:
    """Writes into ``folder`` what appears at ``path``."""

    def __init__(self, folder: Path, path: Path, storage: Storage) -> None:
        make, suffix = _WRITERS[storage]
        self._folder = folder
        self._path = path
        self._storage = storage
        self._file_name = f"{path.name}.{suffix}"
        self._file = make(folder / self._file_name)
        self._types = TypeLibrary()
        self._channels: dict[ChannelKey, StoredChannel] = {}

    def add(self, channel: Channel) -> None:
        """Announce ``channel``, so that it is listed even if no message of it follows."""
        if key_of(channel) not in self._channels:
            stored = self._channels[key_of(channel)] = _stored(channel, self._types)
            with _errors_at(self._path):
                self._file.add(stored)

    def write(self, channel: Channel, stamp_ns: int, payload: bytes) -> None:
        """Append one message, adding its channel on first use."""
        stored = self._channels.get(key_of(channel))
        if stored is None:
            self.add(channel)
            stored = self._channels[key_of(channel)]
        try:
            self._file.write(stored, stamp_ns, payload)
        except _WRITE_ERRORS as error:
            raise write_error(self._path, error) from error
        except (OverflowError, struct.error) as error:
            cause = f"a message at {stamp_ns} ns is from a time that the file cannot hold"
            remedy = "write to SQLite (--storage sqlite3), which holds times before 1970 too"
            raise RecordingError(cause, place=str(self._path), remedy=remedy) from error

    def close(self, custom_data: Mapping[str, str]) -> None:
        """Write what is kept, and the metadata."""
        files, channels = {self._file_name: self._file.content()}, list(self._channels.values())
        storage = self._storage.value
        self._file.close(information(files, channels, storage=storage, custom_data=custom_data))
        text = metadata_text(files, channels, storage=storage, custom_data=custom_data)
        (self._folder / METADATA_NAME).write_text(text, encoding="utf-8")

    def abandon(self) -> None:
        """Leave the files as they are."""
        self._file.abandon()


@contextmanager
def _errors_at(path: Path) -> Iterator[None]:
    try:
        yield
    except _WRITE_ERRORS as error:
        raise write_error(path, error) from error


def stored_channels(channels: Mapping[str, Channel]) -> dict[str, StoredChannel]:
    """``channels``, with definitions where the recording has none and ROS 2 knows the type."""
    types = TypeLibrary()
    return {topic: _stored(channel, types) for topic, channel in channels.items()}


def _stored(channel: Channel, types: TypeLibrary) -> StoredChannel:
    definition, digest = types.definition_and_digest(channel)
    encoding, schema = None, channel.foreign_schema
    if schema is not None and not definition:
        definition, encoding = schema.data.decode("utf-8", "surrogateescape"), schema.encoding
    return StoredChannel(
        topic=channel.topic,
        type_name=channel.type_name,
        definition=definition,
        digest=digest,
        qos_text=qos_text(channel.qos),
        serialization_format=channel.serialization_format,
        encoding=encoding,
    )
