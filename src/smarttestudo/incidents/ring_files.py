# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""Ring on disk of messages that memory had no room for, until no window may ask for them any more."""

from __future__ import annotations

import errno
import os
import tempfile
from array import array
from collections import deque
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from operator import attrgetter
from pathlib import Path

from smarttestudo.domain.errors import TestudoError
from smarttestudo.files.whole_file import not_written
from smarttestudo.incidents.topic_ring import GivenUp, SourceMessage

_FILES = 64


@dataclass(frozen=True, slots=True, kw_only=True)
class StoredMessage:
    """An ``IncidentMessage`` whose payload is read when it is asked for."""

    number: int
    topic: str
    stamp_ns: int
    file: _RingFile
    index: int

    @property
    def payload(self) -> bytes:
        """Bytes of the message, from the disk."""
        return self.file.read(self.index)


class RingFiles:
    """Messages that memory gave up, in files of ``folder``, at most ``max_bytes``; the oldest go first.

    The files have no names: nothing is left of them when the process ends, whatever ends it. There are about
    64 where all is taken; one goes when no window asks for anything in it. Beside the disk, a message takes
    16 bytes of memory.

    What cannot be written is lost. ``problem`` says why, until something can be written again; ``failed`` is
    told of it once.
    """

    def __init__(self, folder: Path, max_bytes: int, *, failed: Callable[[TestudoError], None]) -> None:
        self._folder = folder
        self._max_bytes = max_bytes
        self._failed = failed
        self._files: deque[_RingFile] = deque()
        self.size_bytes = 0
        self.problem: TestudoError | None = None

    def store(self, message: SourceMessage, until_ns: int, now_ns: int) -> None:
        """Keep a message until ``until_ns``; it is ``now_ns``, both steady times."""
        size_bytes = len(message.payload)
        while self._files and self._files[0].until_ns < now_ns:
            self._remove_oldest()
        if size_bytes > self._max_bytes:
            return
        while self.size_bytes + size_bytes > self._max_bytes:
            self._remove_oldest()
        try:
            if not self._files or self._files[-1].size_bytes + size_bytes > self._max_bytes // _FILES:
                self._files.append(_RingFile(self._folder))
            self._files[-1].write(message, until_ns)
        except OSError as error:
            if self.problem is None:
                self.problem = not_written(self._folder, "what came before an incident", error)
                self._failed(self.problem)
            return
        self.size_bytes += size_bytes
        self.problem = None

    def messages(self, given_up: Mapping[str, Sequence[GivenUp]]) -> list[StoredMessage]:
        """Messages among those given up that are there, in their order; valid until the next is stored."""
        wanted = {gone.number: (topic, gone.stamp_ns) for topic, given in given_up.items() for gone in given}
        found = [
            StoredMessage(number=number, topic=topic, stamp_ns=stamp_ns, file=file, index=index)
            for file in self._files
            for index, number in enumerate(file.numbers)
            if number in wanted
            for topic, stamp_ns in [wanted[number]]
        ]
        return sorted(found, key=attrgetter("number"))

    def close(self) -> None:
        """Give all of it back to the disk."""
        while self._files:
            self._remove_oldest()

    def _remove_oldest(self) -> None:
        oldest = self._files.popleft()
        self.size_bytes -= oldest.size_bytes
        oldest.close()


class _RingFile:
    """Payloads one after the other; ``until_ns`` is when the last of them is no longer asked for."""

    def __init__(self, folder: Path) -> None:
        self.numbers = array("q")
        self.until_ns = 0
        self._ends = array("q")
        self._file = tempfile.TemporaryFile(dir=folder, buffering=0)  # noqa: SIM115 - closed by its owner

    @property
    def size_bytes(self) -> int:
        return self._ends[-1] if self._ends else 0

    def write(self, message: SourceMessage, until_ns: int) -> None:
        """Append a message; where that fails, nothing counts of it."""
        rest, place = memoryview(message.payload), self.size_bytes
        while rest:
            written = os.pwrite(self._file.fileno(), rest, place)
            rest, place = rest[written:], place + written
        self._ends.append(place)
        self.numbers.append(message.number)
        self.until_ns = max(self.until_ns, until_ns)

    def read(self, index: int) -> bytes:
        start, end = self._ends[index - 1] if index else 0, self._ends[index]
        payload = os.pread(self._file.fileno(), end - start, start)
        if len(payload) < end - start:
            raise OSError(errno.EIO, os.strerror(errno.EIO))
        return payload

    def close(self) -> None:
        self._file.close()
