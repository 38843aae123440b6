# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""Copies of the messages that compiled relays take or let pass, read many at once: copies.c."""

from __future__ import annotations

import ctypes
import os
import struct
from collections import deque
from collections.abc import Callable, Iterable
from ctypes import c_int, c_size_t, c_uint64, c_void_p
from dataclasses import dataclass
from itertools import count
from pathlib import Path

from smarttestudo.domain.compiled_relay import MessageCopy
from smarttestudo.domain.errors import RosError
from smarttestudo.domain.robot import Instant
from smarttestudo.robot.ros.rcl.bindings import bytes_at
from smarttestudo.robot.ros.rcl.relay_library import LIBRARY, REMEDY

WAKES_FROM_BYTES = 1 << 17
"""From so many bytes on, a run that waits for messages is woken to read the copies."""
MOST_BYTES = 1 << 23
"""What is not read by then is not copied any more."""
LAST_NS = 2**63 - 1

Copied = Callable[[int, MessageCopy], None]
"""Takes the publisher's number of a message, 0 for one that passed, and its copy."""

_HEADER = struct.Struct("=QQQQqq24s")
_WORD_BYTES = 8


class _CCopied(ctypes.Structure):
    """A copied_t."""

    _fields_ = (
        ("copies", c_void_p),
        ("take", c_void_p),
        ("subscription", c_void_p),
        ("source", c_uint64),
        ("gid_bytes", c_uint64),
        ("has_payload", c_uint64),
    )


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class CopiedSource:
    """A source of copies, which stands at ``address`` for a subscription, or for a publisher."""

    number: int
    gid_bytes: int
    copied: Copied
    structure: _CCopied

    @property
    def address(self) -> int:
        """The place that a relay takes from, or publishes by."""
        return ctypes.addressof(self.structure)


class MessageCopies:
    """Copies of the messages of several sources, in the order in which they were taken or passed.

    ``event_fd`` is counted up when there is much to read, or something passed. ``failed`` gets an error for
    what passed and was lost; ``clocks`` are others than the system's. Raises ``RosError`` where the library
    of compiled relays has no such functions.
    """

    def __init__(
        self,
        failed: Callable[[RosError], None],
        path: Path | None = None,
        *,
        wakes_from_bytes: int = WAKES_FROM_BYTES,
        most_bytes: int = MOST_BYTES,
        clocks: tuple[c_void_p, c_void_p] | None = None,
    ) -> None:
        self._failed = failed
        self._library = library = _Library(path or LIBRARY)
        self.take, self.publish = library.take, library.publish
        self.event_fd = os.eventfd(0, os.EFD_NONBLOCK | os.EFD_CLOEXEC)
        self._address = library.new(wakes_from_bytes, most_bytes, self.event_fd, *(clocks or (None, None)))
        self._numbers = count()
        self._sources: dict[int, CopiedSource] = {}
        self._waiting: deque[tuple[Copied, int, MessageCopy]] = deque()

    def of_taken(
        self, take: c_void_p, subscription: int, gid_bytes: int, copied: Copied, *, has_payload: bool
    ) -> CopiedSource:
        """Have ``copied`` get what is taken from ``subscription`` by ``take``, until it is removed."""
        structure = _CCopied(take=take, subscription=subscription, has_payload=has_payload)
        return self._add(structure, gid_bytes, copied)

    def of_passed(self, gid_bytes: int, copied: Copied) -> CopiedSource:
        """Have ``copied`` get what passes, until it is removed."""
        return self._add(_CCopied(has_payload=True), gid_bytes, copied)

    def remove(self, sources: Iterable[CopiedSource]) -> None:
        """Copy nothing more of sources that no relay uses any more; all there is, is delivered."""
        self.deliver(LAST_NS)
        for source in sources:
            del self._sources[source.number]

    def deliver(self, steady_ns: int) -> None:
        """Deliver the copies that were made by ``steady_ns``."""
        if not self._sources:
            return
        self._read()
        waiting = self._waiting
        # What gets a copy may end a relay, and so deliver the others.
        while waiting and waiting[0][2].at.steady_ns <= steady_ns:
            copied, number, copy = waiting.popleft()
            copied(number, copy)

    def close(self) -> None:
        """Free the copies; no relay may use a source any more."""
        self._library.free(self._address)
        os.close(self.event_fd)

    def _add(self, structure: _CCopied, gid_bytes: int, copied: Copied) -> CopiedSource:
        number = next(self._numbers)
        structure.copies, structure.source, structure.gid_bytes = self._address, number, gid_bytes
        source = CopiedSource(number=number, gid_bytes=gid_bytes, copied=copied, structure=structure)
        self._sources[number] = source
        return source

    def _read(self) -> None:
        """Have the copies wait that were made since the last time."""
        at, length, dropped = self._library.swap(self._address)
        if dropped:
            self._failed(
                RosError(f"messages passed and were lost, since nobody took them in time: {dropped}")
            )
        end = at + length
        while at < end:
            header = _HEADER.unpack(bytes_at(at, _HEADER.size))
            number_of_source, number, size_bytes, copied_bytes, stamp_ns, steady_ns, gid = header
            at += _HEADER.size
            source = self._sources[number_of_source]
            payload = bytes_at(at, copied_bytes) if source.structure.has_payload else None
            copy = MessageCopy(
                at=Instant(stamp_ns, steady_ns),
                publisher=gid[: source.gid_bytes],
                size_bytes=size_bytes,
                payload=payload,
            )
            self._waiting.append((source.copied, number, copy))
            at += copied_bytes + -copied_bytes % _WORD_BYTES


class _Library:
    """The functions of copies.c."""

    def __init__(self, path: Path) -> None:
        try:
            library = ctypes.CDLL(str(path))
            sizes = (c_size_t * 2).in_dll(library, "copies_sizes")
            self.take = ctypes.cast(library.copies_take, c_void_p)
            self.publish = ctypes.cast(library.copies_publish, c_void_p)
            self._new, self._swap, self.free = library.copies_new, library.copies_swap, library.copies_free
        except (OSError, ValueError, AttributeError) as error:
            raise RosError(f"messages cannot be copied: {error}", remedy=REMEDY) from error
        if tuple(sizes) != (ctypes.sizeof(_CCopied), _HEADER.size):
            raise RosError("the compiled relays are of another version", remedy=REMEDY)
        self._new.argtypes, self._new.restype = [c_size_t, c_size_t, c_int, c_void_p, c_void_p], c_void_p
        self._swap.argtypes, self._swap.restype = [c_void_p, c_void_p, c_void_p], c_size_t
        self.free.argtypes, self.free.restype = [c_void_p], None

    def new(self, wakes_from_bytes: int, most_bytes: int, event_fd: int, *clocks: c_void_p | None) -> int:
        """Copies of no source yet; ``free`` them at the end. Raises ``MemoryError``."""
        copies: int | None = self._new(wakes_from_bytes, most_bytes, event_fd, *clocks)
        if copies is None:
            raise MemoryError
        return copies

    def swap(self, copies: int) -> tuple[int, int, int]:
        """Where that is which was filled since the last swap, its length, and what passed without room."""
        first, dropped = c_void_p(), c_uint64()
        length: int = self._swap(copies, ctypes.addressof(first), ctypes.addressof(dropped))
        return first.value or 0, length, dropped.value
