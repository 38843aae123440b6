# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""A profile from a recording."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping, Sequence

from smarttestudo.bags.definitions import TypeLibrary
from smarttestudo.bags.topic_selection import select_topics
from smarttestudo.domain.names import is_topic_name
from smarttestudo.domain.profile import Profile
from smarttestudo.domain.recording import TWO_TYPES, RecordingReader, first_of_topics, robots_own
from smarttestudo.domain.units import NS_PER_S
from smarttestudo.optimizer.profiling import TierProposal, TopicMeasure, profile_text

# More than a message with a pose, a robot's frames or its joints takes; images need not be read.
_HEAD_BYTES = 1 << 16
_MESSAGES_PER_REPORT = 1000


def profile_of_recording(
    recording: RecordingReader,
    *,
    name: str,
    patterns: Sequence[str] = (),
    proposals: Mapping[str, TierProposal] | None = None,
    levels: Profile | None = None,
    report: Callable[[float], None] | None = None,
) -> str:
    """The text of a profile of the topics of ``recording``, which is called ``name``.

    ``patterns`` choose topics (default: all); one that names none is a ``RecordingError``. Where the
    recording declares sizes, they count as the messages' sizes. ``proposals`` are tiers by topic,
    the accuracies in ``levels`` are measured in place of proposed ones.
    """
    declared_bytes, types = recording.declared_bytes, TypeLibrary()
    sources = first_of_topics(robots_own(recording.channels))
    chosen = select_topics(patterns, sources.keys(), place=name) if patterns else sources.keys()
    measures = {
        channel.topic: TopicMeasure(
            channel.type_name,
            is_standard=types.is_standard(channel),
            is_declared=channel.topic in declared_bytes,
            # rosbag2 stores what each publisher offered that was there when recording began.
            publishers=len(channel.qos),
            known=levels.topic(channel.topic).accuracies if levels else {},
        )
        for channel in sources.values()
        if channel.topic in chosen and is_topic_name(channel.topic)
    }
    head_bytes = _HEAD_BYTES if any(one.needs_payload for one in measures.values()) else 0
    length_ns = max(recording.end_ns - recording.start_ns, 1)
    for number, (channel, stamp_ns, (size_bytes, head)) in enumerate(recording.heads(head_bytes)):
        if report is not None and number % _MESSAGES_PER_REPORT == 0:
            report((stamp_ns - recording.start_ns) / length_ns)
        measure = measures.get(channel.topic)
        if measure is not None and sources[channel.topic].type_name == channel.type_name:
            measure.record(stamp_ns, declared_bytes.get(channel.topic, size_bytes), head)
    duration_s = (recording.end_ns - recording.start_ns) / NS_PER_S
    by_name = dict(sorted(measures.items()))
    return profile_text(by_name, duration_s=duration_s, measured_in=name, proposals=proposals)


def profile_notices(recording: RecordingReader) -> Iterator[str]:
    """Notices of what a profile of ``recording`` leaves out, a line each."""
    channels = robots_own(recording.channels)
    sources = first_of_topics(channels)
    for channel in channels:
        if not is_topic_name(channel.topic):
            yield f"{channel.topic}: no name of a ROS topic; left out"
        elif channel.type_name != sources[channel.topic].type_name:
            yield f"{channel.topic}: {TWO_TYPES}: all messages"
