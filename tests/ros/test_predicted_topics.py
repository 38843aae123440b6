# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""``testudo receive --predict`` on a real graph: what comes between the messages of a robot that drives."""

from __future__ import annotations

import math
import signal
import struct
from typing import NamedTuple

import pytest

from ros.ros_processes import SmallRobot
from smarttestudo.bags.reader import open_recording
from smarttestudo.pacing.cdr import PoseReader, header_stamp_ns

TWIST = (0.4, 0.2)
BOUND_M = 0.05
SOURCE = {"type": "nav_msgs/msg/Odometry", "hz": 25, "twist": TWIST}
HEARD = {"type": "nav_msgs/msg/Odometry", "topic": "/odom", "raw": True, "reliable": True}
RULES = f"begin SetFrequency /odom Full KeepWithin /odom position {BOUND_M} end"
VARIANCES_AT = 56
ENOUGH = 50


class Told(NamedTuple):
    """A message: when the robot is where, and the variance of its x."""

    stamp_s: float
    x: float
    y: float
    variance: float


def told(payload: bytes) -> Told:
    read, stamp_ns = PoseReader(2, has_twist=True).read(payload), header_stamp_ns(payload)
    assert read is not None
    assert stamp_ns is not None
    pose_at = payload.index(struct.pack("<7d", *read[1][:7]))
    (variance,) = struct.unpack_from("<d", payload, pose_at + VARIANCES_AT)
    return Told(stamp_ns / 1e9, read[1][0], read[1][1], variance)


def driven_s(one: Told) -> float:
    """For how long the robot has driven its arc when it is there."""
    forward, around = TWIST
    return math.atan2(one.x, forward / around - one.y) / around


@pytest.mark.contract
def test_between_messages_the_robot_goes_on_along_its_arc_and_a_recording_has_what_arrived(
    robot: SmallRobot, operators: SmallRobot, endpoint: str
) -> None:
    folder = operators.folder / "recorded"
    receiving = operators.receiver(endpoint, "--predict", "/odom", "--record", str(folder))
    station = operators.operator(odom=HEARD)
    robot.runtime(RULES, "--link", endpoint, "--robot", "tb3")
    robot.source(odom=SOURCE)
    predicted: list[Told] = []
    while len(predicted) < ENOUGH:
        station.line_with("heard")
        heard = [told(bytes.fromhex(value)) for _, value, _ in station.result("go on")["odom"]]
        predicted = [one for one in heard if one.variance]
    arrived = [one for one in heard if not one.variance]
    assert {one.variance for one in predicted} == {BOUND_M**2}
    since_s = arrived[0].stamp_s - driven_s(arrived[0])
    turn_s = 2 * math.pi / TWIST[1]
    for one in (*arrived, *predicted):
        assert math.hypot(one.x, TWIST[0] / TWIST[1] - one.y) == pytest.approx(TWIST[0] / TWIST[1])
        assert math.remainder(one.stamp_s - driven_s(one) - since_s, turn_s) == pytest.approx(0, abs=1e-6)

    receiving.signal(signal.SIGINT)
    assert receiving.exit_code() == 0
    with open_recording(folder / "tb3") as recording:
        recorded = [told(payload) for one, _, payload in recording.messages() if one.topic == "/odom"]
    assert {*arrived} <= {*recorded}
    assert not any(one.variance for one in recorded)
    # A heartbeat each two seconds, and predicted messages at the rate of the source.
    assert sum(one.stamp_s > predicted[0].stamp_s for one in arrived) < len(predicted) / 2
