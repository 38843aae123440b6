# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""What every pacer of a topic can be asked."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Protocol

from smarttestudo.pacing.sample import Pass, Sample


class Pacer(Protocol):
    """Decides which messages of one relayed topic pass: a ``TopicPacer`` or a ``Follower``.

    Times are ns of one clock, the caller's; it may jump back, which starts every grid anew. Call ``wake``
    whenever the clock reaches ``wake_ns``, and before a message of the same time is offered.
    """

    __slots__ = ()

    @property
    def wake_ns(self) -> int | None:
        """When ``wake`` may have something to relay, or earlier; ``None`` while nothing waits."""

    def offer(self, sample: Sample, now_ns: int, /) -> Sequence[Pass]:
        """What to relay now that ``sample`` arrived: the sample or nothing."""

    def wake(self, now_ns: int, /) -> Sequence[Pass]:
        """What to relay now without a message."""

    def set_rate(self, rate_hz: float, now_ns: int, /) -> None:
        """Aim at another rate from now on: infinite is Full, 0 is Off; ValueError if negative or NaN."""

    def forget(self) -> None:
        """The topic has another type now: what is held is of the old one and must not go out."""

    def finish(self) -> None:
        """The recording ended: repeat nothing; what is held still goes out at its own time, by ``wake``."""
