# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""Metadata of a bag, in ``metadata.yaml`` or within a storage file."""

from __future__ import annotations

import struct
from collections import Counter
from collections.abc import Iterator, Mapping
from dataclasses import dataclass, field
from pathlib import Path, PurePosixPath
from typing import Any

from ruamel.yaml import YAML
from ruamel.yaml.error import YAMLError

from smarttestudo.bags import magic
from smarttestudo.bags.channel_reader import ChannelReader, with_escapes
from smarttestudo.bags.metadata_text import METADATA_NAME
from smarttestudo.domain.errors import RecordingError
from smarttestudo.domain.recording import Channel, Storage
from smarttestudo.domain.units import counted, grouped
from smarttestudo.files.input_file import require_file

_MOST_NAMES = 8


@dataclass(frozen=True, slots=True, kw_only=True)
class MessageCounts:
    """Messages in all, by topic, and by the name of their file; all are 0 or empty where nothing tells."""

    total: int = 0
    topics: Mapping[str, int] = field(default_factory=dict)
    files: Mapping[str, int] = field(default_factory=dict)

    def shares(self, held: MessageCounts) -> Iterator[float]:
        """How much of these is ``held``, in all, by topic and by file: no gain hides a loss."""
        for promised, found in (
            ({"": self.total}, {"": held.total}),
            (self.topics, held.topics),
            (self.files, held.files),
        ):
            # Not each topic or file need be counted.
            if total := max(sum(promised.values()), self.total):
                yield 1 - sum(max(count - found.get(name, 0), 0) for name, count in promised.items()) / total

    def notice(self, held: MessageCounts) -> str | None:
        """Where ``held`` differs from these, for topics and files that these name."""
        differ = _differing(self.topics, held.topics)
        if len(self.files) > 1 or self.total == held.total:
            differ += _differing(self.files, held.files)
        if self.total and self.total != held.total:
            text = f"its metadata count {_both(counted(self.total, 'message'), held.total)}"
        elif differ:
            text = "its metadata count other messages than can be read"
        else:
            return None
        listed = [f"of {name}" for name in differ[:_MOST_NAMES]]
        if len(differ) > _MOST_NAMES:
            listed.append(f"{grouped(len(differ) - _MOST_NAMES)} more differ")
        return "; ".join((text, *listed))


def _differing(promised: Mapping[str, int], held: Mapping[str, int]) -> list[str]:
    return [
        f"{name} {_both(grouped(count), held.get(name, 0))}"
        for name, count in promised.items()
        if count != held.get(name, 0)
    ]


def _both(promised: str, held: int) -> str:
    return f"{promised}, {grouped(held)} can be read"


MAX_BYTES = 50_000_000
_ROOT = "rosbag2_bagfile_information"
_NOTHING = (None, "", "~", "null")
_KNOWN_COMPRESSION = ("", "zstd")
_WRONG_SHAPE = (YAMLError, LookupError, TypeError, ValueError, AttributeError, RecursionError)


@dataclass(frozen=True, slots=True, kw_only=True)
class BagMetadata:
    """The storage files in order, the channels with their QoS, and the author's own notes.

    ``file_names`` are as they are written, ``notices`` what of it makes no sense.
    """

    file_names: tuple[str, ...] = ()
    counts: MessageCounts = field(default_factory=MessageCounts)
    channels: tuple[Channel, ...] = ()
    custom_data: Mapping[str, str] = field(default_factory=dict)
    storage: str = ""
    compression: str = ""
    packs_messages: bool = False
    notices: tuple[str, ...] = ()


def read_metadata(folder: Path) -> BagMetadata:
    """The metadata of the bag in ``folder``.

    Raises ``RecordingError`` for a file that is missing, broken, or of another shape.
    """
    path = folder / METADATA_NAME
    try:
        require_file(path)
        if path.stat().st_size > MAX_BYTES:
            raise RecordingError(f"{METADATA_NAME} is larger than 50 MB", place=str(folder))
        # A byte of another encoding costs itself, and a topic of that name is the one of the storage file.
        text = path.read_bytes().decode("utf-8", "backslashreplace")
    except FileNotFoundError as error:
        raise RecordingError(f"{METADATA_NAME} is missing", place=str(folder)) from error
    except (OSError, ValueError) as error:
        raise RecordingError(f"{METADATA_NAME} cannot be read", place=str(folder)) from error
    try:
        return _metadata(_loaded(text)[_ROOT])
    except _WRONG_SHAPE as error:
        raise RecordingError(f"{METADATA_NAME} is broken", place=str(folder)) from error


def embedded_metadata(path: Path, storage: Storage) -> BagMetadata | None:
    """The metadata that Iron and later also write into the storage file at ``path``, if they are there."""
    text = _text_in_mcap(path) if storage is Storage.MCAP else _text_in_sqlite(path)
    try:
        return None if text is None or len(text) > MAX_BYTES else _metadata(_loaded(text))
    except _WRONG_SHAPE:
        return None


