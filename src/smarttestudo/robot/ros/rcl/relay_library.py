# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""The functions of relay.c, and the structures that it shares with Python."""

from __future__ import annotations

import ctypes
from ctypes import c_int, c_int64, c_size_t, c_uint8, c_uint32, c_uint64, c_void_p
from pathlib import Path

from smarttestudo.domain.compiled_relay import PacedStream, RelayCounts
from smarttestudo.domain.errors import RosError
from smarttestudo.pacing.grid import NEVER_NS
from smarttestudo.pacing.source_gaps import BUCKETS
from smarttestudo.robot.ros.rcl.bindings import Allocator, SerializedMessage, bytes_at

LIBRARY = Path(__file__).with_name("relay.so")
"""Where setup.py puts it, if there is a C compiler."""
ABI = 4
GID_BYTES = 24
C_NEVER_NS = 1 << 62
"""What stands there for ``NEVER_NS``."""


class CGaps(ctypes.Structure):
    """A gaps_t."""

    _fields_ = tuple((name, c_int64) for name in ("count", "total_ns", "squares_us2", "longest_ns"))

    def numbers(self) -> tuple[int, int, int, int]:
        """All four."""
        return self.count, self.total_ns, self.squares_us2, self.longest_ns


class CStream(ctypes.Structure):
    """A stream_t; ``held`` is what C or Python holds, for now."""

    _fields_ = (
        ("gid", c_uint8 * GID_BYTES),
        ("number", c_uint64),
        ("due_ns", c_int64),
        ("phase_ns", c_int64),
        ("held_ns", c_int64),
        ("last_ns", c_int64),
        ("lag_ns", c_int64),
        ("step_ns", c_int64),
        ("buckets", CGaps * BUCKETS),
        ("sum", CGaps),
        ("has_last", c_uint32),
        ("is_open", c_uint32),
        ("is_held", c_uint32),
        ("is_phase_falling", c_uint32),
        ("held", SerializedMessage),
    )

    def paced_stream(self, gid_bytes: int) -> PacedStream:
        """The same in Python, with a copy of what is held."""
        held = bytes_at(self.held.buffer or 0, self.held.length) if self.is_held else None
        return PacedStream(
            publisher=bytes(self.gid[:gid_bytes]),
            due_ns=python_ns(self.due_ns),
            phase_ns=self.phase_ns,
            is_phase_falling=bool(self.is_phase_falling),
            last_ns=self.last_ns if self.has_last else None,
            lag_ns=self.lag_ns,
            step_ns=self.step_ns,
            gaps=[bucket.numbers() for bucket in self.buckets],
            held=held,
            held_ns=self.held_ns,
        )


class RelayFunctions(ctypes.Structure):
    """A functions_t: pointers to functions of librcl, and to a clock, or ``None`` for the system's."""

    _fields_ = tuple((name, c_void_p) for name in ("take", "publish", "error_text", "reset_error", "now_ns"))


class RelaySettings(ctypes.Structure):
    """A settings_t."""

    _fields_ = (
        ("rcl", RelayFunctions),
        ("allocator", Allocator),
        ("subscription", c_void_p),
        ("publisher", c_void_p),
        ("gid_bytes", c_uint32),
        ("takes_on_callback", c_uint32),
        ("publishes_at_once", c_uint32),
        ("gives_gid", c_uint32),
        ("period_ns", c_int64),
        ("counts", RelayCounts),
    )


