# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""The storage files of a bag as one recording."""

from __future__ import annotations

import heapq
import json
from collections import Counter
from collections.abc import Callable, Collection, Iterable, Iterator, Mapping, Sequence
from contextlib import suppress
from dataclasses import dataclass
from functools import partial
from itertools import chain, count, islice, pairwise
from operator import itemgetter
from pathlib import Path
from typing import TypeVar

from smarttestudo.bags import magic
from smarttestudo.bags.channel_reader import ChannelKey, MergedChannels, key_of
from smarttestudo.bags.metadata import BagMetadata, MessageCounts, file_key
from smarttestudo.bags.stored_file import ChannelsByNumber, OutlineError, StoredFile, left_out
from smarttestudo.bags.stray_stamps import LEAST_BACK_NS, LEAST_STRAY_NS, YEAR_NS, StrayStamps, stray_stamps
from smarttestudo.domain.errors import RecordingError
from smarttestudo.domain.recording import Channel, RecordedHead, RecordedMessage, RecordedSize, Storage
from smarttestudo.domain.units import NS_PER_S, counted

_LOOKED_AT = 20
_PLAIN_CDR = (b"\0\0", b"\0\1")
HOLDS_NOTHING = "the recording holds no message"

DECLARED_BYTES_KEY = "smarttestudo.declared_bytes"


def declared_bytes_in(custom_data: Mapping[str, str]) -> dict[str, int]:
    """Bytes per message by topic, as the bag's ``custom_data`` declares them.

    Raises ``RecordingError`` for an entry that does not map topics to whole numbers of bytes.
    """
    text = custom_data.get(DECLARED_BYTES_KEY)
    if text is None:
        return {}
    try:
        declared = json.loads(text)
    except (ValueError, RecursionError) as error:
        raise RecordingError(f"its {DECLARED_BYTES_KEY} is not JSON") from error
    if not isinstance(declared, dict) or not all(_is_size(size) for size in declared.values()):
        raise RecordingError(f"its {DECLARED_BYTES_KEY} does not map topics to bytes")
    return declared


def with_declared_bytes(custom_data: Mapping[str, str], declared_bytes: Mapping[str, int]) -> dict[str, str]:
    """``custom_data`` with ``declared_bytes`` in it, in place of what it declared before."""
    kept = {key: value for key, value in custom_data.items() if key != DECLARED_BYTES_KEY}
    if declared_bytes:
        kept[DECLARED_BYTES_KEY] = json.dumps(dict(declared_bytes), sort_keys=True)
    return kept


def _is_size(value: object) -> bool:
    return isinstance(value, int) and not isinstance(value, bool) and value >= 0


_T = TypeVar("_T")


@dataclass(frozen=True, slots=True, kw_only=True)
class RecordingPart:
    """One opened storage file: ``path`` as the user knows it, ``storage_path`` where it lies unpacked.

    ``name`` is that of the metadata, or empty.
    """

    path: Path
    name: str
    storage: Storage
    storage_path: Path
    file: StoredFile


