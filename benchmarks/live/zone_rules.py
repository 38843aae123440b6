# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""A large rule file."""

from __future__ import annotations

import random

TOPICS = ("/odom", "/scan", "/imu", "/camera/image_raw", "/cmd_vel", "/tf", "/joint_states", "/battery_state")
ZONE_M = 3
FLOOR_M = 300


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
