# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""The write-ahead log that SQLite keeps beside a file (https://www.sqlite.org/fileformat2.html#walformat)."""

from __future__ import annotations

import struct
from array import array
from bisect import bisect_left
from collections.abc import Iterator
from dataclasses import dataclass, field
from itertools import zip_longest
from pathlib import Path
from typing import TYPE_CHECKING, BinaryIO

from smarttestudo.domain.units import grouped

if TYPE_CHECKING:
    from smarttestudo.bags.sqlite.log_checksum import LogChecksum

SUFFIX = "-wal"
_HEADER = struct.Struct(">8I")
_FRAME = struct.Struct(">6I")
_CHECKED_FRAME_BYTES = 8
_BYTE_ORDERS = {0x377F0682: "<", 0x377F0683: ">"}
_VERSION = 3007000
_PAGE_BYTES = frozenset(1 << bits for bits in range(9, 17))


@dataclass(frozen=True, slots=True, kw_only=True)
class WriteAheadLog:
    """The pages that complete transactions left in a log.

    ``page_numbers`` rise, from 1 on; ``offsets`` says where the last content of each begins. The database
    has ``database_pages`` of ``page_bytes`` once they are taken in. ``left_out_bytes`` at the log's end are
    damaged, or of a transaction that never ended.
    """

    path: Path
    page_bytes: int = 0
    database_pages: int = 0
    page_numbers: array[int] = field(default_factory=lambda: array("I"))
    offsets: array[int] = field(default_factory=lambda: array("Q"))
    left_out_bytes: int = 0

    def offset_of(self, page_number: int) -> int | None:
        """Where the page begins in the log; ``None`` if it is in the database only."""
        place = bisect_left(self.page_numbers, page_number)
        if place == len(self.page_numbers) or self.page_numbers[place] != page_number:
            return None
        return self.offsets[place]

    def notices(self) -> Iterator[str]:
        """Effects of the log on its database, one line each."""
        name = self.path.name
        if self.page_numbers:
            yield f"read together with {name} beside it, which holds what is not in it yet"
        if self.left_out_bytes:
            yield (
                f"the last {grouped(self.left_out_bytes)} bytes of {name} are damaged, "
                "or of a transaction that did not end, and were left out"
            )


def read_log(database: Path) -> WriteAheadLog | None:
    """Read the log beside ``database``; ``None`` if it adds nothing. Takes 12 bytes of memory a page."""
    path = database.with_name(database.name + SUFFIX)
    if not path.is_file() or not path.stat().st_size:
        return None
    with path.open("rb") as file:
        log = _Log(file).read(path)
    return log if log.page_numbers or log.left_out_bytes else None


@dataclass(frozen=True, slots=True)
class _Frame:
    page_number: int
    database_pages: int


class _Log:
    """The frames of a log from the first to the last that makes sense."""

    def __init__(self, file: BinaryIO) -> None:
        self._file = file
        self._file_bytes = file.seek(0, 2)
        self._stale_from: int | None = None
        self._page_bytes = 0

    def read(self, path: Path) -> WriteAheadLog:
        pages = array("I")
        committed = database_pages = 0
        for frame in self._frames():
            pages.append(frame.page_number)
            if frame.database_pages:
                committed, database_pages = len(pages), frame.database_pages
        numbers, frames = _last_of_each(pages[:committed])
        frame_bytes = _FRAME.size + self._page_bytes
        committed_bytes = _HEADER.size + committed * frame_bytes if self._page_bytes else 0
        end = self._file_bytes if self._stale_from is None else self._stale_from
        return WriteAheadLog(
            path=path,
            page_bytes=self._page_bytes,
            database_pages=database_pages,
            page_numbers=numbers,
            offsets=array("Q", (_HEADER.size + _FRAME.size + frame * frame_bytes for frame in frames)),
            left_out_bytes=end - committed_bytes,
        )

    def _frames(self) -> Iterator[_Frame]:
        # Few bags have a log, and numpy takes longer to import than many a bag to read.
        from smarttestudo.bags.sqlite.log_checksum import LogChecksum  # noqa: PLC0415

        self._file.seek(0)
        header = self._file.read(_HEADER.size)
        if len(header) < _HEADER.size:
            return
        magic, version, page_bytes, _, *salts, sum_1, sum_2 = _HEADER.unpack(header)
        order = _BYTE_ORDERS.get(magic)
        if order is None or version != _VERSION or page_bytes not in _PAGE_BYTES:
            return
        checksum = LogChecksum(order)
        if checksum.add(header[: _HEADER.size - 8]) != (sum_1, sum_2):
            return
        self._page_bytes = page_bytes
        yield from self._frames_of(salts, checksum)

    def _frames_of(self, salts: list[int], checksum: LogChecksum) -> Iterator[_Frame]:
        for start in range(_HEADER.size, self._file_bytes, _FRAME.size + self._page_bytes):
            data = self._file.read(_FRAME.size + self._page_bytes)
            if len(data) < _FRAME.size + self._page_bytes:
                return
            page_number, database_pages, *found, sum_1, sum_2 = _FRAME.unpack_from(data)
            if found != salts:
                # SQLite begins a log anew without cutting off the frames of the last one, which are taken in.
                self._stale_from = start if any(found) else None
                return
            if checksum.add(data[:_CHECKED_FRAME_BYTES] + data[_FRAME.size :]) != (sum_1, sum_2):
                return
            if not page_number:
                return
            yield _Frame(page_number, database_pages)


def _last_of_each(pages: array[int]) -> tuple[array[int], list[int]]:
    """Distinct ``pages``, rising, and the place of the last occurrence of each."""
    places = sorted(range(len(pages)), key=pages.__getitem__)
    last = [
        place
        for place, after in zip_longest(places, places[1:])
        if after is None or pages[after] != pages[place]
    ]
    return array("I", (pages[place] for place in last)), last
