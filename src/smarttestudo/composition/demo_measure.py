# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""Measuring a recording of the robot: what its topics carried, and where it drove."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from smarttestudo.adapters.rosbag import RosbagDecoder, open_recording
from smarttestudo.domain.recording import RecordingReader
from smarttestudo.domain.units import NS_PER_S
from smarttestudo.visualizer.page import PathPoint
from smarttestudo.visualizer.statistics import RecordingSpan, TopicStatistics, topic_statistics
from smarttestudo.visualizer.trace import TraceAccumulator

_PATH_STEP_S = 0.2


@dataclass(frozen=True, slots=True, kw_only=True)
class MeasuredRun:
    """A recording's topics by name, and the robot's places at least 0.2 s apart."""

    span: RecordingSpan
    traces: Mapping[str, TraceAccumulator]
    statistics: Mapping[str, TopicStatistics]
    path: tuple[PathPoint, ...]


def measure_run(path: Path, *, odometry_topic: str, report: Callable[[float], None]) -> MeasuredRun:
    """Read the recording at ``path`` once; ``report`` is told the share done at each place of the robot.

    Raises:
        RecordingError: it cannot be read.
    """
    with open_recording(path) as recording:
        span = RecordingSpan(start_ns=recording.start_ns, end_ns=recording.end_ns)
        traces = {channel.topic: TraceAccumulator() for channel in recording.channels}
        places = []
        for place in _read(recording, traces, odometry_topic):
            places.append(place)
            report(place.t_s / span.duration_s)
        return MeasuredRun(
            span=span,
            traces=traces,
            statistics={
                topic: topic_statistics(trace, span, declared=topic in recording.declared_bytes)
                for topic, trace in traces.items()
            },
            path=tuple(places),
        )


def _read(
    recording: RecordingReader, traces: Mapping[str, TraceAccumulator], odometry_topic: str
) -> Iterator[PathPoint]:
    """Count every message into its trace, and give the places that the odometry names."""
    decoder = RosbagDecoder()
    next_s = 0.0
    for channel, stamp_ns, payload in recording.messages():
        traces[channel.topic].add(stamp_ns, recording.declared_bytes.get(channel.topic, len(payload)))
        t_s = (stamp_ns - recording.start_ns) / NS_PER_S
        if channel.topic == odometry_topic and t_s >= next_s:
            next_s = t_s + _PATH_STEP_S
            odometry: Any = decoder.decode(channel, payload)
            position = odometry.pose.pose.position
            yield PathPoint(t_s=t_s, x_m=position.x, y_m=position.y)
