# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""An .mcap file without a usable index: cut off, damaged, or written without one."""

from __future__ import annotations

import heapq
import marshal
import math
import struct
from collections import Counter
from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from contextlib import ExitStack, closing, suppress
from functools import partial
from itertools import chain, islice
from operator import itemgetter
from pathlib import Path
from tempfile import TemporaryFile
from typing import BinaryIO, TypeVar

from smarttestudo.bags.channel_reader import ChannelReader, with_escapes
from smarttestudo.bags.mcap.record_bytes import Op
from smarttestudo.bags.mcap.records import MessageEntry, Record, RecordReader
from smarttestudo.bags.mcap.summary import ChannelEntry, SchemaEntry, read_statistics, read_summary
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
from smarttestudo.domain.units import LAST_STAMP_NS, counted, grouped

_Place = TypeVar("_Place")
FoundMessage = tuple[int, int, int, bytes]
"""Stamp in ns and channel of a message, how long its payload is, and as much of that as was asked for."""

HELD_BYTES = 1 << 28
"""What overlaps is in memory up to here; beyond, it is in a temporary file."""
_BESIDE_PAYLOAD_BYTES = 250
_MESSAGES_A_BLOCK = 1000
_BLOCK_BYTES = 1 << 18
_stamp_of = itemgetter(0)


def in_time_order(
    places: Iterable[tuple[int, _Place]],
    read: Callable[[_Place], Iterable[FoundMessage]],
    *,
    held_bytes: int = HELD_BYTES,
) -> Iterator[FoundMessage]:
    """Messages that ``read`` gives at each place, by stamp.

    Places come by the stamp of their first message, which each begins with; messages of one stamp come as
    they are read. The records of one place are in memory at once, and ``held_bytes`` of what overlaps.
    """
    with _Pending(held_bytes) as pending:
        for place, next_ns in _with_next(places):
            messages = sorted(read(place), key=_stamp_of)
            due = [message for message in messages if message[0] < next_ns]
            if pending.is_due(next_ns):
                yield from heapq.merge(pending.taken(next_ns), due, key=_stamp_of)
            else:
                yield from due
            pending.add(messages[len(due) :])


def _with_next(places: Iterable[tuple[int, _Place]]) -> Iterator[tuple[_Place, float]]:
    """Places, each with the stamp from which on the messages of the next one come."""
    remaining = iter(places)
    for _, place in islice(remaining, 1):
        here = place
        for first_ns, following in remaining:
            yield here, first_ns
            here = following
        yield here, math.inf


class _Pending:
    """Messages that come behind those of later places.

    It is a heap of them: of all those in memory, and of the first one of each sorted run in the file.
    """

    def __init__(self, held_bytes: int) -> None:
        self._held_bytes = held_bytes
        self._heap: list[tuple[int, int, FoundMessage, _Run | None]] = []
        self._held = self._count = 0
        self._opened = ExitStack()
        self._file: BinaryIO | None = None

    def __enter__(self) -> _Pending:
        return self

    def __exit__(self, *_: object) -> None:
        self._opened.close()

    def add(self, messages: Iterable[FoundMessage]) -> None:
        """Add those of a place behind all that were added."""
        for message in messages:
            self._count += 1
            self._held += len(message[3]) + _BESIDE_PAYLOAD_BYTES
            heapq.heappush(self._heap, (message[0], self._count, message, None))
        if self._held > self._held_bytes:
            self._set_aside()

    def is_due(self, before_ns: float) -> bool:
        """Whether one is before a stamp."""
        return bool(self._heap) and self._heap[0][0] < before_ns

    def taken(self, before_ns: float) -> Iterator[FoundMessage]:
        """Messages before a stamp, in their order; they are no longer pending."""
        heap = self._heap
        while heap and heap[0][0] < before_ns:
            _, _, message, run = heap[0]
            following = None if run is None else next(run, None)
            if following is not None:
                number, one = following
                heapq.heapreplace(heap, (one[0], number, one, run))
            else:
                heapq.heappop(heap)
            if run is None:
                self._held -= len(message[3]) + _BESIDE_PAYLOAD_BYTES
            yield message

    def _set_aside(self) -> None:
        """Write all that are in memory into the file as one run."""
        if self._file is None:
            self._file = self._opened.enter_context(TemporaryFile())  # noqa: SIM115  it is closed there
        held = sorted(entry for entry in self._heap if entry[3] is None)
        run = _written(self._file, ((number, message) for _, number, message, _ in held))
        number, first = next(run)
        self._heap = [entry for entry in self._heap if entry[3] is not None]
        self._heap.append((first[0], number, first, run))
        heapq.heapify(self._heap)
        self._held = 0


_Run = Iterator[tuple[int, FoundMessage]]


def _written(file: BinaryIO, entries: _Run) -> _Run:
    """Results of ``entries``, read again from the end of ``file``, where they are written now."""
    at = file.seek(0, 2)
    sizes: list[int] = []
    block: list[tuple[int, FoundMessage]] = []
    block_bytes = 0
    for entry in chain(entries, (None,)):
        if block and (entry is None or len(block) == _MESSAGES_A_BLOCK or block_bytes > _BLOCK_BYTES):
            sizes.append(file.write(marshal.dumps(block)))
            block, block_bytes = [], 0
        if entry is not None:
            block.append(entry)
            block_bytes += len(entry[1][3])
    return _read_again(file, at, sizes)


def _read_again(file: BinaryIO, at: int, sizes: Iterable[int]) -> _Run:
    for size_bytes in sizes:
        file.seek(at)
        yield from marshal.loads(file.read(size_bytes))  # noqa: S302  it was written here
        at += size_bytes


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
        """``None``: what the order of a damaged file was is not known."""
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
            if isinstance(record, MessageEntry) and self._is_readable(record):
                yield record.log_time, record.channel_id, record.payload_bytes, record.head

    def _heads_at(self, offset: int, *, head_bytes: int) -> Iterator[FoundMessage]:
        for record in self._records.heads_at(offset, head_bytes):
            if isinstance(record, MessageEntry) and self._is_readable(record):
                yield record.log_time, record.channel_id, record.payload_bytes, record.head

    def _is_readable(self, message: MessageEntry) -> bool:
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
