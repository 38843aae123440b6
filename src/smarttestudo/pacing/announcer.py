# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""Tells followers what their leader decided."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from functools import partial
from typing import Protocol

from smarttestudo.pacing.follower import Follower
from smarttestudo.pacing.pace import Pace
from smarttestudo.pacing.sample import Pass, Sample


class Holder(Protocol):
    """Who knows what is held back."""

    def holds(self, sample: Sample) -> bool:
        """Whether ``sample`` did not pass, but still may."""


class Announcer:
    """A leader's decisions on its stamps: passed, held, or decided against.

    Samples without a stamp are not announced. ``followers`` are told in the order in which they were added.
    """

    __slots__ = ("_held", "followers")

    def __init__(self) -> None:
        self.followers: list[Follower] = []
        self._held: list[Sample] = []

    def add(self, follower: Follower, pace: Pace) -> None:
        """Tell ``follower`` from now on."""
        self.followers.append(follower)
        follower.leader_is_full = pace.is_full

    def offered(self, sample: Sample, passes: Sequence[Pass], holder: Holder, now_ns: int) -> None:
        """The leader was offered ``sample`` and relays ``passes``."""
        self.woken(passes, holder, now_ns)
        if passes:
            return
        if holder.holds(sample):
            self._held.append(sample)
            self._tell(Follower.held, sample)
        else:
            self._tell(Follower.decided_against, sample)

    def woken(self, passes: Sequence[Pass], holder: Holder, now_ns: int) -> None:
        """The leader relays ``passes``, and may have let go of others."""
        relayed = [sample for sample, _ in passes]
        undecided = [sample for sample in self._held if sample not in relayed]
        self._held = [sample for sample in undecided if holder.holds(sample)]
        for sample in undecided:
            if sample not in self._held:
                self._tell(Follower.decided_against, sample)
        for sample, repeated in passes:
            self._tell(partial(Follower.passed, now_ns=now_ns, repeated=repeated), sample)

    def pace_changed(self, pace: Pace, holder: Holder, now_ns: int) -> None:
        """The leader's pace changed, and it may have let go of what it held."""
        for follower in self.followers:
            follower.leader_is_full = pace.is_full
        self.woken((), holder, now_ns)

    def _tell(self, decision: Callable[[Follower, bytes], None], sample: Sample) -> None:
        if sample.stamp is not None:
            for follower in self.followers:
                decision(follower, sample.stamp)
