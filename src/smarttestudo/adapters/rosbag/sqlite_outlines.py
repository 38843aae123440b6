# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""The messages of a whole .db3 file without their payloads."""

from __future__ import annotations

from collections.abc import Iterator
from pathlib import Path

import apsw

from smarttestudo.adapters.rosbag.sqlite_database import open_database
from smarttestudo.adapters.rosbag.sqlite_log import WriteAheadLog
from smarttestudo.adapters.rosbag.stored_file import ChannelsByNumber, Outline, OutlineError

# SQLite knows the length of a blob from the head of its row, and leaves the pages that hold the rest alone.
_LENGTHS = """
SELECT topic_id, timestamp, CASE typeof(data) WHEN 'blob' THEN length(data) END, x''
FROM messages ORDER BY timestamp, id
"""
_HEADS = _LENGTHS.replace("x''", "substr(data, 1, ?)")


def sqlite_outlines(
    path: Path, channels: ChannelsByNumber, head_bytes: int, log: WriteAheadLog | None = None
) -> Iterator[Outline]:
    """The outlines of the messages of ``channels`` in the database at ``path``, in time order.

    Raises ``OutlineError`` at a row that is no message, or where SQLite cannot read on.
    """
    try:
        with open_database(path, log) as database:
            rows = database.execute(_HEADS, (head_bytes,)) if head_bytes else database.execute(_LENGTHS)
            for number, stamp_ns, size_bytes, head in rows:
                if not (
                    isinstance(size_bytes, int) and isinstance(stamp_ns, int) and isinstance(head, bytes)
                ):
                    raise OutlineError("a row without stamp or payload")
                if number in channels:
                    yield channels[number], stamp_ns, size_bytes, head
    except apsw.Error as error:
        raise OutlineError(str(error)) from error
