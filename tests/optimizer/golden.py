# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""The thesis's golden case (Riccardi 2025, Fig. A.2 and A.3): sizes, tiers, levels and rates."""

from __future__ import annotations

from smarttestudo.domain.profile import Profile, TopicProfile

AMPLE_KB_PER_S = 275_000.0
SCARCE_KB_PER_S = 15_000.0

TOPICS: dict[str, tuple[float, tuple[float, ...]]] = {
    "/cmd_vel": (0.052, (5, 10, 15, 18, 20, 25)),
    "/odom": (0.72, (10, 15, 20, 25, 30, 35)),
    "/camera/camera_info": (0.38, (10, 15, 20, 25, 30, 35)),
    "/camera/image_raw/compressed": (420.0, (5, 10, 15, 20, 30, 35)),
    "/camera/image_raw": (6220.0, (2, 5, 10, 15, 20, 25)),
    "/imu": (0.32, (50, 75, 100, 150, 200, 250)),
    "/joint_state": (0.12, (2, 4, 6, 8, 10, 15)),
    "/scan": (2.94, (2, 4, 6, 8, 10, 15)),
    "/tf": (0.17, (2, 10, 20, 30, 40, 45)),
}

DEFAULTS_HZ: dict[str, float] = {
    "/cmd_vel": 5,
    "/odom": 10,
    "/camera/camera_info": 10,
    "/camera/image_raw/compressed": 5,
    "/camera/image_raw": 2,
    "/imu": 50,
    "/joint_state": 2,
    "/scan": 2,
    "/tf": 2,
}


def profile(budget_kb_per_s: float = AMPLE_KB_PER_S) -> Profile:
    topics = {
        name: TopicProfile(message_kb=size, tiers_hz=tuple(map(float, tiers)))
        for name, (size, tiers) in TOPICS.items()
    }
    return Profile(budget_kb_per_s=budget_kb_per_s, topics=topics, path="profile.toml")