class RelayLibrary:
    """relay.c, compiled. Relays are addresses. Raises ``RosError`` where it is not there or another one."""

    def __init__(self, path: Path | None = None) -> None:
        try:
            library = ctypes.CDLL(str(path or LIBRARY))
            sizes = (c_size_t * 4).in_dll(library, "relay_sizes")
            self.on_message = ctypes.cast(library.relay_on_message, c_void_p)
            self._new, self.free = library.relay_new, library.relay_free
            self._add_stream, self._streams = library.relay_add_stream, library.relay_streams
            self.start, self.stop, self._step = library.relay_start, library.relay_stop, library.relay_step
            self._set_pace, self._read = library.relay_set_pace, library.relay_read
        except (OSError, AttributeError) as error:
            raise RosError(f"there are no compiled relays: {error}", remedy=REMEDY) from error
        if tuple(sizes) != (ABI, *map(ctypes.sizeof, (RelaySettings, CStream, RelayCounts))):
            raise RosError("the compiled relays are of another version", remedy=REMEDY)
        self._new.argtypes, self._new.restype = [c_void_p], c_void_p
        self._set_pace.argtypes, self._set_pace.restype = [c_void_p, c_int64], None
        self._add_stream.argtypes = [c_void_p, c_void_p]
        self._streams.argtypes, self._streams.restype = [c_void_p, c_void_p], c_size_t
        self._read.argtypes, self._read.restype = [c_void_p, c_void_p], None
        self.start.argtypes, self.start.restype = [c_void_p], c_int
        self._step.argtypes, self._step.restype = [c_void_p, c_int], c_int64
        for function in (self.stop, self.free):
            function.argtypes, function.restype = [c_void_p], None

    def new(self, settings: RelaySettings) -> int:
        """A relay that does not run yet; ``free`` it at the end. Raises ``MemoryError``."""
        relay: int | None = self._new(ctypes.addressof(settings))
        if relay is None:
            raise MemoryError
        return relay

    def add_stream(self, relay: int, state: PacedStream | None, gid: bytes, number: int) -> None:
        """Have ``relay`` know publisher ``gid``, its last number, and its stream if it has one."""
        stream = CStream(gid=(c_uint8 * GID_BYTES)(*gid), number=number)
        if state is not None:
            stream.is_open = True
            stream.due_ns, stream.held_ns = c_ns(state.due_ns), state.held_ns
            stream.phase_ns, stream.is_phase_falling = state.phase_ns, state.is_phase_falling
            stream.has_last, stream.last_ns = state.last_ns is not None, state.last_ns or 0
            stream.lag_ns, stream.step_ns = state.lag_ns, state.step_ns
            for place, numbers in enumerate(state.gaps):
                stream.buckets[place] = CGaps(*numbers)
            held = b"" if state.held is None else state.held[:]
            stream.is_held = state.held is not None
            stream.held.buffer = ctypes.cast(ctypes.c_char_p(held), c_void_p)
            stream.held.length = len(held)
        if not self._add_stream(relay, ctypes.addressof(stream)):
            raise MemoryError

    def streams(self, relay: int) -> list[CStream]:
        """The streams of a relay that was stopped; what they hold is gone once it is freed."""
        first = ctypes.POINTER(CStream)()
        count: int = self._streams(relay, ctypes.addressof(first))
        return first[:count]

    def set_pace(self, relay: int, period_ns: int) -> None:
        """Follow another pace from now on."""
        self._set_pace(relay, c_ns(period_ns))

    def step(self, relay: int) -> int | None:
        """Take, pace and publish what there is; in how many ns to do so again at the latest."""
        wait_ns: int = self._step(relay, 1)
        return None if wait_ns >= C_NEVER_NS else max(wait_ns, 0)

    def counts(self, relay: int) -> RelayCounts:
        """The counts as of now."""
        counts = RelayCounts()
        self._read(relay, ctypes.addressof(counts))
        return counts


REMEDY = "install a C compiler, then SmartTestudo again"


def c_ns(ns: int) -> int:
    """A time or period in 64 bits."""
    return max(-C_NEVER_NS, min(ns, C_NEVER_NS))


def python_ns(ns: int) -> int:
    """A time or period of ``c_ns``."""
    return ns if abs(ns) < C_NEVER_NS else (NEVER_NS if ns > 0 else -NEVER_NS)
