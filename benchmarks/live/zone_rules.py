# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""A large rule file."""

from __future__ import annotations

import random
from collections.abc import Iterable
from types import SimpleNamespace

from smarttestudo.domain.observation import Arrival
from smarttestudo.domain.profile import Profile, TopicProfile
from smarttestudo.language.parser import parse
from smarttestudo.language.rule_set import compile_rules
from smarttestudo.loop import Knowledge

TOPICS = ("/odom", "/scan", "/imu", "/camera/image_raw", "/cmd_vel", "/tf", "/joint_states", "/battery_state")
ZONE_M = 3
FLOOR_M = 300


def in_zone(x: int, y: int) -> str:
    """The condition that a robot is in that square metre."""
    return (
        f"(CheckValue /odom pose_x > {x} AND CheckValue /odom pose_x < {x + 1} AND "
        f"CheckValue /odom pose_y > {y} AND CheckValue /odom pose_y < {y + 1})"
    )


def knowledge_of(texts: Iterable[str], odometry: TopicProfile) -> Knowledge:
    """What a loop with rules in these files knows when it begins."""
    files = [parse(text, f"zones_{number}.adirf").file for number, text in enumerate(texts)]
    rule_set = compile_rules(files, lambda name: name)
    return Knowledge(rule_set, Profile(settle_s=0.0, topics={"/odom": odometry}), start_ns=0)


def odometry_at(x: float, y: float) -> Arrival:
    """A message of a robot there."""
    position = SimpleNamespace(x=x, y=y, z=0.0)
    message = SimpleNamespace(pose=SimpleNamespace(pose=SimpleNamespace(position=position)))
    return Arrival(topic="/odom", size_bytes=720, message=message)


def rule_file(rules: int) -> str:
    """Defaults, and rules for zones strewn over a large floor."""
    generator = random.Random(1)
    lines = ["begin", *(f"    SetFrequency {topic} {generator.choice([5, 10, 20])}" for topic in TOPICS)]
    for number in range(rules - len(TOPICS)):
        x_m, y_m = generator.uniform(0, FLOOR_M), generator.uniform(0, FLOOR_M)
        lines += [
            "",
            f"    // Zone {number}",
            f'    Rule "Zone {number}"',
            "    If (",
            f"        CheckValue /odom pose_x > {x_m:.1f}",
            f"        AND CheckValue /odom pose_x < {x_m + ZONE_M:.1f}",
            f"        AND CheckValue /odom pose_y > {y_m:.1f}",
            f"        AND CheckValue /odom pose_y < {y_m + ZONE_M:.1f}",
            "    )",
            "    Then",
            *(
                f"        SetFrequency {topic} {generator.choice([1, 2, 4, 8])}"
                for topic in generator.sample(TOPICS, 2)
            ),
            "    EndIf",
        ]
    return "\n".join([*lines, "end", ""])
