# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""Bounds where the robot, or the operator's picture, has no value for a while."""

from __future__ import annotations

import json
import math
from collections.abc import Callable
from pathlib import Path

import pytest

from bags.bag_factory import BagContent, write_bag
from pacing.reckoning.ros_messages import (
    JOINTS,
    ODOMETRY,
    TRANSFORMS,
    joints,
    odometry,
    planar,
    transforms,
)
from replays.replay_runs import ReplayRun, replay_content
from replays.test_replay_bounds import recorded
from smarttestudo.cli.main import main

LOST = pytest.mark.parametrize("lost", [math.nan, math.inf, -math.inf])


def lost_for_two_seconds(lost: float) -> Callable[[int, float], bytes]:
    """0.5 m/s along x, whose localization says nothing from 5 s to 7 s."""
    return lambda at, t_s: odometry(at, planar(lost if 5 <= t_s < 7 else 0.5 * t_s, 0, 0))


def loss_of(run: ReplayRun, capsys: pytest.CaptureFixture[str], *options: str) -> str:
    folder = run.output.parent
    rules = str(folder / "rules.adirf")
    capsys.readouterr()
    assert main(["bag", "loss", str(folder / "bag"), str(run.output), "--rules", rules, *options]) == 0
    return capsys.readouterr().out


@LOST
@pytest.mark.parametrize("rate", ["Full", "2"])
def test_no_bound_is_judged_while_the_robot_says_no_position(
    lost: float, rate: str, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    run = replay_content(
        recorded("/odom", ODOMETRY, 20, 10, lost_for_two_seconds(lost)),
        f"SetFrequency /odom {rate} KeepWithin /odom position 0.06 KeepWithin /odom yaw 1",
        tmp_path,
    )
    position, yaw = json.loads(loss_of(run, capsys, "--json"))["bounds"]
    assert (position["messages"], position["unreadable"]) == (160, 40)
    assert (yaw["messages"], yaw["unreadable"], yaw["broken"]) == (200, 0, 0)
    outcome = run.outcome.topics["/odom"]
    # The replay judged the same messages alike, as the robot would have.
    assert outcome.bounds["position"][0].broken == position["broken"]
    assert outcome.bounds["position"][0].worst == pytest.approx(position["worst"])
    assert outcome.unreadable == 40
    assert "Not judged, as they have no value there: /odom position 0.06 by 40 messages." in " ".join(
        loss_of(run, capsys).split()
    )


@LOST
def test_what_is_no_position_is_news_to_the_operator(lost: float, tmp_path: Path) -> None:
    run = replay_content(
        recorded("/odom", ODOMETRY, 20, 10, lost_for_two_seconds(lost)),
        "SetFrequency /odom Full KeepWithin /odom position 1",
        tmp_path,
    )
    passed_s = [(one.stamp_ns - run.messages[0].stamp_ns) / 1e9 for one in run.messages]
    assert 5.0 in passed_s  # at once, and the first position after it
    assert 7.0 in passed_s


def test_a_picture_that_says_nothing_is_broken_where_the_robot_knows(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    content = recorded("/odom", ODOMETRY, 20, 10, lost_for_two_seconds(math.nan))
    replay_content(content, "SetFrequency /odom Full KeepWithin /odom position 0.06", tmp_path)
    # The radio was gone for a second after the last message without a position.
    kept = tuple(one for one in content.messages if not 140 <= content.messages.index(one) < 160)
    seen = write_bag(tmp_path / "seen", BagContent(content.topics, kept))
    rules = str(tmp_path / "rules.adirf")
    capsys.readouterr()
    assert main(["bag", "loss", str(tmp_path / "bag"), str(seen), "--rules", rules, "--json"]) == 0
    (bound,) = json.loads(capsys.readouterr().out)["bounds"]
    assert (bound["broken"], bound["worst"], bound["unreadable"]) == (20, 0, 40)
    assert bound["stretches"] == [{"from_s": 7, "to_s": 8, "messages": 20, "worst": None}]


def test_one_frame_without_a_pose_hides_no_error_of_another(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    def frames(at: int, t_s: float) -> bytes:
        return transforms(at, {"base": planar(0.5 * t_s, 0, 0), "tool": planar(math.nan, 0, 0)})

    run = replay_content(
        recorded("/tf", TRANSFORMS, 20, 10, frames),
        "SetFrequency /tf 2 KeepWithin /tf position 0.06",
        tmp_path,
    )
    (bound,) = json.loads(loss_of(run, capsys, "--json"))["bounds"]
    assert (bound["messages"], bound["unreadable"]) == (200, 0)
    assert bound["worst"] == pytest.approx(0.225, abs=0.05)
    (record,) = run.outcome.topics["/tf"].bounds["position"]
    assert record.broken == bound["broken"]
    assert record.worst == pytest.approx(bound["worst"])


def test_a_joint_without_a_position_is_not_judged(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    def arm(at: int, t_s: float) -> bytes:
        return joints(at, {"hip": math.nan if t_s < 5 else 0.3 * t_s})

    run = replay_content(
        recorded("/joint_states", JOINTS, 20, 10, arm),
        "SetFrequency /joint_states Full KeepWithin /joint_states positions 0.05",
        tmp_path,
    )
    (bound,) = json.loads(loss_of(run, capsys, "--json"))["bounds"]
    assert (bound["messages"], bound["unreadable"], bound["broken"]) == (100, 100, 0)


def test_the_cost_of_a_bound_is_that_of_the_messages_that_say_something(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    bag = write_bag(tmp_path / "bag", recorded("/odom", ODOMETRY, 20, 10, lost_for_two_seconds(math.nan)))
    assert main(["bag", "loss", str(bag), "--json"]) == 0
    found = json.loads(capsys.readouterr().out)
    (position,) = found["accuracy"]
    assert [one["hold"]["messages"] for one in position["points"]][:2] == [160, 160]
    assert "/odom position: 40 messages without a value, which no bound's figures hold" in found["notices"]
