# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""A cut-off or damaged .db3 file, read as far as it goes."""

from __future__ import annotations

import struct
import sys
from array import array
from collections import Counter
from collections.abc import Iterator, Mapping, Sequence
from contextlib import ExitStack, closing, suppress
from dataclasses import dataclass
from os import SEEK_END
from pathlib import Path
from typing import Protocol

from smarttestudo.bags import magic
from smarttestudo.bags.channel_reader import ChannelReader
from smarttestudo.bags.sqlite.database import BROKEN, DatabaseFile, open_database, read_topics
from smarttestudo.bags.sqlite.log import WriteAheadLog
from smarttestudo.bags.stored_file import (
    HOMELESS,
    ChannelsByNumber,
    Outline,
    TimeIndex,
    left_out,
    read_so_far,
)
from smarttestudo.domain.errors import RecordingError
from smarttestudo.domain.recording import RecordedMessage, RecordedSize
from smarttestudo.domain.units import grouped

_READ_BYTES = 1 << 20
_WORD_BYTES = 4


class PageFile(Protocol):
    """File that pages are read from."""

    def seek(self, offset: int, whence: int = ..., /) -> int:
        """Go to ``offset``; tell where that is."""

    def read(self, size_bytes: int, /) -> bytes:
        """The next ``size_bytes``, fewer where there are no more."""


