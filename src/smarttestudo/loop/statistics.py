# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""Statistics of a relay. Where the clock jumps back, time stands still; a jump ahead may be left out."""

from __future__ import annotations

import math
from collections import Counter
from collections.abc import Callable, Collection

from smarttestudo.domain.rate_meter import Flow
from smarttestudo.pacing.bound import BoundRecords
from smarttestudo.pacing.coded_video import VideoFrame
from smarttestudo.pacing.streams import messages_per_hz

MAX_FRAMES = 4096


class TargetRate:
    """The target rate of a relay over time, in Hz; infinite while Full, as it is at first.

    ``changes`` counts how often it became another one.
    """

    __slots__ = ("_ns_at", "_since_ns", "changes", "rate_hz")

    def __init__(self, now_ns: int) -> None:
        self.rate_hz = math.inf
        self.changes = 0
        self._since_ns = now_ns
        self._ns_at: Counter[float] = Counter()

    def change(self, rate_hz: float, now_ns: int) -> None:
        self.account(now_ns)
        self.changes += rate_hz != self.rate_hz
        self.rate_hz = rate_hz

    def account(self, now_ns: int) -> None:
        """Count the time up to ``now_ns``."""
        self._ns_at[self.rate_hz] += max(now_ns - self._since_ns, 0)
        self._since_ns = now_ns

    def leave_out(self, ahead_ns: int) -> None:
        """The clock jumped ahead by so much."""
        self._since_ns += ahead_ns

    def mean_hz(self, source_hz: float) -> float | None:
        """The mean over the counted time, where Full counts as ``source_hz``; ``None`` over no time."""
        return self._mean_hz(lambda rate_hz: source_hz if math.isinf(rate_hz) else rate_hz)

    def attainable_hz(self, source_hz: float) -> float | None:
        """The mean over the counted time of the lesser of target and source; ``None`` over no time."""
        return self._mean_hz(lambda rate_hz: min(rate_hz, source_hz))

    def _mean_hz(self, counts_as: Callable[[float], float]) -> float | None:
        total_ns = self._ns_at.total()
        messages = sum(counts_as(rate_hz) * passed_ns for rate_hz, passed_ns in self._ns_at.items())
        return messages / total_ns if total_ns else None


class FrameFlows:
    """Flows of each stream that messages name, such as a child frame, in and out, of the first 4096."""

    __slots__ = ("_messages", "_named", "arrived", "relayed")

    def __init__(self) -> None:
        self._messages = self._named = 0
        self.arrived: dict[str, Flow] = {}
        self.relayed: dict[str, Flow] = {}

    def __len__(self) -> int:
        """How many streams arrived."""
        return len(self.arrived)

    @property
    def streams(self) -> float:
        """How many messages pass at 1 Hz."""
        return messages_per_hz(len(self.arrived), messages=self._messages, named=self._named)

    def record(self, flows: dict[str, Flow], frames: Collection[str], now_ns: int) -> None:
        """Count, in ``arrived`` or ``relayed``, a message that holds ``frames``."""
        if flows is self.arrived and frames:
            self._messages += 1
            self._named += len(frames)
        for frame in frames:
            flow = flows.get(frame)
            if flow is None:
                if len(flows) == MAX_FRAMES:
                    continue
                flow = flows[frame] = Flow()
            flow.record(now_ns, 0)

    def leave_out(self, ahead_ns: int, now_ns: int) -> None:
        """The clock jumped ahead by so much, to ``now_ns``."""
        for flow in (*self.arrived.values(), *self.relayed.values()):
            flow.leave_out(ahead_ns, now_ns)


class VideoCounts:
    """Key frames among the messages of coded video, and since when none has come, or the first."""

    __slots__ = ("keys", "messages", "since_ns")

    def __init__(self, now_ns: int) -> None:
        self.keys = 0
        self.messages = 0
        self.since_ns = now_ns

    def record(self, frame: VideoFrame | None, now_ns: int) -> None:
        self.messages += 1
        if frame is None or frame is VideoFrame.KEY:
            self.keys += 1
            self.since_ns = now_ns

    def leave_out(self, ahead_ns: int) -> None:
        """The clock jumped ahead by so much."""
        self.since_ns += ahead_ns


class RelayStatistics:
    """The flows into and out of one relay, how many of the latter were repeated, and the target.

    ``frames`` are those of each stream that messages name, which the target is about then. ``bounds``
    say how each bound of the receiver's estimate was kept, ``unreadable`` how many messages of a topic with
    bounds lack a value of one, which is not judged by them. ``video`` is there of coded video.
    """

    __slots__ = ("arrived", "bounds", "frames", "relayed", "repeated", "target", "unreadable", "video")

    def __init__(self, now_ns: int) -> None:
        self.frames = FrameFlows()
        self.arrived = Flow()
        self.relayed = Flow()
        self.repeated = 0
        self.bounds: BoundRecords = {}
        self.unreadable = 0
        self.video: VideoCounts | None = None
        self.target = TargetRate(now_ns)

    def leave_out(self, ahead_ns: int, now_ns: int) -> None:
        """The clock jumped ahead by so much, to ``now_ns``."""
        for flow in (self.arrived, self.relayed, self.frames):
            flow.leave_out(ahead_ns, now_ns)
        self.target.leave_out(ahead_ns)
        if self.video is not None:
            self.video.leave_out(ahead_ns)
