# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""The topics and properties to suggest while rules are written."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from enum import Enum
from pathlib import Path
from types import MappingProxyType

from smarttestudo.adirf.parser import ParseResult
from smarttestudo.adirf.syntax import Block, checks_in
from smarttestudo.domain.profile import Profile


class TopicSource(Enum):
    """Who names a topic; the value is its name in JSON, the order that of trust."""

    PROFILE = "profile"
    ROBOT = "robot"
    BAG = "bag"
    RULES = "rules"
    EXAMPLE = "example"


@dataclass(frozen=True, slots=True, kw_only=True)
class KnownTopic:
    """A topic, its type where anybody knows it, and who names it."""

    topic: str
    type_name: str | None
    source: TopicSource


EXAMPLE_TYPES: Mapping[str, str] = MappingProxyType(
    {
        "/odom": "nav_msgs/msg/Odometry",
        "/cmd_vel": "geometry_msgs/msg/Twist",
        "/scan": "sensor_msgs/msg/LaserScan",
        "/battery_state": "sensor_msgs/msg/BatteryState",
        "/imu": "sensor_msgs/msg/Imu",
        "/joint_states": "sensor_msgs/msg/JointState",
        "/tf": "tf2_msgs/msg/TFMessage",
        "/camera/camera_info": "sensor_msgs/msg/CameraInfo",
        "/camera/image_raw": "sensor_msgs/msg/Image",
        "/camera/image_raw/compressed": "sensor_msgs/msg/CompressedImage",
    }
)
"""The topics of a TurtleBot3."""


def known_topics(
    *,
    profile: Profile | None,
    bag_topics: Mapping[str, str],
    rules: ParseResult | None,
    robot_topics: Mapping[str, str] = MappingProxyType({}),
) -> tuple[KnownTopic, ...]:
    """Every topic once, by the most trusted who names it; types from whoever knows them."""
    by_source: dict[TopicSource, dict[str, str | None]] = {
        TopicSource.PROFILE: {}
        if profile is None
        else {name: entry.type_name for name, entry in profile.topics.items()},
        TopicSource.ROBOT: dict(robot_topics),
        TopicSource.BAG: dict(bag_topics),
        TopicSource.RULES: dict.fromkeys(sorted(_topics_in(rules)) if rules else ()),
        TopicSource.EXAMPLE: dict(EXAMPLE_TYPES),
    }
    sources: dict[str, TopicSource] = {}
    types: dict[str, str] = {}
    for source, topics in by_source.items():
        for topic, type_name in topics.items():
            sources.setdefault(topic, source)
            if type_name is not None:
                types.setdefault(topic, type_name)
    return tuple(
        KnownTopic(topic=topic, type_name=types.get(topic), source=source)
        for topic, source in sources.items()
    )


def topics_of_bag(path: Path) -> dict[str, str]:
    """The type of each topic of the bag at ``path``; ``RecordingError`` where it cannot be read."""
    from smarttestudo.adapters.rosbag import open_recording  # noqa: PLC0415  most projects have no bag

    with open_recording(path) as recording:
        return {channel.topic: channel.type_name for channel in recording.channels}


def _topics_in(rules: ParseResult) -> set[str]:
    """What the rules name."""
    names: set[str] = set()
    for statement in rules.file.statements:
        if isinstance(statement, Block):
            names.update(one.topic.text for one in (*statement.then, *statement.otherwise))
            names.update(check.topic.text for check in checks_in(statement.condition))
        else:
            names.add(statement.topic.text)
    return names
