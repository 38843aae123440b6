# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""How far a picture is off, by property, read from serialized messages of another implementation."""

from __future__ import annotations

import math
from types import SimpleNamespace

import pytest

from pacing.reckoning.ros_messages import (
    JOINTS,
    NO_TWIST,
    ODOMETRY,
    POSE_STAMPED,
    POSE_WITH_COVARIANCE_STAMPED,
    TRANSFORMS,
    joints,
    odometry,
    planar,
    pose_stamped,
    pose_with_covariance_stamped,
    transforms,
)
from smarttestudo.domain.units import NS_PER_S
from smarttestudo.language.properties import gauges_for, needs_decoded
from smarttestudo.pacing.reckoning.estimate import Estimate
from smarttestudo.pacing.reckoning.motion import Twist, Vector3

AT_NS = 5 * NS_PER_S
ONE, OTHER = planar(1, 2, math.radians(179)), planar(4, 6, math.radians(-178))


def errors(
    type_name: str,
    names: list[str],
    shown: bytes,
    true: bytes,
    *,
    decoded: tuple[object, object] = (None, None),
    reckons: bool = False,
) -> dict[str, float]:
    picture = Estimate(gauges_for(type_name, names), reckons=reckons)
    picture.show(picture.read(shown, decoded[0], AT_NS), None)
    return picture.errors(picture.read(true, decoded[1], AT_NS + NS_PER_S), None)


@pytest.mark.parametrize(
    ("type_name", "write"),
    [
        (ODOMETRY, odometry),
        (POSE_STAMPED, pose_stamped),
        (POSE_WITH_COVARIANCE_STAMPED, pose_with_covariance_stamped),
    ],
)
def test_poses_differ_in_position_orientation_and_every_property_of_checks(
    type_name: str, write: object
) -> None:
    assert callable(write)
    names = ["position", "orientation", "pose_x", "yaw", "pose_y"]
    found = errors(type_name, names, write(AT_NS, ONE), write(AT_NS, OTHER))
    assert found == pytest.approx({"position": 5, "orientation": 3, "pose_x": 3, "yaw": 3, "pose_y": 4})
    assert not needs_decoded(gauges_for(type_name, names))


def test_a_field_of_the_pose_or_twist_is_read_without_decoding_and_others_are_not() -> None:
    names = ["pose.pose.position.y", "vel", "twist.twist.angular.z"]
    twist = Twist(Vector3(0.5, 0, 0), Vector3(0, 0, 0.25))
    found = errors(ODOMETRY, names, odometry(AT_NS, ONE), odometry(AT_NS, OTHER, twist))
    assert found == {"pose.pose.position.y": 4, "vel": 0.5, "twist.twist.angular.z": 0.25}
    assert needs_decoded(gauges_for(ODOMETRY, ["pose.covariance[0]"]))


@pytest.mark.parametrize("name", ["pose.pose.height", "pose.pose.position", "msg.twist.twist.linear.w"])
def test_what_the_pose_and_twist_do_not_hold_is_never_right(name: str) -> None:
    assert errors(ODOMETRY, [name], odometry(AT_NS, ONE), odometry(AT_NS, OTHER)) == {name: math.inf}


def test_of_transforms_the_frame_that_is_farthest_off_counts() -> None:
    shown = transforms(AT_NS, {"base": planar(0, 0, 0), "arm": planar(0, 0, 0)})
    true = transforms(AT_NS, {"arm": planar(0, 0, 0.5), "base": planar(3, 4, 0)})
    found = errors(TRANSFORMS, ["position", "orientation"], shown, true)
    assert found == pytest.approx({"position": 5, "orientation": math.degrees(0.5)})


def test_a_frame_that_was_never_shown_or_has_another_parent_is_infinitely_far_off() -> None:
    shown = transforms(AT_NS, {"base": planar(0, 0, 0)})
    new = transforms(AT_NS, {"base": planar(0, 0, 0), "arm": planar(0, 0, 0)})
    moved = transforms(AT_NS, {"base": planar(0, 0, 0)}, parent="map")
    for true in (new, moved):
        assert errors(TRANSFORMS, ["position"], shown, true) == {"position": math.inf}


def test_of_joints_the_one_that_is_farthest_off_counts() -> None:
    shown = joints(AT_NS, {"hip": 0.5, "knee": 1.0})
    assert errors(JOINTS, ["positions"], shown, joints(AT_NS, {"knee": 0.75, "hip": 0.6})) == {
        "positions": 0.25
    }


def test_joints_move_on_with_the_velocity_of_their_message() -> None:
    shown = joints(AT_NS, {"hip": 0.5, "knee": 1.0}, [0.25, -0.5], frame="body")
    true = joints(AT_NS + 2 * NS_PER_S, {"hip": 1.0, "knee": 0.0}, [0.25, -0.5], frame="body")
    assert errors(JOINTS, ["positions"], shown, true, reckons=True) == {"positions": 0}


def test_joints_without_velocities_move_on_as_between_the_last_two_messages() -> None:
    picture = Estimate(gauges_for(JOINTS, ["positions"]), reckons=True)
    for seconds in (0, 1):
        picture.show(picture.read(joints(AT_NS + seconds * NS_PER_S, {"hip": 0.25 * seconds}), None, 0), None)
    true = picture.read(joints(AT_NS + 3 * NS_PER_S, {"hip": 0.75}), None, 0)
    assert picture.errors(true, None) == {"positions": 0}


def test_any_field_of_any_type_is_compared_as_a_number_or_as_a_text() -> None:
    def field_errors(shown: object, true: object) -> dict[str, float]:
        messages = SimpleNamespace(data=shown), SimpleNamespace(data=true)
        return errors("std_msgs/msg/Any", ["data"], b"", b"", decoded=messages)

    assert field_errors(False, True) == {"data": 1}
    assert field_errors(7, 7) == {"data": 0}
    assert field_errors("idle", "idle") == {"data": 0}
    assert field_errors("idle", "charging") == {"data": math.inf}
    assert field_errors(math.nan, math.nan) == {"data": 0}
    assert field_errors(1.0, math.nan) == {"data": math.inf}
    assert field_errors([1], [1]) == {"data": math.inf}


@pytest.mark.parametrize("type_name", [ODOMETRY, TRANSFORMS, JOINTS])
def test_a_message_that_cannot_be_read_is_infinitely_far_off(type_name: str) -> None:
    name = "positions" if type_name == JOINTS else "position"
    whole = {
        ODOMETRY: odometry(AT_NS, ONE, NO_TWIST),
        TRANSFORMS: transforms(AT_NS, {"base": ONE}),
        JOINTS: joints(AT_NS, {"hip": 1.0}),
    }[type_name]
    for cut in range(0, 40, 3):
        assert errors(type_name, [name], whole, whole[:cut]) == {name: math.inf}
