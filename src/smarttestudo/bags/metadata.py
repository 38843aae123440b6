# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""Metadata of a bag, in ``metadata.yaml`` or within a storage file."""

from __future__ import annotations

import os
from collections.abc import Mapping
from contextlib import closing
from dataclasses import field
from pathlib import Path, PurePosixPath
from typing import Any
from urllib.parse import quote

from ruamel.yaml import YAML
from ruamel.yaml.error import YAMLError

from smarttestudo.bags.metadata_text import METADATA_NAME
from smarttestudo.bags.qos import QosReader, is_transient_local
from smarttestudo.domain.dataclass import dataclass
from smarttestudo.domain.errors import RecordingError
from smarttestudo.domain.recording import Channel, Storage
from smarttestudo.files.input_file import require_file

MAX_BYTES = 50_000_000
_ROOT = "rosbag2_bagfile_information"
_NOTHING = (None, "", "~", "null")
_KNOWN_COMPRESSION = ("", "zstd")
_WRONG_SHAPE = (YAMLError, LookupError, TypeError, ValueError, AttributeError, RecursionError)


@dataclass(frozen=True, slots=True, kw_only=True)
class BagMetadata:
    """The storage files in order, the channels with their QoS, and the author's own notes.

    ``message_count`` is 0 where it does not tell.
    """

    file_names: tuple[str, ...] = ()
    message_count: int = 0
    channels: tuple[Channel, ...] = ()
    custom_data: Mapping[str, str] = field(default_factory=dict)
    storage: str = ""
    compression: str = ""


def read_metadata(folder: Path) -> BagMetadata:
    """The metadata of the bag in ``folder``.

    Raises ``RecordingError`` for a file that is missing, broken, or of another shape.
    """
    path = folder / METADATA_NAME
    try:
        require_file(path)
        if path.stat().st_size > MAX_BYTES:
            raise RecordingError(f"{METADATA_NAME} is larger than 50 MB", place=str(folder))
        text = path.read_text("utf-8")
    except FileNotFoundError as error:
        raise RecordingError(f"{METADATA_NAME} is missing", place=str(folder)) from error
    except (OSError, ValueError) as error:
        raise RecordingError(f"{METADATA_NAME} cannot be read", place=str(folder)) from error
    try:
        return _metadata(_loaded(text)[_ROOT])
    except _WRONG_SHAPE as error:
        raise RecordingError(f"{METADATA_NAME} is broken", place=str(folder)) from error


def embedded_metadata(path: Path) -> BagMetadata | None:
    """The metadata that Iron and later also write into the storage file at ``path``, if they are there."""
    text = _text_in_mcap(path) if path.suffix == ".mcap" else _text_in_sqlite(path)
    try:
        return None if text is None else _metadata(_loaded(text))
    except _WRONG_SHAPE:
        return None


def require_known_formats(metadata: BagMetadata, folder: Path) -> None:
    """Raise ``RecordingError`` where the bag needs a plugin for its storage or compression."""
    if metadata.storage not in {storage.value for storage in Storage}:
        cause = f"unknown storage {metadata.storage!r}"
        remedy = "convert it to sqlite3 or mcap with `ros2 bag convert`"
        raise RecordingError(cause, place=str(folder), remedy=remedy)
    if metadata.compression not in _KNOWN_COMPRESSION:
        cause = f"unknown compression {metadata.compression!r}"
        remedy = "convert it to zstd or none with `ros2 bag convert`"
        raise RecordingError(cause, place=str(folder), remedy=remedy)


def _text_in_mcap(path: Path) -> str | None:
    from mcap.reader import make_reader  # noqa: PLC0415  slow to import

    from smarttestudo.bags.mcap.records import BROKEN  # noqa: PLC0415

    try:
        with path.open("rb") as file:
            for record in make_reader(file).iter_metadata():
                if record.name == "rosbag2":
                    return record.metadata.get("serialized_metadata")
    except (*_WRONG_SHAPE, *BROKEN, OSError):
        pass
    return None


def _text_in_sqlite(path: Path) -> str | None:
    import sqlite3  # noqa: PLC0415  slow to import

    address = f"file:{quote(os.fsencode(path.absolute()))}?mode=ro&immutable=1"
    try:
        with closing(sqlite3.connect(address, uri=True)) as database:
            database.execute("PRAGMA writable_schema=ON")
            row = database.execute("SELECT metadata FROM metadata ORDER BY id DESC LIMIT 1").fetchone()
    except (sqlite3.Error, *_WRONG_SHAPE):
        return None
    return None if row is None else str(row[0])


def _loaded(text: str) -> Any:
    """The values of a YAML text, all as they are written: rosbag2 quotes no ``007`` that is a text."""
    return YAML(typ="base").load(text)


def _metadata(values: Mapping[str, Any]) -> BagMetadata:
    qos = QosReader()
    topics = [entry["topic_metadata"] for entry in values["topics_with_message_count"]]
    notes = values.get("custom_data")
    return BagMetadata(
        # Up to version 3, the names began with the bag's folder.
        file_names=tuple(PurePosixPath(str(name)).name for name in values["relative_file_paths"]),
        message_count=int(values.get("message_count") or 0),
        channels=tuple(_channel(topic, qos.read(topic.get("offered_qos_profiles"))) for topic in topics),
        custom_data={} if notes in _NOTHING else {key: str(value) for key, value in notes.items()},
        storage=str(values["storage_identifier"]),
        compression=_text(values.get("compression_format")).lower(),
    )


def _channel(entry: Mapping[str, Any], qos: tuple[object, ...]) -> Channel:
    return Channel(
        topic=str(entry["name"]),
        type_name=str(entry["type"]),
        digest=_text(entry.get("type_description_hash")),
        qos=qos,
        serialization_format=str(entry["serialization_format"]),
        transient_local=is_transient_local(qos),
    )


def _text(value: object) -> str:
    return "" if value in _NOTHING else str(value)
