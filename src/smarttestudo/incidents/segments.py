# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""Files of messages that incidents of the same topics have in common."""

from __future__ import annotations

import errno
import os
import struct
from array import array
from bisect import bisect_left
from collections import deque
from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from contextlib import suppress
from dataclasses import dataclass, field
from pathlib import Path

from smarttestudo.bags.mcap.record_bytes import StoredChannel
from smarttestudo.bags.mcap.writer import FileContent, McapWriter
from smarttestudo.incidents.topic_ring import IncidentMessage

ChannelOf = Callable[[str, int], StoredChannel | None]
"""Channel of a topic's message of some number; ``None`` where the topic is not known."""
LATCHED_SHARED_NS = 10_000_000_000
"""How long before its window a file of latched messages may have been begun."""


@dataclass(slots=True, kw_only=True, eq=False)
class BagFolder:
    """A folder with the files of a bag in their order."""

    path: Path
    name: str
    files: list[tuple[str, Segment]] = field(default_factory=list)

    def next_name(self) -> str:
        """A name for one more file."""
        return f"{self.name}_{len(self.files)}.mcap"

    def has(self, segment: Segment) -> bool:
        """Whether ``segment`` is one of its files."""
        return any(one is segment for _, one in self.files)

    @property
    def first_stamp_ns(self) -> int | None:
        """The earliest stamp that a file begins with."""
        stamps = (segment.first_stamp_ns for _, segment in self.files)
        return min((one for one in stamps if one is not None), default=None)

    def put_last_first(self) -> None:
        """Have the file that was added last before all others."""
        self.files.insert(0, self.files.pop())

    def contents(self) -> dict[str, FileContent]:
        """Content of its files by name, in the order of time; all of them are closed."""
        contents = [(name, segment.content) for name, segment in self.files if segment.content is not None]
        # Some readers go through one file after the other.
        return dict(sorted(contents, key=lambda entry: entry[1].first_ns))

    def holds(self, number: int) -> bool:
        """Whether the message of that number is in it."""
        return any(segment.holds(number) for _, segment in self.files)


class Segment:
    """One file, which may be in several folders by hard links. ``content`` is known once it is closed.

    ``numbers`` are those of its messages, which rise.
    """

    def __init__(self, folder: BagFolder) -> None:
        self.numbers = array("q")
        self.first_stamp_ns: int | None = None
        self.content: FileContent | None = None
        self._holders: list[tuple[BagFolder, str]] = []
        name = folder.next_name()
        self._writer: McapWriter | None = McapWriter(folder.path / name)
        self._hold(folder, name)

    def link_to(self, folder: BagFolder) -> None:
        """Have it in one more folder. Raises ``OSError``, also where no folder has it any more."""
        name = folder.next_name()
        problem: OSError = FileNotFoundError(
            errno.ENOENT, "no file is left to link to", str(folder.path / name)
        )
        for holder, held_name in self._holders:
            failed = link_file(holder.path / held_name, folder.path / name)
            if failed is None:
                self._hold(folder, name)
                return
            problem = failed
        raise problem

    def write(self, channel: StoredChannel, message: IncidentMessage, stamp_ns: int) -> None:
        """Append a message to a file that is not closed. Raises ``OSError``."""
        assert self._writer is not None
        self._writer.write(channel, stamp_ns, message.payload)
        if self.first_stamp_ns is None:
            self.first_stamp_ns = stamp_ns
        self.numbers.append(message.number)

    def close(self) -> None:
        """Make the file whole. Raises ``OSError``."""
        if self._writer is not None:
            self.content = self._writer.close()
            # It knows the place of each message, and the segment may be kept for long.
            self._writer = None

    def abandon(self) -> None:
        """Leave the file as it is."""
        if self._writer is not None:
            self._writer.abandon()

    def holds(self, number: int) -> bool:
        """Whether the message of that number is in it."""
        at = bisect_left(self.numbers, number)
        return at < len(self.numbers) and self.numbers[at] == number

    def is_over(self, stamp_ns: int, length_ns: int) -> bool:
        """Whether a message at ``stamp_ns`` belongs to the next segment."""
        first_ns = self.first_stamp_ns
        return first_ns is not None and not first_ns <= stamp_ns < first_ns + length_ns

    def _hold(self, folder: BagFolder, name: str) -> None:
        folder.files.append((name, self))
        self._holders.append((folder, name))


def channel_of(channels: Mapping[str, StoredChannel]) -> ChannelOf:
    """For topics that never change."""
    return lambda topic, _: channels.get(topic)


def link_file(file: Path, name: Path) -> OSError | None:
    """Have ``file`` under one more name; why, if it cannot be."""
    try:
        os.link(file, name)
    except OSError as error:
        return error
    return None


