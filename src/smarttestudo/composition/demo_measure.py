# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""Measuring a recording of the robot: what its topics carried, and where it drove."""

from __future__ import annotations

import math
from collections.abc import Mapping
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


def measure_run(path: Path, *, odometry_topic: str) -> MeasuredRun:
    """Read the recording at ``path`` once.

    Raises:
        RecordingError: it cannot be read.
    """
    with open_recording(path) as recording:
        span = RecordingSpan(start_ns=recording.start_ns, end_ns=recording.end_ns)
        traces = {channel.topic: TraceAccumulator() for channel in recording.channels}
        places = _read(recording, traces, odometry_topic)
        return MeasuredRun(
            span=span,
            traces=traces,
            statistics={
                topic: topic_statistics(trace, span, declared=topic in recording.declared_bytes)
                for topic, trace in traces.items()
            },
            path=places,
        )


def _read(
    recording: RecordingReader, traces: Mapping[str, TraceAccumulator], odometry_topic: str
) -> tuple[PathPoint, ...]:
    """Count every message into its trace and return the places that the odometry names."""
    decoder = RosbagDecoder()
    places: list[PathPoint] = []
    last_s = -math.inf
    for channel, stamp_ns, payload in recording.messages():
        traces[channel.topic].add(stamp_ns, recording.declared_bytes.get(channel.topic, len(payload)))
        t_s = (stamp_ns - recording.start_ns) / NS_PER_S
        if channel.topic == odometry_topic and t_s >= last_s + _PATH_STEP_S:
            odometry: Any = decoder.decode(channel, payload)
            position = odometry.pose.pose.position
            places.append(PathPoint(t_s=t_s, x_m=position.x, y_m=position.y))
            last_s = t_s
    return tuple(places)
