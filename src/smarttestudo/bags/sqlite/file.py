# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""A .db3 file read with SQLite itself, together with the log that a recorder may have left beside it."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from contextlib import contextmanager, suppress
from functools import cached_property
from pathlib import Path

import apsw

from smarttestudo.bags.channel_reader import ChannelReader
from smarttestudo.bags.sqlite.database import BROKEN, open_database, read_topics
from smarttestudo.bags.sqlite.log import WriteAheadLog
from smarttestudo.bags.stored_file import ChannelsByNumber, ContinuedFile, Outline, OutlineError, StoredFile
from smarttestudo.domain.errors import RecordingError
from smarttestudo.domain.recording import RecordedMessage, RecordedSize

# SQLite knows the length of a blob from the head of its row, and leaves the pages that hold the rest alone.
_SIZES = """
SELECT topic_id, timestamp,
    CASE WHEN typeof(data) = 'blob' AND typeof(timestamp) = 'integer' THEN length(data) END
FROM messages ORDER BY timestamp, id
"""
_HEADS = _SIZES.replace("END", "END, substr(data, 1, ?)")
_NO_MESSAGE = "a row without topic, stamp or payload"
_SPAN = "SELECT count(*), min(timestamp), max(timestamp) FROM messages WHERE typeof(timestamp) = 'integer'"
# SQLite counts all rows in one step, which no limit of steps ends where pages lead in circles.
_ROWS = "SELECT total(1) FROM messages NOT INDEXED"
_MESSAGES = "SELECT topic_id, timestamp, data FROM messages {} ORDER BY timestamp, id"
_NUMBERS = "SELECT min(id), max(id) FROM messages"
_STAMPS = "SELECT topic_id, timestamp FROM messages WHERE typeof(timestamp) = 'integer' ORDER BY id"


def _require_all(rows: int, indexed: int) -> None:
    if rows != indexed:
        raise ValueError("its index has other messages than its table")


class SqliteFile(ContinuedFile):
    """The database at ``path`` with ``log`` taken in, as far as both are whole.

    It is open only while rows are read: a recording may have thousands of files, and SQLite keeps pages of
    each that is open. Raises ``RecordingError`` where SQLite cannot read it.
    """

    def __init__(self, path: Path, log: WriteAheadLog | None) -> None:
        self._path = path
        self._log = log
        self._reader = ChannelReader()
        try:
            with open_database(path, log) as database:
                self.channels: ChannelsByNumber = read_topics(database, self._reader)
                ((page_bytes,),) = database.execute("PRAGMA page_size")
                if path.stat().st_size % int(page_bytes):
                    raise ValueError("a part of a page is missing")
                ((count, start_ns, end_ns),) = database.execute(_SPAN)
                ((first, last),) = database.execute(_NUMBERS)
                # A recorder numbers rows from 1 on.
                absent = last - min(first, 1) + 1 - count if last is not None else 0
                if absent or not count:
                    # The index of stamps may be damaged.
                    ((rows,),) = database.execute(_ROWS)
                    _require_all(rows, count)
        except BROKEN as error:
            raise RecordingError(f"SQLite cannot read it: {error}", place=str(path)) from error
        super().__init__(message_count=int(count), start_ns=int(start_ns or 0), end_ns=int(end_ns or 0))
        self.promised_messages += max(0, absent)
        self._count = int(count)

    def outlines(self, channels: ChannelsByNumber, head_bytes: int) -> Iterator[Outline]:
        """The outlines of ``messages``, without reading payloads."""
        with self._rows(_HEADS, (head_bytes,)) as rows:
            for number, stamp_ns, size_bytes, head in rows:
                channel = channels.get(number)
                if channel is None or size_bytes is None:
                    raise OutlineError(_NO_MESSAGE)
                yield channel, stamp_ns, size_bytes, head

    def sizes(self, channels: ChannelsByNumber) -> Iterator[RecordedSize]:
        """The sizes of ``messages``, without reading payloads."""
        with self._rows(_SIZES) as rows:
            for number, stamp_ns, size_bytes in rows:
                channel = channels.get(number)
                if channel is None or size_bytes is None:
                    raise OutlineError(_NO_MESSAGE)
                yield channel, stamp_ns, size_bytes

    def notices(self) -> Sequence[str]:
        """Losses, one line each, once all messages were read."""
        damage = super().notices()
        log_notices = () if self._log is None or damage else self._log.notices()
        return [*log_notices, *self._reader.notices, *damage]

    def close(self) -> None:
        """There is nothing to let go of."""

    @contextmanager
    def _rows(self, query: str, values: tuple[int, ...] = ()) -> Iterator[apsw.Cursor]:
        """The rows of ``query``; ``OutlineError`` where SQLite cannot read on."""
        try:
            with open_database(self._path, self._log) as database:
                yield database.execute(query, values)
        except apsw.Error as error:
            raise OutlineError(str(error)) from error

    def _as_stored(self, channels: ChannelsByNumber) -> Iterator[RecordedMessage]:
        # A row that is not wanted is left unread; where all are, damage in any of them is seen.
        numbers = ", ".join(map(str, channels))
        condition = "" if channels.keys() == self.channels.keys() else f"WHERE topic_id IN ({numbers})"
        with open_database(self._path, self._log) as database:
            for number, stamp_ns, payload in database.execute(_MESSAGES.format(condition)):
                if not (isinstance(number, int) and isinstance(stamp_ns, int) and isinstance(payload, bytes)):
                    raise TypeError("a message without stamp or payload")
                if number not in self.channels:
                    raise TypeError("a message of a topic that the file does not name")
                if number in channels:
                    yield channels[number], stamp_ns, payload

    def _counts_of_whole(self) -> Mapping[int, int]:
        return self._order[0]

    def _back_of_whole_ns(self) -> int:
        return self._order[1]

    @cached_property
    def _order(self) -> tuple[Mapping[int, int], int]:
        """Messages of each topic by its number, and the furthest step back; all rows are read for it."""
        counts, latest_ns, back_ns = dict[int, int](), dict[int, int](), 0
        with suppress(apsw.Error, OSError), open_database(self._path, self._log) as database:
            # A window of SQLite sorts all rows, and takes six times as long.
            for number, stamp_ns in database.execute(_STAMPS):
                back_ns = max(back_ns, latest_ns.get(number, stamp_ns) - stamp_ns)
                latest_ns[number] = stamp_ns
                counts[number] = counts.get(number, 0) + 1
            return counts, back_ns
        return {}, 0

    def _recovered(self) -> StoredFile:
        from smarttestudo.bags.sqlite.recovered import RecoveredSqliteFile  # noqa: PLC0415  most are whole

        return RecoveredSqliteFile(self._path, self._log, self._count)
