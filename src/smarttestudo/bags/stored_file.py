# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""One storage file of a bag, however it has to be read."""

from __future__ import annotations

import sqlite3
from abc import ABC, abstractmethod
from collections.abc import Iterator, Mapping, Sequence
from contextlib import closing
from itertools import islice
from typing import Protocol

from smarttestudo.domain.recording import Channel, RecordedMessage, RecordedSize, readable_until
from smarttestudo.domain.units import counted, grouped


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
        self._database.close()


ChannelsByNumber = Mapping[int, Channel]
"""Channels by the number that a file gives each."""

Outline = tuple[Channel, int, int, bytes]
"""A message without its payload: channel, stamp in ns, stored bytes, and the first of them if asked for."""


class OutlineError(Exception):
    """The rest of a file must be read in full."""


class StoredFile(Protocol):
    """An opened storage file."""

    @property
    def channels(self) -> ChannelsByNumber:
        """The channels that the file announces."""

    @property
    def start_ns(self) -> int:
        """Stamp of the first message; meaningless where there is none."""

    @property
    def end_ns(self) -> int:
        """Stamp of the last message; meaningless where there is none."""

    @property
    def message_count(self) -> int:
        """Messages that can be read."""

    @property
    def promised_messages(self) -> int:
        """Messages that the file held once, as far as it tells."""

    def counts(self) -> Mapping[int, int]:
        """Messages that can be read of each channel by its number, as far as that is known."""

    def back_ns(self) -> int:
        """How far stamps of a topic go back in the order of writing; 0 in a damaged file."""

    def messages(self, channels: ChannelsByNumber) -> Iterator[RecordedMessage]:
        """The messages of ``channels`` in time order, by number, with their payloads as stored."""

    def outlines(self, channels: ChannelsByNumber, head_bytes: int) -> Iterator[Outline]:
        """Results of ``messages``, in the same order, each with the first ``head_bytes`` of its payload.

        Raises ``OutlineError`` where only ``messages`` can go on.
        """

    def sizes(self, channels: ChannelsByNumber) -> Iterator[RecordedSize]:
        """Results of ``messages`` in the same order, each with its stored bytes in place of its payload.

        Raises ``OutlineError`` as ``outlines`` does.
        """

    def notices(self) -> Sequence[str]:
        """Losses, one line each."""

    @property
    def readable_share(self) -> float | None:
        """How much of what the file was to hold can be read, 0 … 1, once that was tried.

        ``None`` if it is unknown how much is missing.
        """

    def close(self) -> None:
        """Let go of the file."""


def read_so_far(file: StoredFile, promised_messages: int = 0) -> str:
    """How far a damaged file could be read, of more messages if it tells."""
    if not file.message_count:
        which = f"none of {counted(promised_messages, 'message')}" if promised_messages else "no message"
        return f"{which} could be read"
    until = readable_until(file.readable_share, file.end_ns)
    of_all = f" of {grouped(promised_messages)}" if promised_messages > file.message_count else ""
    return f"{until} after {counted(file.message_count, 'message')}{of_all}"


HOMELESS = "of topics that the file does not name"


def left_out(count: int, which: str) -> str:
    """Notice of so many messages, ``which`` they are: ``3 messages of … were left out``."""
    return f"{counted(count, 'message')} {which} {'was' if count == 1 else 'were'} left out"


class ContinuedFile(ABC):
    """A file that is opened once more, in the way of a damaged one, when reading it fails half-way.

    ``message_count``, ``start_ns`` and ``end_ns`` are what the file says until then.
    """

    def __init__(self, *, message_count: int, start_ns: int, end_ns: int) -> None:
        self._message_count = message_count
        self.start_ns = start_ns
        self.end_ns = end_ns
        self.promised_messages = message_count
        self._damage: Sequence[str] = ()
        self._readable_share: float | None = 1.0
        self._recovered_counts: Mapping[int, int] | None = None

    def messages(self, channels: ChannelsByNumber) -> Iterator[RecordedMessage]:
        """The messages of ``channels`` in time order."""
        delivered = 0
        try:
            for message in self._as_stored(channels):
                yield message
                delivered += 1
        except Exception as error:  # noqa: BLE001 - libraries leak all kinds; what is behind the damage is read
            with closing(self._recovered()) as recovered:
                yield from islice(recovered.messages(channels), delivered, None)
                self._damage = recovered.notices() or [f"damaged: {error}"]
                self._take_over(recovered)

    def _take_over(self, recovered: StoredFile) -> None:
        """Take the numbers of ``recovered``; what the file says it holds tells how much of it that is."""
        promised, self._message_count = self._message_count, recovered.message_count
        self._readable_share = recovered.readable_share
        self._recovered_counts = recovered.counts()
        self.promised_messages = max(promised, recovered.promised_messages)
        if promised > recovered.message_count:
            self._readable_share = recovered.message_count / promised
        if recovered.message_count:
            self.start_ns, self.end_ns = recovered.start_ns, recovered.end_ns

    def notices(self) -> Sequence[str]:
        """Losses, one line each, once all messages were read."""
        return self._damage

    def counts(self) -> Mapping[int, int]:
        """Messages of each channel by its number, as far as that is known."""
        return self._counts_of_whole() if self._recovered_counts is None else self._recovered_counts

    def back_ns(self) -> int:
        """How far stamps of a topic go back in the order of writing; 0 in a damaged file."""
        return 0 if self._damage else self._back_of_whole_ns()

    @property
    def message_count(self) -> int:
        """Messages that can be read, as far as that is known."""
        return self._message_count

    @property
    def readable_share(self) -> float | None:
        """1, unless reading all messages met damage."""
        return self._readable_share

    @abstractmethod
    def _as_stored(self, channels: ChannelsByNumber) -> Iterator[RecordedMessage]:
        """All messages in time order as the file's library reads them; any error is damage."""

    @abstractmethod
    def _counts_of_whole(self) -> Mapping[int, int]:
        """Result of ``counts`` while no damage was met."""

    @abstractmethod
    def _back_of_whole_ns(self) -> int:
        """Result of ``back_ns`` while no damage was met."""

    @abstractmethod
    def _recovered(self) -> StoredFile:
        """The file opened in the way of a damaged one."""
