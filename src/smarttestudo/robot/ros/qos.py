# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""Quality of service between rclpy's types and ours."""

from __future__ import annotations

from typing import Any

from rclpy.qos import DurabilityPolicy, HistoryPolicy, LivelinessPolicy, QoSProfile, ReliabilityPolicy

from smarttestudo.domain.robot import Qos

LARGEST_NS = 2**63 - 1


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


def further_policies(profile: Any) -> tuple[str, ...]:
    """Policies that a discovered subscriber requests and publishers with ``qos_profile`` do not offer."""
    asked = {
        "a deadline": _is_finite(profile.deadline),
        "manual liveliness": profile.liveliness == LivelinessPolicy.MANUAL_BY_TOPIC,
        "a liveliness lease": _is_finite(profile.liveliness_lease_duration),
    }
    return tuple(policy for policy, is_asked in asked.items() if is_asked)


def _is_finite(duration: Any) -> bool:
    # 0 stands for the default, which is infinite; the middleware shows infinity as its largest number.
    return bool(0 < duration.nanoseconds < LARGEST_NS)
