# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""Topics whose streams are their publishers."""

from __future__ import annotations

from collections.abc import Sequence

from smarttestudo.pacing.sample import Pass, Sample
from smarttestudo.pacing.streams import AnyStream, Streams


class PublisherStreams(Streams[AnyStream]):
    """One stream for each publisher, so that none starves another."""

    __slots__ = ()

    def offer(self, sample: Sample, now_ns: int) -> Sequence[Pass]:
        """What passes now that ``sample`` arrived: the sample or nothing."""
        stream = self._streams.get(sample.publisher) or self._open_stream(sample.publisher, now_ns)
        passes = stream.offer(sample, now_ns)
        release_ns = stream.release_ns
        self.wake_ns = release_ns if len(self._streams) == 1 else min(self.wake_ns, release_ns)
        return (Pass(sample),) if passes else ()

    def holds(self, sample: Sample) -> bool:
        """Whether ``sample`` did not pass, but still may."""
        return any(stream.held is sample for stream in self._streams.values())
