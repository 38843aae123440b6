# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""The messages of a whole .db3 file without their payloads."""

from __future__ import annotations

import sqlite3
from collections.abc import Iterator
from contextlib import closing
from pathlib import Path
from urllib.parse import quote

from smarttestudo.adapters.rosbag.stored_file import ChannelsByNumber, Outline, OutlineError

# SQLite knows the length of a blob from the head of its row, and leaves the pages that hold the rest alone.
_LENGTHS = """
SELECT topic_id, timestamp, CASE typeof(data) WHEN 'blob' THEN length(data) END, x''
FROM messages ORDER BY timestamp, id
"""
_HEADS = _LENGTHS.replace("x''", "substr(data, 1, ?)")


def sqlite_outlines(path: Path, channels: ChannelsByNumber, head_bytes: int) -> Iterator[Outline]:
    """The outlines of the messages of ``channels`` in the database at ``path``, in time order.

    Raises ``OutlineError`` at a row that is no message, or where SQLite cannot read on.
    """
    address = f"file:{quote(str(path.absolute()))}?mode=ro&immutable=1"
    try:
        with closing(sqlite3.connect(address, uri=True)) as database:
            rows = database.execute(_HEADS, (head_bytes,)) if head_bytes else database.execute(_LENGTHS)
            for number, stamp_ns, size_bytes, head in rows:
                if size_bytes is None or not isinstance(stamp_ns, int):
                    raise OutlineError("a row without stamp or payload")
                if number in channels:
                    yield channels[number], stamp_ns, size_bytes, head
    except sqlite3.Error as error:
        raise OutlineError(str(error)) from error
