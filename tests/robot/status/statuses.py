# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""Statuses to show: one of each kind of topic."""

from __future__ import annotations

import math
from dataclasses import replace

from smarttestudo.domain.decision import Reason
from smarttestudo.domain.signal import Truth
from smarttestudo.domain.status import (
    BlockStatus,
    CheckStatus,
    RulesInForce,
    RulesOrigin,
    RuntimeStatus,
    Silence,
    TimeStatus,
    TopicCounts,
    TopicStatus,
)

RELAYED = TopicStatus(
    output="/testudo/imu",
    type_name="sensor_msgs/msg/Imu",
    reason=Reason.DEFAULT,
    rule=None,
    line=None,
    target_hz=50.0,
    source_hz=195.004,
    expected_hz=50.0,
    actual_hz=49.99,
    error_percent=-0.02,
    keeps_rate=True,
    stamped_hz=50.001,
    delay_ms=3.25,
    in_kb_per_s=62.4,
    out_kb_per_s=16.0,
    publishers=1,
    subscribers=1,
    incompatible=(),
    problem=None,
    silence=None,
    counts=TopicCounts(received=1950, relayed=500),
)
ONE_OF_EACH = {
    "/camera/image_raw/compressed": replace(
        RELAYED,
        output="/testudo/camera/image_raw/compressed",
        rule="Corridor between the racks",
        line=14,
        reason=Reason.BLOCK,
        target_hz=3.0,
        source_hz=29.0,
        expected_hz=3.0,
        actual_hz=2.1,
        error_percent=-30.0,
        keeps_rate=False,
        in_kb_per_s=12180.0,
        out_kb_per_s=882.0,
    ),
    "/cmd_vel": replace(
        RELAYED,
        output="/testudo/cmd_vel",
        target_hz=0.0,
        actual_hz=0.0,
        error_percent=None,
        out_kb_per_s=0.0,
        silence=Silence.OFF,
    ),
    "/estop": replace(
        RELAYED,
        output="/testudo/estop",
        type_name=None,
        target_hz=math.inf,
        source_hz=None,
        expected_hz=None,
        actual_hz=None,
        error_percent=None,
        in_kb_per_s=0.0,
        out_kb_per_s=0.0,
        publishers=0,
        silence=Silence.NO_PUBLISHER,
    ),
    "/imu": RELAYED,
    "/lidar": replace(
        RELAYED,
        output="/testudo/lidar",
        silence=Silence.CANNOT_RELAY,
        problem="the message type lidar_msgs/msg/Packet is not installed",
    ),
    "/map": replace(
        RELAYED, output="/testudo/map", incompatible=("/rviz",), reason=Reason.BUDGET, rule="Far"
    ),
    "/odom": replace(RELAYED, output="/testudo/odom", subscribers=0, silence=Silence.NO_SUBSCRIBER),
    "/scan": replace(
        RELAYED,
        output="/testudo/scan",
        source_hz=0.0,
        actual_hz=0.0,
        error_percent=None,
        in_kb_per_s=0.0,
        out_kb_per_s=0.0,
        silence=Silence.SOURCE_SILENT,
    ),
}
STATUS = RuntimeStatus(
    node="/smarttestudo",
    stamp_ns=1_767_600_030_455_629_098,
    uptime_s=4521.5,
    rules=RulesInForce(
        paths=("/etc/testudo/warehouse.adirf",), sha256="ab" * 32, origin=RulesOrigin.WAITING, waits_s=7.5
    ),
    budget_kb_per_s=1000.0,
    floors_break_budget=False,
    cpu_percent=4.2,
    memory_mb=71.3,
    topics=ONE_OF_EACH,
    status_hz=5.0,
    blocks=(
        BlockStatus(
            file=0,
            line=14,
            column=5,
            state=Truth.UNKNOWN,
            checks=(
                CheckStatus(line=15, column=9, state=Truth.TRUE, value=5.25),
                CheckStatus(line=15, column=40, state=Truth.UNKNOWN, value=None),
            ),
        ),
        BlockStatus(
            file=1,
            line=3,
            column=1,
            state=Truth.FALSE,
            checks=(),
            times=(
                TimeStatus(line=15, column=60, state=Truth.FALSE, held_s=1.5),
                TimeStatus(line=15, column=80, state=Truth.UNKNOWN, held_s=None),
            ),
        ),
    ),
)
WELL = replace(STATUS, rules=replace(STATUS.rules, waits_s=None), topics={"/imu": RELAYED}, blocks=())
"""A run of which there is nothing to say."""
