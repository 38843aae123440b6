# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""What is said of the properties that rules check, and of the values that these can have."""

from __future__ import annotations

import pytest

from checks.rule_findings import ONE_BLOCK, codes_of, findings_of
from smarttestudo.checks import CheckContext
from smarttestudo.domain.finding import Severity
from smarttestudo.domain.profile import Profile, TopicProfile


@pytest.mark.parametrize(
    ("condition", "code"),
    [
        ("CheckValue /odom age >= 0", "check-always-holds"),
        ("CheckValue /odom rate < 0", "check-never-holds"),
        ("CheckValue /odom yaw <= -180", "check-never-holds"),
        ("CheckValue /odom yaw <= 180", "check-always-holds"),
        ("CheckValue /battery_state level > 120", "check-never-holds"),
        ("CheckValue /scan distance < -1", "check-never-holds"),
        ("CheckValue @machine cpu > 120", "check-never-holds"),
        ("CheckValue @machine wifi_signal > 0", "check-never-holds"),
        ("CheckValue @link age >= 0", "check-always-holds"),
        ("CheckValue @machine cpu = 50", "equals-measured"),
    ],
)
def test_checks_beside_the_range_of_a_property_are_named(condition: str, code: str) -> None:
    assert codes_of(ONE_BLOCK.format(condition)) == [code]


@pytest.mark.parametrize("condition", ["CheckValue /tank msg.level > 120", "CheckValue /odom pose_x < -1000"])
def test_plain_fields_and_positions_can_have_any_value(condition: str) -> None:
    assert codes_of(ONE_BLOCK.format(condition)) == []


def test_a_type_with_a_field_of_that_name_is_not_taken_for_a_battery() -> None:
    profile = Profile(topics={"/tank": TopicProfile(type_name="my_msgs/msg/Tank")})
    text = "begin SetFrequency /tank 10 If CheckValue /tank level > 120 Then SetFrequency /tank 4 end"
    assert codes_of(text, context=CheckContext(profile=profile)) == []


@pytest.mark.parametrize(
    ("condition", "doubtful"),
    [
        ("CheckValue /odom pose_x = 3", True),
        ("CheckValue /odom pose_x != 3", True),
        ("CheckValue /arm torque = 2.5", True),
        ("CheckValue /gps status.status = 2", False),
        ("CheckValue /estop data != 0", False),
        ("CheckValue /scan rate = 0", False),
        ("CheckValue @link capacity = 40", True),
        ("CheckValue @link connected = 1", False),
    ],
)
def test_only_measured_numbers_are_doubtful_with_equals(condition: str, *, doubtful: bool) -> None:
    assert codes_of(ONE_BLOCK.format(condition)) == (["equals-measured"] if doubtful else [])


def test_a_commanded_velocity_may_be_compared_with_zero() -> None:
    context = CheckContext(
        bag_topics={"/cmd_vel": "geometry_msgs/msg/Twist", "/odom": "nav_msgs/msg/Odometry"}
    )
    assert codes_of(ONE_BLOCK.format("CheckValue /cmd_vel vel = 0"), context=context) == []


def test_a_property_of_another_type_is_unknown_and_fields_and_arrivals_are_not() -> None:
    context = CheckContext(
        bag_topics={"/scan": "sensor_msgs/msg/LaserScan", "/odom": "nav_msgs/msg/Odometry"}
    )
    (finding,) = findings_of(ONE_BLOCK.format("CheckValue /scan pose_x > 3"), context=context)
    assert finding.message == "sensor_msgs/msg/LaserScan, the type of /scan, has no property or field pose_x"
    assert finding.hint == "it has distance"
    for name in ("distance", "ranges[0]", "msg.range_max", "rate", "age"):
        assert codes_of(ONE_BLOCK.format(f"CheckValue /scan {name} > 3"), context=context) == []


@pytest.mark.parametrize(
    ("check", "message", "hint"),
    [
        (
            "/odom posx",
            "/odom is usually nav_msgs/msg/Odometry, which has no property or field posx",
            "did you mean 'pose_x'?",
        ),
        (
            "/tb3_0/odom heading",
            "/tb3_0/odom is usually nav_msgs/msg/Odometry, which has no property or field heading",
            "it has pose_x, pose_y, pose_z, yaw, vel and 2 more; "
            "if it is of another type, give a profile with --profile",
        ),
        (
            "/cmd_vel sped",
            "/cmd_vel is usually geometry_msgs/msg/Twist or geometry_msgs/msg/TwistStamped, "
            "which has no property or field sped",
            "did you mean 'speed'?",
        ),
        (
            "/tf pose_x",
            "/tf is usually tf2_msgs/msg/TFMessage, which has no property or field pose_x",
            "it has transforms; if it is of another type, give a profile with --profile",
        ),
        (
            "/robot/truth posx",
            "no common type has a property or field posx, and the type of /robot/truth is not known",
            "did you mean 'pose_x'? if it is a field of /robot/truth, write msg.posx or give a profile with "
            "--profile",
        ),
        (
            "/dock mode",
            "no common type has a property or field mode, and the type of /dock is not known",
            "if it is a field of /dock, write msg.mode or give a profile with --profile",
        ),
    ],
)
def test_a_property_that_will_stay_unknown_is_told_without_a_profile(
    check: str, message: str, hint: str
) -> None:
    (finding,) = findings_of(ONE_BLOCK.format(f"CheckValue {check} > 3"))
    assert (finding.code, finding.severity) == ("unknown-property", Severity.WARNING)
    assert (finding.message, finding.hint) == (message, hint)


