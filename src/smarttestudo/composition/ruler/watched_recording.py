# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""What passes while a recording is replayed: counts by topic, and where the robot was."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence

from smarttestudo.domain.errors import RecordingError
from smarttestudo.domain.recording import (
    Channel,
    MessageDecoder,
    RecordedMessage,
    RecordedSize,
    RecordingReader,
    Storage,
)
from smarttestudo.domain.units import NS_PER_S
from smarttestudo.visualizer.page import PathPoint
from smarttestudo.visualizer.trace import TraceAccumulator

ODOMETRY = "nav_msgs/msg/Odometry"
MAX_POINTS = 1000


class WatchedRecording:
    """``recording``, counting the messages that are read from it, and following its odometry."""

    def __init__(self, recording: RecordingReader, decoder: MessageDecoder) -> None:
        self._recording = recording
        self._decoder = decoder
        self.traces = {channel.topic: TraceAccumulator() for channel in recording.channels}
        self.path: list[PathPoint] = []
        odometry = [channel.topic for channel in recording.channels if channel.type_name == ODOMETRY]
        self._odometry = "/odom" if "/odom" in odometry else next(iter(odometry), None)

    @property
    def storage(self) -> Storage:
        """The format of its files."""
        return self._recording.storage

    @property
    def channels(self) -> Sequence[Channel]:
        """Every topic with its type, one entry each."""
        return self._recording.channels

    @property
    def custom_data(self) -> Mapping[str, str]:
        """What the recording's author noted beside the messages."""
        return self._recording.custom_data

    @property
    def declared_bytes(self) -> Mapping[str, int]:
        """Bytes that each message of a topic stands for, where the recording declares them."""
        return self._recording.declared_bytes

    @property
    def start_ns(self) -> int:
        """Stamp of the first message."""
        return self._recording.start_ns

    @property
    def end_ns(self) -> int:
        """Stamp of the last message."""
        return self._recording.end_ns

    @property
    def message_count(self) -> int | None:
        """Messages in the recording."""
        return self._recording.message_count

    def messages(self) -> Iterator[RecordedMessage]:
        """All messages in time order."""
        declared_bytes = self.declared_bytes
        step_ns = max((self.end_ns - self.start_ns) // MAX_POINTS, 1)
        due_ns = self.start_ns
        for message in self._recording.messages():
            channel, stamp_ns, payload = message
            topic = channel.topic
            self.traces[topic].add(stamp_ns, declared_bytes.get(topic, len(payload)))
            if topic == self._odometry and stamp_ns >= due_ns:
                due_ns = stamp_ns + step_ns
                self._follow(channel, stamp_ns, payload)
            yield message

    def sizes(self) -> Iterator[RecordedSize]:
        """What ``messages`` gives with sizes; these are not counted."""
        return self._recording.sizes()

    def notices(self) -> Sequence[str]:
        """What was lost or odd, one line each."""
        return self._recording.notices()

    def _follow(self, channel: Channel, stamp_ns: int, payload: bytes) -> None:
        try:
            position = self._decoder.decode(channel, payload).pose.pose.position  # type: ignore[attr-defined]
        except (RecordingError, AttributeError):
            # The replay itself says what could not be decoded.
            return
        t_s = (stamp_ns - self.start_ns) / NS_PER_S
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
