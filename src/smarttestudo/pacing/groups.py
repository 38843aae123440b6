# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""Groups of coded video: a key frame, and the frames after it, each a difference to the one before."""

from __future__ import annotations

from smarttestudo.domain.units import NS_PER_S
from smarttestudo.pacing.coded_video import VideoFrame
from smarttestudo.pacing.grid import Pace
from smarttestudo.pacing.sample import Sample
from smarttestudo.pacing.stream import VolatileStream

AHEAD_AT_MOST_NS = 2 * NS_PER_S
"""A group takes what its rate gives in so long, or in as long as the groups before it lasted, at once."""
LATER_AHEAD_NS = NS_PER_S * 5 // 4
"""Later in a long group, frames pass that are due in so long: near the source's rate, only the last wait."""
FIRST_AHEAD_NS = NS_PER_S * 3 // 8
"""The same for the first group, of which nothing is known yet: its frames may come in lumps."""
_FORGOTTEN_AFTER_NS = 60 * NS_PER_S


class VideoGroup:
    """Whether the next frame of a stream can be decoded by who has the frames that were not left out.

    Unless it ``is_known``, no key frame came yet, and none is worth less than another. While it
    ``awaits_key``, there were parameters last, and what else stands before a key frame.
    """

    __slots__ = ("_was_broken", "awaits_key", "is_broken", "is_known")

    def __init__(self) -> None:
        self.is_known = False
        self.is_broken = False
        self.awaits_key = False
        self._was_broken = False

    def take(self, frame: VideoFrame | None) -> bool:
        """Have ``frame``, or an image by itself, as the next one; whether a group begins with it."""
        awaited_key = self.awaits_key
        begins = begins_group(frame) and not awaited_key
        self.awaits_key = frame is VideoFrame.PARAMETERS or (awaited_key and frame is VideoFrame.UNKNOWN)
        if begins:
            self._was_broken, self.is_known, self.is_broken = self.is_broken, True, False
        elif awaited_key and frame is VideoFrame.DIFFERENCE:
            # Some coders repeat their parameters where no group begins.
            self.is_broken |= self._was_broken
        return begins


def begins_group(frame: VideoFrame | None) -> bool:
    """Whether a group begins with ``frame``, or with the parameters before it."""
    return frame is None or frame is VideoFrame.KEY or frame is VideoFrame.PARAMETERS


class GroupStream(VolatileStream):
    """Passes whole beginnings of groups: a key frame, and what follows it until one is not due.

    A group has what the rate gives for as long as the groups before it lasted, however soon its frames come,
    but of one that is long not much ahead of its time.
    Parameters before a key frame count with it. Before the first key frame all passes. Of what did not pass
    only a key frame is held.
    """

    __slots__ = ("_began_ns", "_came_ns", "_lasted_ns", "group")

    def __init__(self, pace: Pace, now_ns: int) -> None:
        super().__init__(pace, now_ns)
        self.group = VideoGroup()
        self._began_ns = self._came_ns = now_ns
        self._lasted_ns = (0, 0)
        """How long the last two groups lasted."""

    def offer(self, sample: Sample, now_ns: int) -> bool:
        """Whether ``sample`` passes now; if not, it is held if it is a key frame."""
        self.source.record(now_ns)
        self._came_ns = now_ns
        group, grid, is_first = self.group, self.grid, not self.group.is_known
        begins = group.take(sample.frame)
        if begins:
            self._lasted_ns = (self._lasted_ns[1], 0 if is_first else now_ns - self._began_ns)
            self._began_ns = now_ns
        is_due = now_ns >= grid.due_ns or (sample.frame is not None and grid.due_ns < self._until_ns(now_ns))
        if not group.is_broken and (is_due or (not group.is_known and not grid.pace.is_off)):
            self._pass(now_ns)
            return True
        group.is_broken = True
        if begins and sample.frame is not VideoFrame.PARAMETERS:
            self.hold(sample, now_ns)
        else:
            # A key frame that is held is final only once nothing came after it for a while.
            self.held_ns = now_ns
        return False

    def change_pace(self, pace: Pace, now_ns: int) -> None:
        """Follow another pace from now on; what comes while Off is left out."""
        if pace.is_off:
            self.end_groups()
        super().change_pace(pace, now_ns)

    def end_groups(self) -> None:
        """Some frames do not come to this stream from now on."""
        self.group.is_broken = True

    def restart(self, now_ns: int) -> None:
        """Begin anew on a clock that jumped back to ``now_ns``."""
        super().restart(now_ns)
        self._began_ns = self._came_ns = now_ns

    def is_idle(self, now_ns: int) -> bool:
        """Whether a fresh stream would do as well, which takes any frame for one that can be decoded."""
        is_forgotten = not self.group.is_broken or now_ns - self._came_ns > _FORGOTTEN_AFTER_NS
        return is_forgotten and super().is_idle(now_ns)

    def _until_ns(self, now_ns: int) -> int:
        """Frames that are due before that pass now: what the rate gives while the group lasts.

        Where frames come in lumps, two of them may be missing in how long it is known to last.
        """
        began_ns, lasted_ns = self._began_ns, max(self._lasted_ns)
        if lasted_ns == 0:
            return now_ns + FIRST_AHEAD_NS
        at_most_ns = max(began_ns + AHEAD_AT_MOST_NS, now_ns + LATER_AHEAD_NS)
        return min(began_ns + lasted_ns + 2 * self.source.longest_ns, at_most_ns)

    def _pass(self, now_ns: int) -> None:
        if self.group.awaits_key:
            self.held = None
        elif self.grid.due_ns > now_ns and self.group.is_known:
            self.grid.due_ns += self.grid.pace.period_ns
            self.held = None
        else:
            self.settle(now_ns)