@pytest.mark.parametrize(
    "check",
    [
        "/amcl_pose pose_x",
        "/tb3_0/scan distance",
        "/cmd_vel linear.x",
        "/cmd_vel twist.linear.x",
        "/odom msg.posx",
        "/dock msg.mode",
        "/dock mode.value",
        "/estop data",
        "/gps/fix latitude",
        "/truth pose_x",
        "/odom age",
    ],
)
def test_what_a_message_may_hold_gets_no_finding(check: str) -> None:
    assert "unknown-property" not in codes_of(ONE_BLOCK.format(f"CheckValue {check} > 3"))


def test_the_type_that_a_profile_or_a_recording_says_wins_over_the_usual_one() -> None:
    text = ONE_BLOCK.format("CheckValue /scan pose_x > 3")
    odometry = "nav_msgs/msg/Odometry"
    assert "unknown-property" in codes_of(text)
    for known in (
        CheckContext(profile=Profile(topics={"/scan": TopicProfile(type_name=odometry)})),
        CheckContext(bag_topics={"/scan": odometry, "/odom": odometry}),
    ):
        assert "unknown-property" not in codes_of(text, context=known)
    unlisted = CheckContext(bag_topics={"/scan": "acme_msgs/msg/Sweep", "/odom": odometry})
    assert "unknown-property" not in codes_of(text, context=unlisted)


@pytest.mark.parametrize("name", ["_a", "größe", "__len__"])
def test_a_property_that_no_message_can_have_is_told_whatever_the_type(name: str) -> None:
    known = CheckContext(bag_topics={"/dock": "acme_msgs/msg/Dock", "/odom": "nav_msgs/msg/Odometry"})
    (finding,) = findings_of(ONE_BLOCK.format(f"CheckValue /dock {name} > 3"), context=known)
    assert finding.message == f"no message has a property or field {name}"


def test_a_keyword_as_a_property_is_told_unless_the_type_may_have_it() -> None:
    text = ONE_BLOCK.format("CheckValue {} end > 3")
    assert "unknown-property" in codes_of(text.format("/odom"))
    known = CheckContext(bag_topics={"/dock": "acme_msgs/msg/Dock", "/odom": "nav_msgs/msg/Odometry"})
    assert codes_of(text.format("/dock"), context=known) == []


@pytest.mark.parametrize("path", ["pose.pose.height", "pose.pose.position", "msg.pose.pose.orientation.q"])
def test_a_bound_names_a_number_of_a_pose(path: str) -> None:
    (finding,) = findings_of(f"begin KeepWithin /odom {path} 1 end")
    assert finding.code == "unknown-bound"
    assert finding.message == f"/odom is usually nav_msgs/msg/Odometry, which has no number {path}"
    context = CheckContext(bag_topics={"/odom": "nav_msgs/msg/Odometry"})
    (finding,) = findings_of(f"begin KeepWithin /odom {path} 1 end", context=context)
    assert finding.message == f"nav_msgs/msg/Odometry, the type of /odom, has no number {path}"
    assert codes_of("begin KeepWithin /odom pose.pose.position.x 1 end") == []


@pytest.mark.parametrize(
    ("read", "message", "fix"),
    [
        ("@machine cup", "@machine has no property cup", "cpu"),
        ("@machine age", "@machine has no property age", None),
        ("@link rate", "@link has no property rate", None),
        ("@link data.level", "@link has no property data.level", None),
    ],
)
def test_what_the_machine_and_the_link_lack_is_named(read: str, message: str, fix: str | None) -> None:
    (found,) = findings_of(ONE_BLOCK.format(f"CheckValue {read} > 5"))
    assert (found.code, found.message) == ("unknown-property", message)
    assert (None if found.fix is None else found.fix.replacement) == fix


def test_no_recording_and_no_profile_is_asked_for_the_machine() -> None:
    context = CheckContext(
        bag_topics={"/odom": "nav_msgs/msg/Odometry"}, profile=Profile(topics={"/odom": TopicProfile()})
    )
    assert codes_of(ONE_BLOCK.format("CheckValue @machine cpu > 90"), context=context) == []


def test_a_number_beyond_a_signal_is_explained_in_its_unit() -> None:
    (found,) = findings_of(ONE_BLOCK.format("CheckValue @link used > 130"))
    assert found.message == "@link used > 130 never holds: used lies between 0 and 100 %"
    assert found.hint == "correct the number"
    (found,) = findings_of(ONE_BLOCK.format("CheckValue @link connected > 1"))
    assert found.message == "@link connected > 1 never holds: connected lies between 0 and 1"
