# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""The messages of robots with physics, as other nodes read them."""

from __future__ import annotations

from typing import Any

import pytest
from rosbags.typesys import Stores, get_typestore

from simulation.missions import stamp_ns
from simulation.physics.physical_drives import START_NS, robot_of, until
from smarttestudo.simulation.geometry import BodyVelocity
from smarttestudo.simulation.messages import RobotMessages, Topic, command
from smarttestudo.simulation.physics.drive import RobotKind

pytestmark = pytest.mark.full


@pytest.mark.parametrize("kind", RobotKind)
@pytest.mark.parametrize("release", [Stores.ROS2_HUMBLE, Stores.ROS2_JAZZY])
def test_every_message_decodes_with_its_stamp_and_what_was_measured(kind: RobotKind, release: Stores) -> None:
    types = get_typestore(release)
    last: dict[Topic, Any] = {}
    with robot_of(kind, has_camera=False, battery_percent=50) as robot:
        messages = RobotMessages(robot.topics, has_range_variance=release is not Stores.ROS2_HUMBLE)
        for timed in until(robot, robot.start(START_NS), 1.2):
            payload = messages.payload(timed.topic, timed.message)
            message: Any = types.deserialize_cdr(payload, messages.channels[timed.topic].type_name)
            last[timed.topic] = message
            if timed.topic is not Topic.CMD_VEL:
                assert stamp_ns(message) == stamp_ns(timed.message)
    assert set(last) == set(robot.topics)
    assert last[Topic.BATTERY_STATE].percentage == pytest.approx(0.5, abs=0.001)
    assert last[Topic.AMCL_POSE].pose.pose.position.x == pytest.approx(10.8, abs=0.2)
    if kind is RobotKind.QUADROTOR:
        assert last[Topic.RANGE].range > 0.03
        assert last[Topic.ODOM].pose.pose.position.z > 0.05


def test_a_twist_of_others_is_read_and_damaged_ones_are_refused() -> None:
    messages = RobotMessages()
    asked = BodyVelocity(0.2, -0.3, lateral_m_per_s=0.1, climb_m_per_s=0.4)
    payload = messages.payload(Topic.CMD_VEL, command(asked))
    assert messages.velocity(payload) == asked
    for damaged in (b"", payload[:20], payload[:4] + b"\xff" * 48):
        with pytest.raises(ValueError, match=r"it is no Twist|not all finite"):
            messages.velocity(damaged)
