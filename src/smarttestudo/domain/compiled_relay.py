# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""Interface to relays that are compiled, and so need no Python for a message."""

from __future__ import annotations

import ctypes
from collections.abc import Callable, Sequence
from ctypes import c_char, c_int64, c_uint8, c_uint64
from dataclasses import dataclass
from typing import Protocol

from smarttestudo.domain.robot import Instant, Payload, Publisher, Subscription

MAX_PERIOD_NS = 1 << 50
"""The longest period that is paced there, 13 days: beyond, times would not fit into 64 bits."""
BEGINNING_BYTES = 16
ERROR_BYTES = 256


@dataclass(frozen=True, slots=True, kw_only=True)
class PacedStream:
    """The messages of one publisher: their grid, their gaps, and the newest message if it is held.

    ``gaps`` are the numbers of each ``Gaps`` of ``SourceGaps``.
    """

    publisher: bytes
    due_ns: int
    held: Payload | None
    held_ns: int
    phase_ns: int = 0
    is_phase_falling: bool = False
    last_ns: int | None = None
    lag_ns: int = 0
    step_ns: int = 0
    gaps: Sequence[tuple[int, int, int, int]] = ()


class FlowCounts(ctypes.Structure):
    """Counts of a flow: its last message is of ``last_ns``, ``span_ns`` after the first. A flow_t."""

    _fields_ = (
        ("messages", c_uint64),
        ("size_bytes", c_uint64),
        ("span_ns", c_int64),
        ("last_ns", c_int64),
    )


class RelayCounts(ctypes.Structure):
    """All that a relay counts of a topic, until ``now_ns``: a counts_t.

    ``beginning`` begins the message that was relayed last, ``error`` is the last of the ``errors``.
    """

    _fields_ = (
        ("arrived", FlowCounts),
        ("relayed", FlowCounts),
        ("sent", c_uint64),
        ("lost", c_uint64),
        ("errors", c_uint64),
        ("now_ns", c_int64),
        ("_beginning_bytes", c_uint64),
        ("_beginning", c_uint8 * BEGINNING_BYTES),
        ("error", c_char * ERROR_BYTES),
    )

    @property
    def beginning(self) -> bytes:
        return bytes(self._beginning[: self._beginning_bytes])


@dataclass(frozen=True, slots=True, kw_only=True)
class RelayState:
    """All that a relay of one topic knows at ``now_ns``; the period as that of a ``Pace``."""

    now_ns: int
    period_ns: int
    streams: Sequence[PacedStream]
    counts: RelayCounts


@dataclass(frozen=True, slots=True, kw_only=True)
class MessageCopy:
    """A message of a compiled relay, made ``at`` once; without its ``payload`` where only its size counts."""

    at: Instant
    publisher: bytes
    size_bytes: int
    payload: bytes | None


@dataclass(frozen=True, slots=True, kw_only=True)
class Copying:
    """Copies of the messages of a relay, given by ``CompiledRelays.deliver`` in the order of all relays.

    ``received`` gets one of each message, relayed or not, ``has_payload`` with its content. Where there is
    ``passed``, the relay publishes nothing, and gives it a copy of what passes in its place.
    """

    received: Callable[[MessageCopy], None] | None = None
    has_payload: bool = False
    passed: Callable[[MessageCopy], None] | None = None


class CompiledRelay(Protocol):
    """A topic that is relayed without Python from its subscription to its publisher, in its own threads."""

    def set_pace(self, period_ns: int) -> None:
        """Follow another pace from now on."""

    def counts(self) -> RelayCounts:
        """The counts until now, with those from before the relay began."""

    def end(self) -> None:
        """Relay nothing more; messages that were not taken yet come to the subscription as before."""


class CompiledRelays(Protocol):
    """Maker of compiled relays."""

    @property
    def can_relay(self) -> bool:
        """Whether there may be any now: not while time is simulated."""

    def serves(self, subscription: Subscription, publisher: Publisher | None) -> bool:
        """Whether there may be one between these two, or one that publishes nothing."""

    def begin(
        self,
        subscription: Subscription,
        publisher: Publisher | None,
        state: Callable[[], RelayState],
        ended: Callable[[RelayState], None],
        copying: Copying,
    ) -> CompiledRelay | None:
        """Relay from ``state`` on, which is asked for at the last moment; ``None``: not yet.

        Without a ``publisher`` nothing passes, unless it goes to ``copying.passed``. ``ended`` gets the last
        state once, before the subscription receives anything: by ``end``, or where one of the two is closed.
        Before that, ``copying`` gets all copies that were not delivered.
        """

    def deliver(self, steady_ns: int) -> None:
        """Give the copies that were made by ``steady_ns``."""