class RosbagRecording:
    """A ``RecordingReader`` over storage files that may overlap in time."""

    def __init__(
        self,
        parts: Sequence[RecordingPart],
        metadata: BagMetadata,
        notices: Sequence[str],
        *,
        name: str,
        lacks_files: bool = False,
    ) -> None:
        self._name = name
        self._parts = parts
        self._promised = metadata.counts
        self._says_packed = metadata.packs_messages
        self._lacks_files = lacks_files
        self._is_order_known = bool(metadata.file_names)
        self._back: Sequence[str] | None = None
        self._notices = list(notices)
        self._broken: dict[StoredFile, Counter[str]] = {}
        self._packed: dict[StoredFile, bool] = {}
        self.storage = parts[0].storage
        announced = (channel for part in parts for channel in part.file.channels.values())
        self._channels = MergedChannels(chain(metadata.channels, announced))
        self.channels: Sequence[Channel] = self._used_channels()
        self.custom_data: Mapping[str, str] = metadata.custom_data
        self.declared_bytes: Mapping[str, int] = self._declared_bytes()
        self._strays: StrayStamps | None = None

    def require_messages(self) -> None:
        """Raise ``RecordingError`` where messages were recorded, or may have been, and none can be read."""
        if not self.message_count and self.readable_share != 1:
            lost, promised = "; ".join(self.notices()), self.promised_messages
            cause = "no message of the recording can be read"
            if promised:
                cause = f"none of its {counted(promised, 'message')} can be read"
            raise RecordingError(cause, place=self._name, remedy=lost or None)

    def leave_out_strays(self) -> None:
        """Leave out messages of another time from now on; a recording of over a month is read for it."""
        if self.end_ns - self.start_ns > LEAST_STRAY_NS:
            self._strays = stray_stamps(self.sizes())

    @property
    def start_ns(self) -> int:
        """Stamp of the first message that can be read, as far as that is known."""
        if self._strays is not None:
            return self._strays.start_ns
        return min((file.start_ns for file in self._filled), default=0)

    @property
    def end_ns(self) -> int:
        """Stamp of the last message that can be read, as far as that is known."""
        if self._strays is not None:
            return self._strays.end_ns
        return max((file.end_ns for file in self._filled), default=0)

    @property
    def message_count(self) -> int | None:
        """Messages that can be read, as far as that is known."""
        strays = 0 if self._strays is None else self._strays.total
        return sum(map(self._readable_in, self._parts)) - strays

    @property
    def promised_messages(self) -> int:
        """Messages that it held once, as far as its metadata and files tell."""
        return max(self._promised.total, sum(part.file.promised_messages for part in self._parts))

    @property
    def readable_share(self) -> float | None:
        """The least of what the metadata and each file tell."""
        held = self._counts(readable=True)
        once = None if self._lacks_files else _messages_once(part.file for part in self._parts)
        if once is None and held.total > self._promised.total:
            return None
        shares = [*self._promised.shares(held)]
        if once:
            shares.append(min(1.0, held.total / once))
        return min(shares, default=1.0 if self._is_intact else None)

    def messages(self, topics: Collection[str] | None = None) -> Iterator[RecordedMessage]:
        """All messages, or those of ``topics``, in time order; memory does not grow with their number."""
        return self._in_time_order(partial(self._messages_of, topics=topics))

    def sizes(self) -> Iterator[RecordedSize]:
        """Results of ``messages``, with each payload's size in its place and as far as possible unread."""
        return self._in_time_order(self._sizes_of)

    def heads(self, head_bytes: int) -> Iterator[RecordedHead]:
        """Results of ``messages``, with each payload's size and its first ``head_bytes`` in its place."""
        return self._in_time_order(partial(self._heads_of, head_bytes=head_bytes))

    def notices(self) -> Sequence[str]:
        """Losses and oddities, one line each; complete once all messages were read."""
        paths_of: dict[str, list[Path]] = {}
        for part in self._parts:
            for notice in part.file.notices():
                paths_of.setdefault(notice, []).append(part.path)
        lost = [f"{_first_of(paths)}: {notice}" for notice, paths in paths_of.items()]
        broken = [
            f"{topic}: {left_out(count, 'that could not be decompressed')}"
            for topic, count in sum(self._broken.values(), Counter[str]()).items()
        ]
        if self._back is None:
            self._back = [*self._notice_of_back()]
        strays = [] if self._strays is None else [self._strays.notice()]
        counts = self._notices_of_counts()
        return [*self._notices, *lost, *counts, *self._back, *broken, *strays]

    def _used_channels(self) -> Sequence[Channel]:
        """The channels, those with messages first where a topic has several; of another type no others."""
        channels = self._channels.all()
        by_topic: dict[str, list[Channel]] = {}
        for channel in channels:
            by_topic.setdefault(channel.topic, []).append(channel)
        if len(by_topic) == len(channels):
            return channels
        counts: Counter[ChannelKey] = Counter()
        of_types: Counter[tuple[str, str]] = Counter()
        for file in self._filled:
            held = file.counts()
            for number, channel in self._channels_of(file).items():
                counts[key_of(channel)] += held.get(number, 0)
                of_types[channel.topic, channel.type_name] += held.get(number, 0)
        used: list[Channel] = []
        for topic, alike in by_topic.items():
            alike.sort(key=lambda one: (-of_types[one.topic, one.type_name], not counts[key_of(one)]))
            first = alike[0]
            for channel in alike:
                if not counts[key_of(first)] or counts[key_of(channel)]:
                    used.append(channel)
                elif channel.type_name != first.type_name and channel.type_name:
                    self._notices.append(f"{topic}: announced as {channel.type_name}, too, without messages")
        return used

    def _notices_of_counts(self) -> Iterator[str]:
        """Where files without damage hold other messages than the metadata, or their own numbers, say."""
        promised, held = self._promised, self._counts()
        if not self.message_count and self.readable_share == 1:
            yield f"{self._name}: {HOLDS_NOTHING}"
        if self._is_intact and (notice := promised.notice(held)):
            yield notice
            return
        for part in self._parts:
            if part.file.readable_share != 1:
                continue
            count = part.file.message_count
            notice = MessageCounts(total=promised.files.get(file_key(part.name), 0)).notice(
                MessageCounts(total=count)
            )
            absent = part.file.promised_messages - count
            if notice:
                yield f"{part.path}: {notice}"
            elif absent > 0:
                rows = f"{counted(absent, 'row')} are not there: deleted, or lost"
                yield f"{part.path}: {rows.replace('are', 'is') if absent == 1 else rows}"

    def _notice_of_back(self) -> Iterator[str]:
        """Where stamps go back furthest, within a file or from one to the next."""
        filled = [part for part in self._parts if part.file.message_count]
        found = [(part.file.back_ns(), part.path) for part in filled]
        for before, after in pairwise(filled if self._is_order_known else ()):
            # Few files overlap, and only those are read for it.
            if before.file.end_ns - after.file.start_ns > LEAST_BACK_NS:
                found.append((self._back_between_ns(before.file, after.file), after.path))
        # Stamps that go back by years are left out, with a notice.
        worth = [back for back in found if LEAST_BACK_NS < back[0] <= 2 * YEAR_NS]
        for back_ns, path in sorted(worth, key=itemgetter(0))[-1:]:
            yield (
                f"{path}: stamps go back by up to {back_ns / NS_PER_S:.1f} s, as where a clock was set: "
                "messages of before and after are read by their stamps, so rates, ages and losses mix both"
            )

    def _back_between_ns(self, before: StoredFile, after: StoredFile) -> int:
        """How far the first message of a topic in ``after`` is before the last one in ``before``."""
        latest_ns = dict(self._stamps_of(before))
        first_ns: dict[str, int] = {}
        for topic, stamp_ns in self._stamps_of(after):
            first_ns.setdefault(topic, stamp_ns)
        shared = latest_ns.keys() & first_ns.keys()
        return max((latest_ns[topic] - first_ns[topic] for topic in shared), default=0)

    def _stamps_of(self, file: StoredFile) -> Iterator[tuple[str, int]]:
        """The topic and the stamp of each message, of some twice."""
        # Latched messages of an incident have the stamp of its start, wherever they stand.
        channels = {
            number: channel
            for number, channel in self._channels_of(file).items()
            if not channel.transient_local
        }
        try:
            for channel, stamp_ns, _ in file.sizes(channels):
                yield channel.topic, stamp_ns
        except OutlineError:
            for channel, stamp_ns, _ in file.messages(channels):
                yield channel.topic, stamp_ns

    @property
    def _is_intact(self) -> bool:
        """Whether all files are there, and nothing of them is known to be damaged."""
        return not self._lacks_files and all(part.file.readable_share == 1 for part in self._parts)

    def _readable_in(self, part: RecordingPart) -> int:
        """Messages of a file without those that cannot be decompressed."""
        return part.file.message_count - self._broken.get(part.file, Counter[str]()).total()

    def _counts(self, *, readable: bool = False) -> MessageCounts:
        """Messages that the files hold, or that can be read; by topic where the metadata count these."""
        topics: Counter[str] = Counter()
        for part in self._parts if self._promised.topics else ():
            held = part.file.counts()
            for number, channel in part.file.channels.items():
                topics[channel.topic] += held.get(number, 0)
            if readable:
                topics.subtract(self._broken.get(part.file, {}))
        return MessageCounts(
            total=sum(
                self._readable_in(part) if readable else part.file.message_count for part in self._parts
            ),
            topics=topics,
            files={file_key(part.name): part.file.message_count for part in self._parts},
        )

    @property
    def _filled(self) -> Sequence[StoredFile]:
        return [part.file for part in self._parts if part.file.message_count]

    def _in_time_order(
        self, read: Callable[[StoredFile], Iterator[tuple[Channel, int, _T]]]
    ) -> Iterator[tuple[Channel, int, _T]]:
        """Results of ``read`` of all files, merged, without those of another time."""
        filled = self._filled
        entries = read(filled[0]) if len(filled) == 1 else _merged(filled, read)
        return entries if self._strays is None else self._strays.left_out_of(entries)

    def _messages_of(
        self, file: StoredFile, *, topics: Collection[str] | None = None
    ) -> Iterator[RecordedMessage]:
        """The messages of ``file``, unpacked where they are packed one by one."""
        channels = self._channels_of(file)
        if topics is not None:
            channels = {number: channel for number, channel in channels.items() if channel.topic in topics}
        messages = file.messages(channels)
        return self._unpacked(file, messages) if self._is_packed(file) else messages

    def _sizes_of(self, file: StoredFile) -> Iterator[RecordedSize]:
        delivered = count()
        # A packed message that is damaged counts nowhere, so each is unpacked.
        with suppress(OutlineError):
            if not self._is_packed(file):
                # Counted without a step of Python for each.
                sizes = file.sizes(self._channels_of(file))
                yield from map(itemgetter(0), zip(sizes, delivered))  # noqa: B905  one has no end
                return
        for channel, stamp_ns, payload in islice(self._messages_of(file), next(delivered), None):
            yield channel, stamp_ns, len(payload)

    def _heads_of(self, file: StoredFile, *, head_bytes: int) -> Iterator[RecordedHead]:
        delivered = 0
        with suppress(OutlineError):
            if not self._is_packed(file):
                for channel, stamp_ns, size_bytes, head in file.outlines(self._channels_of(file), head_bytes):
                    yield channel, stamp_ns, (size_bytes, head)
                    delivered += 1
                return
        for channel, stamp_ns, payload in islice(self._messages_of(file), delivered, None):
            yield channel, stamp_ns, (len(payload), payload[:head_bytes])

    def _is_packed(self, file: StoredFile) -> bool:
        """Whether messages are packed one by one: rosbag2 packs all of a file or none; one may be damaged."""
        if file not in self._packed:
            looked_at = _LOOKED_AT if self._says_packed else 1
            # Payloads may be of hundreds of MB, so none is kept.
            first = [
                (payload.startswith(magic.ZSTD), _begins_as_cdr(payload))
                for *_, payload in islice(file.messages(file.channels), looked_at)
            ]
            is_plain = not self._says_packed or not first or any(is_cdr for _, is_cdr in first)
            self._packed[file] = not is_plain or any(is_zstd for is_zstd, _ in first)
        return self._packed[file]

    def _channels_of(self, file: StoredFile) -> ChannelsByNumber:
        return {number: self._channels.of(channel) for number, channel in file.channels.items()}

    def _unpacked(self, file: StoredFile, messages: Iterator[RecordedMessage]) -> Iterator[RecordedMessage]:
        from smarttestudo.bags.unpacking import unpack_message  # noqa: PLC0415  few are packed

        broken: Counter[str] = Counter()
        for channel, stamp_ns, packed in messages:
            payload = unpack_message(packed)
            if payload is None:
                broken[channel.topic] += 1
            else:
                yield channel, stamp_ns, payload
        # Perhaps not all topics are read each time.
        self._broken[file] = self._broken.get(file, Counter()) | broken

    def _declared_bytes(self) -> Mapping[str, int]:
        try:
            return declared_bytes_in(self.custom_data)
        except RecordingError as error:
            self._notices.append(f"{error.cause}; the sizes in the recording are used")
            return {}