def require_known_formats(metadata: BagMetadata, folder: Path) -> None:
    """Raise ``RecordingError`` where the bag needs a plugin for its storage or compression."""
    if metadata.storage not in {"", *(storage.value for storage in Storage)}:
        cause = f"unknown storage {metadata.storage!r}"
        remedy = "convert it to sqlite3 or mcap with `ros2 bag convert`"
        raise RecordingError(cause, place=str(folder), remedy=remedy)
    if metadata.compression not in _KNOWN_COMPRESSION:
        cause = f"unknown compression {metadata.compression!r}"
        remedy = "convert it to zstd or none with `ros2 bag convert`"
        raise RecordingError(cause, place=str(folder), remedy=remedy)


def _text_in_mcap(path: Path) -> str | None:
    from smarttestudo.bags.mcap.summary import read_metadata as read_record  # noqa: PLC0415

    try:
        with path.open("rb") as file:
            text = read_record(file, "rosbag2").get("serialized_metadata")
            return None if text is None else with_escapes(text)
    except (struct.error, MemoryError, OSError, *_WRONG_SHAPE):
        return None


def _text_in_sqlite(path: Path) -> str | None:
    from smarttestudo.bags.sqlite.database import BROKEN, open_database, require_tables, rows_of  # noqa: PLC0415

    try:
        with open_database(path) as database:
            database.execute("PRAGMA writable_schema=ON")
            require_tables(database, "metadata")
            texts = [row["metadata"] for _, row in rows_of(database, "metadata", ("metadata",))]
    except (RecordingError, *BROKEN):
        return None
    return with_escapes(texts[-1]) if texts else None


def _loaded(text: str) -> Any:
    """The values of a YAML text, all as they are written: rosbag2 quotes no ``007`` that is a text."""
    return YAML(typ="base").load(text)


def _metadata(values: Mapping[str, Any]) -> BagMetadata:
    """The metadata in ``values``; all but the list of files may be missing, as where people wrote it."""
    reader = ChannelReader()
    topics = values.get("topics_with_message_count")
    notes = values.get("custom_data")
    channels = [_channel(entry, reader) for entry in ([] if topics in _NOTHING else topics)]
    return BagMetadata(
        file_names=tuple(_scalar(name) for name in values["relative_file_paths"]),
        counts=_counts(values),
        channels=tuple(channel for channel in channels if channel is not None),
        custom_data=(
            {} if notes in _NOTHING else {_scalar(key): _scalar(value) for key, value in notes.items()}
        ),
        storage=_text(values.get("storage_identifier")),
        compression=_text(values.get("compression_format")).lower(),
        packs_messages=_text(values.get("compression_mode")).lower() == "message",
        notices=(
            *reader.notices,
            *([f"a topic of {METADATA_NAME} makes no sense and was left out"] if None in channels else []),
        ),
    )


def _counts(values: Mapping[str, Any]) -> MessageCounts:
    """The messages of topics, and from version 5 on of files, as far as the metadata have them."""
    topics: Counter[str] = Counter()
    for entry in _entries(values, "topics_with_message_count"):
        topic = entry.get("topic_metadata")
        name, count = topic.get("name") if isinstance(topic, Mapping) else None, _count(entry)
        if isinstance(name, str) and count is not None:
            topics[name] += count
    files = {
        file_key(_text(entry.get("path"))): count
        for entry in _entries(values, "files")
        if (count := _count(entry)) is not None
    }
    named = {file_key(_scalar(name)) for name in values["relative_file_paths"]}
    # Metadata that are written before the recording begins have nothing but zeros.
    return MessageCounts(
        total=_count(values) or 0,
        topics=topics if topics.total() else {},
        files={name: count for name, count in files.items() if name in named} if any(files.values()) else {},
    )


def file_key(name: str) -> str:
    """The name by which the metadata count the messages of the file ``name``, packed or not."""
    return str(PurePosixPath(name.replace("\\", "/"))).removesuffix(magic.ZSTD_SUFFIX)


def _entries(values: Mapping[str, Any], name: str) -> Iterator[Mapping[str, Any]]:
    stored = values.get(name)
    return (entry for entry in stored if isinstance(entry, Mapping)) if isinstance(stored, list) else iter(())


def _count(entry: Mapping[str, Any]) -> int | None:
    text = entry.get("message_count")
    return int(text) if isinstance(text, str) and text.isdecimal() else None


def _channel(stored: object, reader: ChannelReader) -> Channel | None:
    """The channel of an entry, ``None`` where that has none."""
    entry = stored.get("topic_metadata") if isinstance(stored, Mapping) else None
    if not isinstance(entry, Mapping) or not entry.get("name") or not entry.get("type"):
        return None
    return reader.channel(
        topic=_scalar(entry["name"]),
        type_name=_scalar(entry["type"]),
        serialization_format=_text(entry.get("serialization_format")) or "cdr",
        qos=entry.get("offered_qos_profiles"),
        digest=_text(entry.get("type_description_hash")),
    )


def _text(value: object) -> str:
    return "" if value in _NOTHING else _scalar(value)


def _scalar(value: object) -> str:
    """A text. Raises ``TypeError`` for a list, of which aliases may make one that never ends."""
    if not isinstance(value, str):
        raise TypeError("a text was expected")
    return value
