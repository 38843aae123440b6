# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""An .mcap file without a usable index: cut off, damaged, or written without one."""

from __future__ import annotations

import struct
from collections import Counter
from collections.abc import Iterator, Mapping, Sequence
from contextlib import ExitStack, closing, suppress
from functools import partial
from pathlib import Path
from typing import BinaryIO

from smarttestudo.bags.channel_reader import ChannelReader, with_escapes
from smarttestudo.bags.mcap.record_bytes import Op
from smarttestudo.bags.mcap.records import MessageEntry, Record, RecordReader
from smarttestudo.bags.mcap.summary import ChannelEntry, SchemaEntry, read_statistics, read_summary
from smarttestudo.bags.mcap.time_order import FoundMessage, in_time_order
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
from smarttestudo.domain.units import LAST_STAMP_NS, counted, grouped

_NO_SCHEMA = 0


class RecoveredMcapFile:
    """Reads the whole file once for what is in it, and again in time order, one chunk at a time.

    ``whole_bytes`` is how long the file was before it was cut off, where that is known.
    """

    def __init__(self, path: Path, whole_bytes: int | None = None) -> None:
        self._whole_bytes = whole_bytes
        self._schemas: dict[int, SchemaEntry] = {}
        self._described: dict[int, ChannelEntry] = {}
        self._counts: Counter[int] = Counter()
        self._timeless = self.promised_messages = 0
        self._promised_of: Counter[int] | None = None
        self._has_damaged_index = False
        self._reader = ChannelReader()
        self.channels: ChannelsByNumber = {}
        self._spans: dict[int, tuple[int, int]] = {}
        with ExitStack() as opened:
            file = opened.enter_context(path.open("rb"))
            self._records = RecordReader(file)
            self._index = opened.enter_context(closing(TimeIndex()))
            self._find_messages()
            self._read_promises(file)
            # A schema may come after its channel, or be lost.
            self.channels = {
                number: self._reader.of_mcap(record, self._schemas.get(record.schema_id))
                for number, record in self._described.items()
            }
            if not self.channels and self._records.cut_off_at is not None:
                lost = "".join(self._losses())
                raise RecordingError(f"{lost}no rosbag2 topics can be found in it", place=str(path))
            self._resources = opened.pop_all()
        self.message_count = sum(self._counts[number] for number in self.channels)
        spans = [self._spans[number] for number in self.channels if number in self._spans]
        self.start_ns = min((first_ns for first_ns, _ in spans), default=0)
        self.end_ns = max((last_ns for _, last_ns in spans), default=0)

    def counts(self) -> Mapping[int, int]:
        """Messages of each channel, and of numbers that are none's."""
        return self._counts

    def back_ns(self) -> int:
        """Nothing: what the order of a damaged file was is not known."""
        return 0

    def messages(self, channels: ChannelsByNumber) -> Iterator[RecordedMessage]:
        """Every message of ``channels`` that is whole, in time order."""
        for stamp_ns, number, _, payload in in_time_order(self._index.places(), self._payloads_at):
            if number in channels:
                yield channels[number], stamp_ns, payload

    def outlines(self, channels: ChannelsByNumber, head_bytes: int) -> Iterator[Outline]:
        """The outlines of ``messages``; chunks are unpacked, messages outside of them are not read."""
        read = partial(self._heads_at, head_bytes=head_bytes)
        for stamp_ns, number, size_bytes, head in in_time_order(self._index.places(), read):
            if number in channels:
                yield channels[number], stamp_ns, size_bytes, head

    def sizes(self, channels: ChannelsByNumber) -> Iterator[RecordedSize]:
        """The sizes of ``messages``, read as ``outlines`` are."""
        return (outline[:3] for outline in self.outlines(channels, 0))

    def notices(self) -> Sequence[str]:
        """Whether the file is cut off or damaged, and how much of it was read."""
        notices = list(self._reader.notices)
        so_far = read_so_far(self, self.promised_messages)
        notices += (f"{loss}{so_far}" for loss in self._losses())
        notices += self._notices_of_promises()
        notices.extend(
            f"{with_escapes(record.topic)}: the file has no schema for it, so its type is not known"
            for record in self._described.values()
            if record.schema_id not in {_NO_SCHEMA, *self._schemas}
        )
        homeless = self._counts.total() - self.message_count
        if homeless:
            notices.append(left_out(homeless, HOMELESS))
        if self._timeless:
            notices.append(f"{counted(self._timeless, 'message')} with a time after 2262 left out")
        return notices

    @property
    def readable_share(self) -> float | None:
        """The share of the file's bytes that is there and not damaged; unknown if it is cut off."""
        if self._records.cut_off_at is not None:
            return self._records.file_bytes / self._whole_bytes if self._whole_bytes else None
        promised = max(self.promised_messages, self._held)
        if promised > self.message_count:
            return self.message_count / promised
        return 1 - self._records.lost_bytes / self._records.file_bytes

    def close(self) -> None:
        """Let go of the file."""
        self._resources.close()

    @property
    def _held(self) -> int:
        """Messages that can be read, those of no topic or of no time included."""
        return self._counts.total() + self._timeless

    @property
    def _is_damaged(self) -> bool:
        return self._records.cut_off_at is not None or bool(self._records.losses)

    def _losses(self) -> Iterator[str]:
        """The beginnings of the notices of what is cut off or damaged."""
        if self._records.cut_off_at is not None:
            yield f"cut off or damaged at byte {grouped(self._records.cut_off_at)}: "
        losses = sorted(self._records.losses.items())
        if losses:
            yield f"{', '.join(f'{what}: {grouped(number)}' for what, number in losses)}; "

    def _notices_of_promises(self) -> Iterator[str]:
        """Where the file has other messages than it says, or records of no kind."""
        if self._has_damaged_index and not self._is_damaged:
            yield "its index is damaged, or that of other messages"
        unknown = self._records.unknown_records
        if unknown:
            yield f"{counted(unknown, 'record')} of an unknown kind left out"
        if self.promised_messages > self._held and not self._is_damaged:
            yield f"messages are missing: {read_so_far(self, self.promised_messages)}"
        elif self.promised_messages < self._held:
            held = counted(self._held, "message")
            yield f"{held} are in it, though its own index counts {grouped(self.promised_messages)}"
        elif self._promised_of not in (None, self._counts) and not (self._is_damaged or self._timeless):
            yield "its topics have other numbers of messages than its own index counts"

    def _payloads_at(self, offset: int) -> Iterator[FoundMessage]:
        for record in self._records.at(offset):
            if isinstance(record, MessageEntry) and self._is_to_be_told(record):
                yield record.log_time, record.channel_id, record.payload_bytes, record.head

    def _heads_at(self, offset: int, *, head_bytes: int) -> Iterator[FoundMessage]:
        for record in self._records.heads_at(offset, head_bytes):
            if isinstance(record, MessageEntry) and self._is_to_be_told(record):
                yield record.log_time, record.channel_id, record.payload_bytes, record.head

    def _is_to_be_told(self, message: MessageEntry) -> bool:
        return message.log_time <= LAST_STAMP_NS and message.channel_id in self.channels

    def _find_messages(self) -> None:
        held_of: dict[int, int] = {}
        for place in self._records.places():
            op, start, *_ = place
            held = self._held
            stamps = [stamp_ns for record in self._records.heads(place) for stamp_ns in self._note(record)]
            if stamps:
                self._index.add(key=start, stamp_ns=min(stamps), offset=start)
            if op == Op.CHUNK:
                held_of[start] = self._held - held
        indexed = self._records.indexed_messages
        lost = sum(max(0, messages - held_of.get(start, 0)) for start, messages in indexed.items())
        self.promised_messages = self._held + lost

    def _read_promises(self, file: BinaryIO) -> None:
        """See what the file counts itself."""
        try:
            read_summary(file)
        except (struct.error, ValueError, OSError):
            self._has_damaged_index = True
        with suppress(struct.error, ValueError):
            statistics = read_statistics(self._records.statistics)
            counts = Counter(statistics.channels)
            # Where they disagree with themselves they are damaged.
            if counts.total() == statistics.message_count:
                self.promised_messages, self._promised_of = statistics.message_count, counts

    def _note(self, record: Record) -> Iterator[int]:
        """Take in ``record``; gives its stamp if it is a message."""
        match record:
            case SchemaEntry():
                self._schemas.setdefault(record.number, record)
            case ChannelEntry():
                self._described.setdefault(record.number, record)
            case MessageEntry() if record.log_time > LAST_STAMP_NS:
                self._timeless += 1
            case MessageEntry():
                number, stamp_ns = record.channel_id, record.log_time
                self._counts[number] += 1
                first_ns, last_ns = self._spans.get(number, (stamp_ns, stamp_ns))
                self._spans[number] = min(first_ns, stamp_ns), max(last_ns, stamp_ns)
                yield stamp_ns
