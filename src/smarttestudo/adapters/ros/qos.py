# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""Quality of service in rclpy's words and in ours."""

from __future__ import annotations

from typing import Any

from rclpy.qos import DurabilityPolicy, HistoryPolicy, QoSProfile, ReliabilityPolicy

from smarttestudo.domain.robot import Qos


def qos_profile(qos: Qos) -> Any:
    """``qos`` as a ``QoSProfile``."""
    reliability = ReliabilityPolicy.RELIABLE if qos.reliable else ReliabilityPolicy.BEST_EFFORT
    durability = DurabilityPolicy.TRANSIENT_LOCAL if qos.transient_local else DurabilityPolicy.VOLATILE
    return QoSProfile(
        history=HistoryPolicy.KEEP_LAST, depth=qos.depth, reliability=reliability, durability=durability
    )


def is_reliable(profile: Any) -> bool:
    """Whether a discovered publisher offers reliable delivery."""
    return bool(profile.reliability == ReliabilityPolicy.RELIABLE)


def is_transient_local(profile: Any) -> bool:
    """Whether a discovered publisher keeps its last messages for late subscribers."""
    return bool(profile.durability == DurabilityPolicy.TRANSIENT_LOCAL)
