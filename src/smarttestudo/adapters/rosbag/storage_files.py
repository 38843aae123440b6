# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""Opens a storage file in the way that suits its state."""

from __future__ import annotations

from contextlib import suppress
from pathlib import Path

from mcap.reader import make_reader

from smarttestudo.adapters.rosbag.intact_file import IntactFile
from smarttestudo.adapters.rosbag.mcap.outlines import mcap_outlines
from smarttestudo.adapters.rosbag.mcap.records import BROKEN
from smarttestudo.adapters.rosbag.mcap.recovered import RecoveredMcapFile
from smarttestudo.adapters.rosbag.sqlite.file import SqliteFile, sqlite_outlines
from smarttestudo.adapters.rosbag.sqlite.log import read_log
from smarttestudo.adapters.rosbag.sqlite.recovered import RecoveredSqliteFile
from smarttestudo.adapters.rosbag.stored_file import StoredFile
from smarttestudo.domain.errors import RecordingError

# rosbags gives SQLite the path as an address, in which these would name another file.
_MEANS_SOMETHING_IN_AN_ADDRESS = frozenset("?#%")


def open_storage_file(path: Path, whole_bytes: int | None = None) -> StoredFile:
    """The .db3 or .mcap file at ``path``: with rosbags if it is whole, else as far as it goes.

    ``whole_bytes`` is how long it was before it was cut off, where that is known.
    Raises ``RecordingError`` where nothing of it can be read.
    """
    return _open_mcap(path, whole_bytes) if path.suffix == ".mcap" else _open_sqlite(path)


def _open_mcap(path: Path, whole_bytes: int | None) -> StoredFile:
    if _has_full_index(path):
        with suppress(RecordingError):
            return IntactFile(path, recover=RecoveredMcapFile, outline=mcap_outlines)
    return RecoveredMcapFile(path, whole_bytes)


def _open_sqlite(path: Path) -> StoredFile:
    log = read_log(path)
    with suppress(RecordingError):
        if log is not None or _MEANS_SOMETHING_IN_AN_ADDRESS & set(str(path)):
            return SqliteFile(path, log)
        return IntactFile(path, recover=RecoveredSqliteFile, outline=sqlite_outlines)
    return RecoveredSqliteFile(path, log)


def _has_full_index(path: Path) -> bool:
    """Whether the summary lists every channel, and every chunk with its messages.

    Without that, rosbags skips chunks without a word, and refuses messages that are out of order.
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
    described = all(
        number in summary.channels and summary.channels[number].schema_id in summary.schemas
        for number in summary.statistics.channel_message_counts
    )
    return described and all(chunk.message_index_offsets for chunk in summary.chunk_indexes)
