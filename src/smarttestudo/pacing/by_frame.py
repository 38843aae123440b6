# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""/tf: streams by child frame, which share messages."""

from __future__ import annotations

from collections.abc import Sequence

from smarttestudo.pacing.pace import Pace
from smarttestudo.pacing.sample import Pass, Sample
from smarttestudo.pacing.streams import Streams
from smarttestudo.pacing.volatile import VolatileStream

NO_FRAMES = ("",)
"""What stands for the frames of a message that has none or could not be read."""


class FrameStreams(Streams[VolatileStream]):
    """One stream for each child frame; a message passes whole if any frame in it is due.

    It counts for all its frames, yet no frame is ever due later than one period after it, so that a
    frame which travelled along with others does not starve once they are gone. The last word is each frame's
    own; a message that is the last word of several frames passes once.
    """

    __slots__ = ()

    def __init__(self, pace: Pace) -> None:
        super().__init__(VolatileStream, pace)

    def offer(self, sample: Sample, now_ns: int) -> Sequence[Pass]:
        """What passes now that ``sample`` arrived: the sample or nothing."""
        streams = self._streams_of(sample, now_ns)
        is_due = False
        for stream in streams:
            stream.source.record(now_ns)
            if now_ns >= stream.grid.due_ns:
                is_due = True
        if is_due:
            for stream in streams:
                stream.settle(now_ns)
            return (Pass(sample),)
        for stream in streams:
            stream.hold(sample, now_ns)
        # What is held waits for a period or longer; wake finds out, and need not be early for each frame.
        self.wake_ns = min(self.wake_ns, now_ns + self._pace.period_ns)
        return ()

    def holds(self, sample: Sample) -> bool:
        """Whether ``sample`` did not pass, but still may."""
        return any(stream.held is sample for stream in self._streams.values())

    def _release(self, stream: VolatileStream, now_ns: int) -> Sequence[Pass]:
        sample = stream.held
        if sample is None:
            return ()
        for other in {stream, *self._streams_of(sample, now_ns)}:
            other.grid.charge(now_ns)
            if other.held is sample:
                other.held = None
        return (Pass(sample),)

    def _streams_of(self, sample: Sample, now_ns: int) -> list[VolatileStream]:
        known = self._streams
        frames = sample.frames or NO_FRAMES
        return [known.get(frame) or self._open_stream(frame, now_ns) for frame in frames]