class SharedMessages:
    """The messages of some topics, in segments of ``length_ns`` each, as the incidents of these topics need.

    A message is written once. An incident begins with the segment in which its window does: where it overlaps
    an earlier one, that may be up to a segment more than was asked for. Segments end where a window does.
    """

    def __init__(self, channels: Mapping[str, StoredChannel], length_ns: int, channel_of: ChannelOf) -> None:
        self._channels = channels
        self._channel_of = channel_of
        self._length_ns = length_ns
        self._segments: list[Segment] = []
        self._open: Segment | None = None
        self._longest_ns = 0
        self._latched: tuple[Sequence[int], int, Segment] | None = None
        self.members: list[BagFolder] = []

    def begin(self, folder: BagFolder, from_number: int, messages: Iterable[IncidentMessage]) -> None:
        """Have ``messages`` in ``folder``, what is stored from ``from_number`` on, and all to come.

        ``messages`` are in the order of their numbers. Raises ``OSError``.
        """
        rest = _Waiting(messages)
        for segment in list(self._segments):
            if segment.numbers[-1] < from_number:
                continue
            self._segments += self._written(folder, rest.up_to(segment.numbers[0]))
            try:
                segment.link_to(folder)
            except OSError:
                # What it holds is written once more, as far as it is still there.
                self._segments.remove(segment)
            else:
                rest.skip_to(segment.numbers[-1] + 1)
        self._segments += self._written(folder, rest.up_to(None))
        self._segments.sort(key=lambda segment: segment.numbers[0])
        if self._open is not None and not folder.has(self._open):
            self.cut()
        self.members.append(folder)

    def forget_before(self, trigger_ns: int, before_ns: int) -> None:
        """Share no segments any more that no window will reach: none was longer so far."""
        self._longest_ns = max(self._longest_ns, before_ns)
        self._segments = [
            one
            for one in self._segments
            if one.content is None or one.content.last_ns >= trigger_ns - self._longest_ns
        ]

    def add_latched(self, folder: BagFolder, latched: Sequence[IncidentMessage], from_ns: int) -> None:
        """Have ``latched``, from before its window, in ``folder``, with the stamp of its beginning.

        That is earlier where a shared file begins before: what is in that came later. Raises ``OSError``.
        """
        latched = [message for message in latched if message.topic in self._channels]
        if not latched:
            return
        first_ns = folder.first_stamp_ns
        # A window may begin before the simulated time does, and no stamp can.
        start_ns = max(0, from_ns if first_ns is None else min(from_ns, first_ns))
        numbers = [message.number for message in latched]
        if self._latched is not None:
            known, stamp_ns, segment = self._latched
            if known == numbers and 0 <= start_ns - stamp_ns <= LATCHED_SHARED_NS:
                with suppress(OSError):
                    segment.link_to(folder)
                    folder.put_last_first()
                    return
        segment = Segment(folder)
        try:
            for message in latched:
                self._write(segment, message, start_ns)
            segment.close()
        except (OSError, struct.error):
            segment.abandon()
            raise
        folder.put_last_first()
        self._latched = (numbers, start_ns, segment)

    def write(self, message: IncidentMessage) -> None:
        """One more message for all members. Raises ``OSError``."""
        if message.topic not in self._channels:
            return
        segment = self._open
        if segment is None or segment.is_over(message.stamp_ns, self._length_ns):
            self.cut()
            segment = self._open = Segment(self.members[0])
            for folder in self.members[1:]:
                segment.link_to(folder)
            self._segments.append(segment)
        self._write(segment, message, message.stamp_ns)

    def end(self, folder: BagFolder) -> None:
        """``folder`` has all it needs. Raises ``OSError``."""
        self.members.remove(folder)
        self.cut()
        if not folder.files:
            # A bag without files is none.
            Segment(folder).close()

    def cut(self) -> None:
        """End the segment that is open. Raises ``OSError``."""
        segment, self._open = self._open, None
        if segment is not None:
            segment.close()

    def abandon(self) -> None:
        """Leave all files as they are, and share none of them any more."""
        if self._open is not None:
            self._open.abandon()
        self._open, self._latched = None, None
        self._segments, self.members = [], []

    def _written(self, folder: BagFolder, messages: Iterable[IncidentMessage]) -> list[Segment]:
        """Closed segments of ``folder`` with ``messages``."""
        segments: list[Segment] = []
        try:
            for message in messages:
                if message.topic not in self._channels:
                    continue
                if not segments or segments[-1].is_over(message.stamp_ns, self._length_ns):
                    if segments:
                        segments[-1].close()
                    segments.append(Segment(folder))
                self._write(segments[-1], message, message.stamp_ns)
            if segments:
                segments[-1].close()
        except OSError:
            for one in segments[-1:]:
                one.abandon()
            raise
        return segments

    def _write(self, segment: Segment, message: IncidentMessage, stamp_ns: int) -> None:
        channel = self._channel_of(message.topic, message.number)
        if channel is not None:
            segment.write(channel, message, stamp_ns)


class _Waiting:
    """Messages in the order of their numbers, taken from the front."""

    def __init__(self, messages: Iterable[IncidentMessage]) -> None:
        self._messages = iter(messages)
        self._next = next(self._messages, None)

    def up_to(self, number: int | None) -> Iterator[IncidentMessage]:
        """Messages before ``number``, or all."""
        while self._next is not None and (number is None or self._next.number < number):
            taken, self._next = self._next, next(self._messages, None)
            yield taken

    def skip_to(self, number: int) -> None:
        """Leave out those before ``number``."""
        deque(self.up_to(number), maxlen=0)
