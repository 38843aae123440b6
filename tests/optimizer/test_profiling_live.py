# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""Profiles measured on a running robot, here one in virtual time."""

from __future__ import annotations

from pathlib import Path

import pytest

from robot.status.virtual_robot import Source, VirtualRobot
from smarttestudo.cli.main import main
from smarttestudo.domain.errors import TestudoError
from smarttestudo.domain.profile import LevelledProperty, Profile
from smarttestudo.robot.profile import RobotProfile, profile_of_robot
from smarttestudo.rules.profile_file import load_profile

TESTUDO = ("/smarttestudo2",)


def measured(robot: VirtualRobot, *patterns: str, seconds: float = 10) -> RobotProfile:
    return profile_of_robot(
        robot,
        seconds=seconds,
        timeout_s=5,
        patterns=patterns,
        steady_s=robot.steady_s,
        report=lambda share: None,
    )


def profile_in(folder: Path, profile: RobotProfile) -> Profile:
    path = folder / "profile.toml"
    path.write_text(profile.text, encoding="utf-8")
    return load_profile(path)


def test_rates_and_sizes_are_those_of_the_sources(tmp_path: Path) -> None:
    robot = VirtualRobot(sources={"/imu": Source(hz=10), "/late": Source(hz=2, from_s=4), "/map": Source()})
    profile = profile_in(tmp_path, measured(robot))
    assert profile.topic("/imu").source_hz == pytest.approx(10, rel=0.01)
    assert profile.topic("/late").source_hz == pytest.approx(2, rel=0.01)
    assert {topic.message_kb for topic in profile.topics.values()} == {0.25}
    assert profile.topic("/map").source_hz == 0.1
    assert (profile.topic("/map").tiers_hz, profile.topic("/imu").tiers_hz is None) == (None, False)


def test_a_topic_that_loses_says_so_and_its_rate_counts_what_was_lost(tmp_path: Path) -> None:
    sources = {"/image": Source(hz=15, one_of=3), "/scan": Source(hz=15)}
    profile = measured(VirtualRobot(sources=sources), seconds=30)
    assert [line for line in profile.text.splitlines() if "lost" in line] == [
        "# 67 % of its messages were lost on their way here; the rate counts them"
    ]
    assert profile.text.index('"/image"') < profile.text.index("lost") < profile.text.index('"/scan"')
    (notice,) = profile.notices
    assert notice.startswith("/image: 67 % of its messages were lost on their way here; ")
    rates = {name: topic.source_hz for name, topic in profile_in(tmp_path, profile).topics.items()}
    assert rates == pytest.approx({"/image": 15, "/scan": 15}, rel=0.02)


def test_a_topic_with_two_publishers_says_so(tmp_path: Path) -> None:
    sources = {"/tf": Source(hz=10, nodes=("/diff_drive", "/robot_state_publisher")), "/imu": Source(hz=10)}
    profile = measured(VirtualRobot(sources=sources))
    (line,) = (line for line in profile.text.splitlines() if "publishers" in line)
    assert line == "# 2 publishers, measured together; live, each of them has the topic's rate"
    assert profile.text.index('"/tf"') < profile.text.index(line)
    assert set(profile_in(tmp_path, profile).topics) == {"/imu", "/tf"}


def test_a_pose_that_does_not_move_needs_the_heartbeat_only(tmp_path: Path) -> None:
    robot = VirtualRobot(sources={"/pose": Source(type_name="geometry_msgs/msg/PoseStamped", hz=10)})
    found = profile_in(tmp_path, measured(robot, seconds=20)).topic("/pose")
    tiers = found.accuracies[LevelledProperty.POSITION]
    assert tiers.needs_hz == pytest.approx((0.5,) * 6, rel=0.15)


def test_what_is_not_the_robots_own_is_left_out(tmp_path: Path) -> None:
    robot = VirtualRobot(
        sources={
            "/imu": Source(hz=10),
            "/rosout": Source(hz=1),
            "/parameter_events": Source(hz=1),
            "/_hidden": Source(hz=1),
            "/arm/_hidden/state": Source(hz=1),
            "/testudo/status": Source(nodes=TESTUDO),
            "/testudo/imu": Source(nodes=TESTUDO, hz=5),
            "/diagnostics": Source(nodes=(*TESTUDO, "/driver"), hz=1),
        }
    )
    assert list(profile_in(tmp_path, measured(robot)).topics) == ["/diagnostics", "/imu"]


def test_an_output_of_a_smarttestudo_that_is_recognised_late_is_left_out_too(tmp_path: Path) -> None:
    robot = VirtualRobot(
        sources={
            "/imu": Source(hz=10),
            "/testudo/imu": Source(nodes=TESTUDO, hz=5),
            "/testudo/status": Source(nodes=TESTUDO, from_s=3),
        }
    )
    assert list(profile_in(tmp_path, measured(robot)).topics) == ["/imu"]


def test_topics_can_be_chosen(tmp_path: Path) -> None:
    robot = VirtualRobot(sources={name: Source(hz=10) for name in ("/imu", "/camera/left", "/camera/right")})
    chosen = profile_in(tmp_path, measured(robot, "/camera/*"))
    assert list(chosen.topics) == ["/camera/left", "/camera/right"]


@pytest.mark.parametrize(
    ("robot", "patterns", "line"),
    [
        (VirtualRobot(), (), "error: no topic is seen within 5 s; start the robot's nodes"),
        (VirtualRobot(sources={"/imu": Source()}, start_ns=0), (), "error: no time comes on /clock within"),
        (
            VirtualRobot(sources={"/odom": Source()}),
            ("/odm",),
            "--topics: error: no topic /odm; did you mean",
        ),
        (VirtualRobot(sources={"/odom": Source()}), ("/x",), "--topics: error: no topic /x; `ros2 topic"),
    ],
)
def test_where_nothing_can_be_measured_one_line_says_why(
    robot: VirtualRobot, patterns: tuple[str, ...], line: str
) -> None:
    with pytest.raises(TestudoError) as raised:
        measured(robot, *patterns)
    assert str(raised.value).startswith(line)


def test_a_type_that_is_not_installed_costs_its_topic_only(tmp_path: Path) -> None:
    robot = VirtualRobot(
        sources={"/imu": Source(hz=10), "/odd": Source(type_name="odd_msgs/msg/Odd", hz=10)},
        missing_types=frozenset({"odd_msgs/msg/Odd"}),
    )
    profile = measured(robot)
    assert list(profile_in(tmp_path, profile).topics) == ["/imu"]
    assert profile.notices == ("/odd: error: the message type odd_msgs/msg/Odd is not installed",)


def test_a_curve_of_a_running_robot_is_a_wrong_usage(capsys: pytest.CaptureFixture[str]) -> None:
    assert main(["profile", "--seconds", "1", "--from-curve"]) == 2
    line = "--from-curve: error: a curve needs a recording; give one with --bag\n"
    assert capsys.readouterr().err == line
