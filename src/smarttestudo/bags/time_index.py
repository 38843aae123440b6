# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""Places in a damaged file, by time."""

from __future__ import annotations

import sqlite3
from collections.abc import Iterator


class TimeIndex:
    """Places in a file by stamp, in a temporary database on disk, so that memory stays constant.

    A key counts once: adding it again changes nothing.
    """

    def __init__(self) -> None:
        self._database = sqlite3.connect("")
        self._database.execute(
            "CREATE TABLE place (key INTEGER PRIMARY KEY, stamp_ns INTEGER, offset INTEGER)"
        )

    def add(self, *, key: int, stamp_ns: int, offset: int) -> bool:
        """Note the message ``key`` at byte ``offset``; false if the key was there already."""
        cursor = self._database.execute(
            "INSERT OR IGNORE INTO place VALUES (?, ?, ?)", (key, stamp_ns, offset)
        )
        return cursor.rowcount == 1

    def places(self) -> Iterator[tuple[int, int]]:
        """Stamp and offset of every place, by stamp and then by key."""
        return iter(self._database.execute("SELECT stamp_ns, offset FROM place ORDER BY stamp_ns, key"))

    def close(self) -> None:
        """Drop the index."""
        self._database.close()