def _begins_as_cdr(payload: bytes) -> bool:
    return payload[:2] in _PLAIN_CDR and payload.count(0) < len(payload)


def _first_of(paths: Sequence[Path]) -> str:
    others = len(paths) - 1
    return f"{paths[0]} and {counted(others, 'other file')}" if others else str(paths[0])


def _messages_once(files: Iterable[StoredFile]) -> float | None:
    """About how many messages ``files`` held before they were damaged; ``None`` where one does not tell."""
    total = 0.0
    for file in files:
        share = file.readable_share
        if share is None or not (share or file.promised_messages):
            return None
        total += file.message_count / share if share else file.promised_messages
    return total


def _merged(
    files: Sequence[StoredFile], read: Callable[[StoredFile], Iterator[tuple[Channel, int, _T]]]
) -> Iterator[tuple[Channel, int, _T]]:
    starts = (_from_its_start(file, read) for file in files)
    for _, entry in heapq.merge(*starts, key=itemgetter(0)):
        if entry is not None:
            yield entry


def _from_its_start(
    file: StoredFile, read: Callable[[StoredFile], Iterator[tuple[Channel, int, _T]]]
) -> Iterator[tuple[int, tuple[Channel, int, _T] | None]]:
    # The merge takes the first item of all files at once; this one keeps a file unread until it is due.
    yield file.start_ns, None
    for entry in read(file):
        yield entry[1], entry
