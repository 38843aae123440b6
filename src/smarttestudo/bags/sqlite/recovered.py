# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""A cut-off or damaged .db3 file, read as far as it goes."""

from __future__ import annotations

from collections import Counter
from collections.abc import Iterator, Mapping, Sequence
from contextlib import ExitStack, closing, suppress
from pathlib import Path

from smarttestudo.bags.channel_reader import ChannelReader
from smarttestudo.bags.sqlite.database import BROKEN, DatabaseFile, open_database, read_topics
from smarttestudo.bags.sqlite.log import WriteAheadLog
from smarttestudo.bags.sqlite.pages import DamagedRowError, SqlitePages, SqliteRow
from smarttestudo.bags.stored_file import (
    HOMELESS,
    ChannelsByNumber,
    Outline,
    left_out,
    read_so_far,
)
from smarttestudo.bags.time_index import TimeIndex
from smarttestudo.domain.errors import RecordingError
from smarttestudo.domain.recording import RecordedMessage, RecordedSize
from smarttestudo.domain.units import grouped

# More than a row of rosbag2's table ``messages`` has before its payload.
_ROW_HEAD_BYTES = 64


class RecoveredSqliteFile:
    """Takes the topics from SQLite itself, and the messages from the leaf pages that are still there.

    ``rows`` is how many messages the file held, where SQLite can tell.
    """

    def __init__(self, path: Path, log: WriteAheadLog | None = None, rows: int | None = None) -> None:
        self._reader = ChannelReader()
        self._log = log
        self._rows = rows
        with ExitStack() as opened:
            file = opened.enter_context(closing(DatabaseFile(path, log)))
            try:
                self._pages = SqlitePages(file)
            except DamagedRowError as error:
                raise RecordingError("not a SQLite file", place=str(path)) from error
            self._present_bytes = file.present_bytes
            self._index = opened.enter_context(closing(TimeIndex()))
            self.channels: ChannelsByNumber = self._read_topics(path)
            self._indexed = _indexed_rows(path, log) if rows is None else 0
            self._counts: Counter[int] = Counter()
            self.start_ns = self.end_ns = self.message_count = self._damaged = 0
            self._homeless = self._last_row = 0
            self._find_messages()
            self._resources = opened.pop_all()

    def counts(self) -> Mapping[int, int]:
        """Messages of each channel."""
        return self._counts

    def back_ns(self) -> int:
        """Nothing: what the order of a damaged file was is not known."""
        return 0

    @property
    def promised_messages(self) -> int:
        """Messages that the file held, as SQLite or the numbers of its rows tell."""
        return self.message_count + self._homeless + self._lost

    def messages(self, channels: ChannelsByNumber) -> Iterator[RecordedMessage]:
        """Every message of ``channels`` that is whole, in time order."""
        for _, offset in self._index.places():
            try:
                message = _as_message(self._pages.row_at(offset))
            except DamagedRowError:
                self._damaged += 1
                continue
            if message is not None:
                number, stamp_ns, payload = message
                if number in channels:
                    yield channels[number], stamp_ns, payload

    def outlines(self, channels: ChannelsByNumber, head_bytes: int) -> Iterator[Outline]:
        """The outlines of ``messages``, without reading payloads."""
        for _, offset in self._index.places():
            row = self._pages.row_at(offset, _ROW_HEAD_BYTES + head_bytes)
            message = _as_message(row)
            if message is not None and message[0] in channels:
                number, stamp_ns, payload = message
                yield channels[number], stamp_ns, row.sizes[-1], payload[:head_bytes]

    def sizes(self, channels: ChannelsByNumber) -> Iterator[RecordedSize]:
        """The sizes of ``messages``, read as ``outlines`` are."""
        return (outline[:3] for outline in self.outlines(channels, 0))

    def notices(self) -> Sequence[str]:
        """Whether the file is cut off or damaged, and how much of it was read."""
        notices = [*(self._log.notices() if self._log is not None else ()), *self._reader.notices]
        if self._is_cut_off:
            notices.append(f"cut off: {read_so_far(self)}")
        elif self._lost:
            notices.append(f"damaged: {read_so_far(self)}, {grouped(self._lost)} rows cannot be read")
        elif not self._homeless:
            notices.append(f"damaged: {read_so_far(self)}")
        if self._homeless:
            notices.append(left_out(self._homeless, HOMELESS))
        return notices

    @property
    def readable_share(self) -> float | None:
        """The share of its length that is there, or else of its rows; ``None`` where neither is known."""
        if self._is_cut_off:
            return self._present_bytes / self._pages.promised_bytes
        return self.message_count / self.promised_messages if self.promised_messages else None

    def close(self) -> None:
        """Let go of the file."""
        self._resources.close()

    @property
    def _is_cut_off(self) -> bool:
        return self._present_bytes < self._pages.promised_bytes

    @property
    def _lost(self) -> int:
        """Rows that are damaged, or gone with their pages: a recorder numbers them from 1 on."""
        rows = max(self._last_row, self._indexed) if self._rows is None else self._rows
        return max(self._damaged, rows - self.message_count - self._homeless)

    def _read_topics(self, path: Path) -> ChannelsByNumber:
        try:
            with open_database(path, self._log) as database:
                # Without it, SQLite opens no file that is shorter than its header says.
                database.execute("PRAGMA writable_schema=ON")
                return read_topics(database, self._reader)
        except BROKEN as error:
            if self._is_cut_off:
                raise RecordingError(
                    "cut off: no rosbag2 topics can be found in it", place=str(path)
                ) from error
            raise RecordingError("no rosbag2 topics can be found in it", place=str(path)) from error

    def _find_messages(self) -> None:
        for offset in self._pages.rows():
            try:
                row = self._pages.row_at(offset, _ROW_HEAD_BYTES)
            except DamagedRowError:
                self._damaged += 1
                continue
            message = _as_message(row)
            if message is not None and self._index.add(key=row.rowid, stamp_ns=message[1], offset=offset):
                self._last_row = max(self._last_row, row.rowid)
                self._count(*message[:2])

    def _count(self, number: int, stamp_ns: int) -> None:
        if number not in self.channels:
            self._homeless += 1
            return
        self.start_ns = min(self.start_ns, stamp_ns) if self.message_count else stamp_ns
        self.end_ns = max(self.end_ns, stamp_ns) if self.message_count else stamp_ns
        self.message_count += 1
        self._counts[number] += 1


def _as_message(row: SqliteRow) -> tuple[int, int, bytes] | None:
    """Channel, stamp and payload in ``row`` if it has the columns of rosbag2's table ``messages``."""
    match row.values:
        case (_, int() as channel, int() as stamp_ns, bytes() as payload):
            return channel, stamp_ns, payload
        case _:
            return None


def _indexed_rows(path: Path, log: WriteAheadLog | None) -> int:
    """Rows of messages that the index of their stamps has, 0 where that is damaged, too."""
    with suppress(*BROKEN), open_database(path, log) as database:
        # Not count(*), which is one step: no limit of steps would end it where pages lead in circles.
        ((rows,),) = database.execute("SELECT total(1) FROM messages")
        return int(rows)
    return 0
