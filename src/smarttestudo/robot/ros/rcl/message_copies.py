# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""Copies of the messages that compiled relays take, read many at once: the functions of copies.c."""

from __future__ import annotations

import ctypes
import os
import struct
from collections import deque
from collections.abc import Callable, Iterator
from ctypes import c_int, c_size_t, c_uint64, c_void_p
from functools import partial
from itertools import count
from pathlib import Path

from smarttestudo.domain.errors import RosError
from smarttestudo.robot.ros.rcl.bindings import bytes_at
from smarttestudo.robot.ros.rcl.relay_library import LIBRARY, REMEDY

WAKES_FROM_BYTES = 1 << 17
"""From so many bytes on, whoever waits for messages is woken to read the copies."""
MOST_BYTES = 1 << 23
"""What is not read by then is not copied any more."""

Copied = Callable[[int, bytes, bytes, int], None]
"""Takes a copy: the publisher's number of it, the publisher, the payload, and when it was taken."""

_HEADER = struct.Struct("=QQQq24s")
_WORD_BYTES = 8


class _CCopied(ctypes.Structure):
    """A copied_t."""

    _fields_ = (
        ("copies", c_void_p),
        ("take", c_void_p),
        ("subscription", c_void_p),
        ("source", c_uint64),
        ("gid_bytes", c_uint64),
    )


class CopiedSource:
    """A subscription whose messages are copied; a relay takes from ``address`` by ``take``."""

    def __init__(self, library: _Library, number: int, copied: Copied, structure: _CCopied) -> None:
        self.take = library.take
        self.number = number
        self.copied = copied
        self.gid_bytes: int = structure.gid_bytes
        self.address = ctypes.addressof(structure)
        self._structure = structure


class MessageCopies:
    """Copies of the messages of several sources, in the order in which they were taken.

    ``event_fd`` is counted up when there is much to read. Raises ``RosError`` where the library of compiled
    relays has no such functions.
    """

    priority = 1.0

    def __init__(
        self,
        path: Path | None = None,
        *,
        wakes_from_bytes: int = WAKES_FROM_BYTES,
        most_bytes: int = MOST_BYTES,
        now_ns: c_void_p | None = None,
    ) -> None:
        self._library = _Library(path or LIBRARY)
        self.event_fd = os.eventfd(0, os.EFD_NONBLOCK | os.EFD_CLOEXEC)
        self._address = self._library.new(wakes_from_bytes, most_bytes, self.event_fd, now_ns)
        self._numbers = count()
        self._sources: dict[int, CopiedSource] = {}
        self._waiting: deque[Callable[[], None]] = deque()

    def add(self, take: c_void_p, subscription: int, gid_bytes: int, copied: Copied) -> CopiedSource:
        """Have ``copied`` told what is taken from ``subscription`` by ``take``, until it is removed."""
        number = next(self._numbers)
        structure = _CCopied(self._address, take, subscription, number, gid_bytes)
        self._sources[number] = source = CopiedSource(self._library, number, copied, structure)
        return source

    def remove(self, source: CopiedSource) -> None:
        """Copy nothing more of a source that no relay takes from any more; all there is, is delivered."""
        self._deliver(None)
        del self._sources[source.number]

    def deliver(self, now_ns: int) -> None:
        """Deliver what was taken by ``now_ns``, on the clock."""
        if self._sources:
            self._deliver(now_ns)

    def serve(self, most: int) -> bool:  # noqa: ARG002 - of what waits
        """Do nothing: a run delivers whenever it was woken."""
        return False

    def close(self) -> None:
        """Free the copies; no relay may take from a source any more."""
        self._library.free(self._address)
        os.close(self.event_fd)

    def _deliver(self, until_ns: int | None) -> None:
        waiting = self._waiting
        # What waits was taken before now; if its stamp is later all the same, the clock was set back.
        while waiting:
            waiting.popleft()()
        for copied, number, publisher, payload, stamp_ns in self._read():
            if waiting or (until_ns is not None and stamp_ns > until_ns):
                waiting.append(partial(copied, number, publisher, payload, stamp_ns))
            else:
                copied(number, publisher, payload, stamp_ns)

    def _read(self) -> Iterator[tuple[Copied, int, bytes, bytes, int]]:
        """Copies made since the last time; to be gone through before the next."""
        at, length = self._library.swap(self._address)
        end = at + length
        while at < end:
            header = bytes_at(at, _HEADER.size)
            number_of_source, number, size_bytes, stamp_ns, gid = _HEADER.unpack(header)
            at += _HEADER.size
            source = self._sources[number_of_source]
            yield source.copied, number, gid[: source.gid_bytes], bytes_at(at, size_bytes), stamp_ns
            at += size_bytes + -size_bytes % _WORD_BYTES


class _Library:
    """The functions of copies.c."""

    def __init__(self, path: Path) -> None:
        try:
            library = ctypes.CDLL(str(path))
            sizes = (c_size_t * 2).in_dll(library, "copies_sizes")
            self.take = ctypes.cast(library.copies_take, c_void_p)
            self._new, self._swap, self.free = library.copies_new, library.copies_swap, library.copies_free
        except (OSError, ValueError, AttributeError) as error:
            raise RosError(f"messages cannot be copied: {error}", remedy=REMEDY) from error
        if tuple(sizes) != (ctypes.sizeof(_CCopied), _HEADER.size):
            raise RosError("the compiled relays are of another version", remedy=REMEDY)
        self._new.argtypes, self._new.restype = [c_size_t, c_size_t, c_int, c_void_p], c_void_p
        self._swap.argtypes, self._swap.restype = [c_void_p, c_void_p], c_size_t
        self.free.argtypes, self.free.restype = [c_void_p], None

    def new(self, wakes_from_bytes: int, most_bytes: int, event_fd: int, now_ns: c_void_p | None) -> int:
        """Copies of no source yet; ``free`` them at the end. Raises ``MemoryError``."""
        copies: int | None = self._new(wakes_from_bytes, most_bytes, event_fd, now_ns)
        if copies is None:
            raise MemoryError
        return copies

    def swap(self, copies: int) -> tuple[int, int]:
        """Where that is which was filled since the last swap, and its length."""
        first = c_void_p()
        length: int = self._swap(copies, ctypes.addressof(first))
        return first.value or 0, length