def page_heads(file: PageFile, *, file_bytes: int, page_bytes: int) -> array[int]:
    """The first four bytes of every page as a big-endian number; 0 for a page that is missing.

    The file is read once in large pieces, and four bytes of memory are kept for each page: a row of
    megabytes is a chain of pages, and asking for each of its links takes longer than reading it all.
    """
    heads = array("I")
    start = 0
    while start < file_bytes:
        file.seek(start)
        data = file.read(max(_READ_BYTES, page_bytes))
        words = array("I", data[: len(data) // _WORD_BYTES * _WORD_BYTES])
        heads.extend(words[:: page_bytes // _WORD_BYTES] or array("I", [0]))
        start = len(heads) * page_bytes
    if sys.byteorder == "little":
        heads.byteswap()
    return heads


HEADER_BYTES = 100
_TABLE_LEAF = 0x0D
_LEAF_HEADER_BYTES = 8
_MAX_VARINT_BYTES = 9
_INTEGER_BYTES = {0: 0, 1: 1, 2: 2, 3: 3, 4: 4, 5: 6, 6: 8, 8: 0, 9: 0}

Value = int | bytes | str


class DamagedRowError(Exception):
    """A row of which a part is missing or makes no sense."""


@dataclass(frozen=True, slots=True, kw_only=True)
class SqliteRow:
    """A row of a table; NULL and 0 are both 0, reals are their 8 bytes.

    ``sizes`` has the bytes of each value, of which a row that was read in part may hold less.
    """

    rowid: int
    values: tuple[Value, ...]
    sizes: tuple[int, ...]


class SqlitePages:
    """The pages of a SQLite database file, as many as there are."""

    def __init__(self, file: PageFile) -> None:
        header = file.read(HEADER_BYTES)
        if len(header) < HEADER_BYTES or not header.startswith(magic.SQLITE):
            raise DamagedRowError("no SQLite header")
        self._file = file
        size = int.from_bytes(header[16:18], "big")
        self.page_bytes = 65536 if size == 1 else max(size, 512)
        self._usable_bytes = self.page_bytes - header[20]
        self.file_bytes = file.seek(0, SEEK_END)
        self.promised_bytes = int.from_bytes(header[28:32], "big") * self.page_bytes
        self._heads = page_heads(file, file_bytes=self.file_bytes, page_bytes=self.page_bytes)
        self._free_pages = frozenset(self._read_free_pages(int.from_bytes(header[32:36], "big")))

    def rows(self) -> Iterator[int]:
        """The offset of every row in the leaf pages of all tables, in file order."""
        for index, head in enumerate(self._heads):
            # The first page begins with the header of the file.
            if (head >> 24 == _TABLE_LEAF or not index) and index + 1 not in self._free_pages:
                page_start = index * self.page_bytes
                yield from self._cells(self._read(page_start, self.page_bytes), page_start)

    def row_at(self, offset: int, most_bytes: int | None = None) -> SqliteRow:
        """The row at ``offset``; with ``most_bytes``, of a long one about as much, its header included.

        Raises ``DamagedRowError`` where a part of it is missing, also one that is not asked for.
        """
        page_end = offset - offset % self.page_bytes + self._usable_bytes
        cell = self._read(offset, page_end - offset)
        payload_bytes, at = _varint(cell, 0)
        rowid, at = _varint(cell, at)
        if payload_bytes > self.file_bytes:
            raise DamagedRowError("longer than the file")
        local = self._local_bytes(payload_bytes)
        payload = cell[at : at + local]
        if len(payload) != local:
            raise DamagedRowError("cut off")
        missing = payload_bytes - local
        if missing:
            next_page = int.from_bytes(cell[at + local : at + local + 4], "big")
            wanted = missing if most_bytes is None else most_bytes - local
            payload = b"".join((payload, *self._overflow(next_page, missing, wanted)))
        values, sizes = _values(payload, payload_bytes)
        return SqliteRow(rowid=rowid, values=values, sizes=sizes)

    def _read_free_pages(self, trunk: int) -> Iterator[int]:
        """The pages that deleted rows have left behind, from the first page of their list on."""
        seen: set[int] = set()
        while trunk and trunk not in seen:
            seen.add(trunk)
            page = self._read((trunk - 1) * self.page_bytes, self.page_bytes)
            numbers = struct.unpack_from(f">{len(page) // 4}I", page)
            if len(numbers) < 2:
                return
            yield trunk
            yield from numbers[2 : 2 + numbers[1]]
            trunk = numbers[0]

    def _cells(self, page: bytes, page_start: int) -> Iterator[int]:
        header = HEADER_BYTES if page_start == 0 else 0
        if len(page) < header + _LEAF_HEADER_BYTES or page[header] != _TABLE_LEAF:
            return
        count = int.from_bytes(page[header + 3 : header + 5], "big")
        first = header + _LEAF_HEADER_BYTES
        pointers = page[first : first + 2 * count]
        for at in range(0, len(pointers) - 1, 2):
            cell = int.from_bytes(pointers[at : at + 2], "big")
            if first <= cell < len(page):
                yield page_start + cell

    def _local_bytes(self, payload_bytes: int) -> int:
        """How much of a row's payload its leaf page holds; the rest is in overflow pages."""
        most = self._usable_bytes - 35
        if payload_bytes <= most:
            return payload_bytes
        least = (self._usable_bytes - 12) * 32 // 255 - 23
        local = least + (payload_bytes - least) % (self._usable_bytes - 4)
        return local if local <= most else least

    def _overflow(self, page_number: int, missing: int, wanted: int) -> Iterator[bytes]:
        """The first ``wanted`` bytes or more of what is ``missing`` of a row, from ``page_number`` on."""
        while missing > 0:
            held = min(missing, self._usable_bytes - 4)
            start = (page_number - 1) * self.page_bytes
            if page_number < 2:
                raise DamagedRowError("its chain of pages ends early")
            if start + 4 + held > self.file_bytes:
                raise DamagedRowError("cut off")
            if wanted > 0:
                piece = self._read(start + 4, held)
                if len(piece) < held:
                    raise DamagedRowError("cut off")
                yield piece
            page_number = self._heads[page_number - 1]
            missing -= held
            wanted -= held

    def _read(self, offset: int, size: int) -> bytes:
        self._file.seek(offset)
        return self._file.read(size)


def _varint(data: bytes, at: int) -> tuple[int, int]:
    """The 64-bit variable-length integer at ``at``, and where it ends."""
    value = 0
    for count, byte in enumerate(data[at : at + _MAX_VARINT_BYTES], start=1):
        if count == _MAX_VARINT_BYTES:
            return _signed(value << 8 | byte), at + count
        value = value << 7 | byte & 0x7F
        if byte < 0x80:
            return value, at + count
    raise DamagedRowError("cut off")


def _signed(value: int) -> int:
    return value - (1 << 64) if value >> 63 else value


def _values(payload: bytes, payload_bytes: int) -> tuple[tuple[Value, ...], tuple[int, ...]]:
    """The values in ``payload``, of ``payload_bytes`` if it is whole, and their sizes."""
    header_bytes, at = _varint(payload, 0)
    if not at <= header_bytes <= len(payload):
        raise DamagedRowError("its header is invalid")
    values: list[Value] = []
    sizes: list[int] = []
    end = header_bytes
    while at < header_bytes:
        kind, at = _varint(payload, at)
        start = end
        if kind >= 12:
            end += (kind - 12) // 2
            is_text = kind % 2 == 1
            values.append(payload[start:end].decode("utf-8", "replace") if is_text else payload[start:end])
        elif kind in _INTEGER_BYTES:
            end += _INTEGER_BYTES[kind]
            values.append(1 if kind == 9 else int.from_bytes(payload[start:end], "big", signed=True))
        else:
            end += 8
            values.append(payload[start:end])
        sizes.append(end - start)
    if end != payload_bytes:
        raise DamagedRowError("its values do not fill it")
    return tuple(values), tuple(sizes)


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
        """``None``: what the order of a damaged file was is not known."""
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
