# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""What passes while a recording is replayed: counts by topic, and where the robot was."""

from __future__ import annotations

from collections.abc import Mapping

from smarttestudo.domain.errors import RecordingError
from smarttestudo.domain.recording import Channel, MessageDecoder, RecordingReader
from smarttestudo.domain.units import NS_PER_S
from smarttestudo.visualizer.page import PathPoint
from smarttestudo.visualizer.trace import TraceAccumulator

ODOMETRY = "nav_msgs/msg/Odometry"
MAX_POINTS = 1000


class ArrivalWatch:
    """Counts the messages of ``recording`` as they are read, and follows its odometry."""

    def __init__(self, recording: RecordingReader, decoder: MessageDecoder) -> None:
        self._decoder = decoder
        self._declared_bytes = recording.declared_bytes
        self._start_ns = self._due_ns = recording.start_ns
        self._step_ns = max((recording.end_ns - recording.start_ns) // MAX_POINTS, 1)
        self.traces = {channel.topic: TraceAccumulator() for channel in recording.channels}
        self.path: list[PathPoint] = []
        odometry = [channel.topic for channel in recording.channels if channel.type_name == ODOMETRY]
        self._odometry = "/odom" if "/odom" in odometry else next(iter(odometry), None)

    def arrived(self, channel: Channel, stamp_ns: int, payload: bytes) -> None:
        """Take one message of the recording."""
        topic = channel.topic
        self.traces[topic].add(stamp_ns, self._declared_bytes.get(topic, len(payload)))
        if topic == self._odometry and stamp_ns >= self._due_ns:
            self._due_ns = stamp_ns + self._step_ns
            self._follow(channel, stamp_ns, payload)

    def _follow(self, channel: Channel, stamp_ns: int, payload: bytes) -> None:
        try:
            position = self._decoder.decode(channel, payload).pose.pose.position  # type: ignore[attr-defined]
        except (RecordingError, AttributeError):
            # The replay itself says what could not be decoded.
            return
        t_s = (stamp_ns - self._start_ns) / NS_PER_S
        self.path.append(PathPoint(t_s=t_s, x_m=float(position.x), y_m=float(position.y)))


class CountingWriter:
    """Counts what a replay relays, and keeps none of it; ``declared_bytes`` are by monitored topic."""

    def __init__(self, declared_bytes: Mapping[str, int]) -> None:
        self._declared_bytes = declared_bytes
        self.traces: dict[str, TraceAccumulator] = {}

    def add(self, channel: Channel) -> None:
        """Expect messages of ``channel``."""
        self.traces.setdefault(channel.topic, TraceAccumulator())

    def write(self, channel: Channel, stamp_ns: int, payload: bytes) -> None:
        """Count one message."""
        size_bytes = self._declared_bytes.get(channel.topic, len(payload))
        self.traces[channel.topic].add(stamp_ns, size_bytes)
