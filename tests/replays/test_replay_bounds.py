# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""Replays under bounds: frames of different motion, a walking arm, a stop button, dead reckoning."""

from __future__ import annotations

import json
import math
from collections.abc import Callable
from dataclasses import replace
from pathlib import Path

import pytest

from bags.bag_factory import START_NS, BagContent, BagMessage, BagTopic, cdr, message_of
from pacing.reckoning.ros_messages import JOINTS, ODOMETRY, TRANSFORMS, joints, odometry, planar, transforms
from replays.replay_runs import ReplayRun, replay_content
from smarttestudo.accuracy.recorded_loss import LossQuestion, measure_loss
from smarttestudo.cli.main import main
from smarttestudo.pacing.reckoning.motion import Twist, Vector3
from smarttestudo.rules.rule_sets import load_rules

SECOND_NS = 1_000_000_000
BOOL = "std_msgs/msg/Bool"


def recorded(
    topic: str, type_name: str, hz: float, seconds: float, write: Callable[[int, float], bytes]
) -> BagContent:
    stamps = [START_NS + round(number * SECOND_NS / hz) for number in range(round(hz * seconds))]
    messages = tuple(
        BagMessage(topic, stamp_ns, write(stamp_ns, (stamp_ns - START_NS) / SECOND_NS)) for stamp_ns in stamps
    )
    return BagContent((BagTopic(topic, type_name),), messages)


def driven(stamp_ns: int, t_s: float) -> bytes:
    """0.5 m/s around a circle of 5 m."""
    angle = 0.1 * t_s
    pose = planar(5 * math.sin(angle), 5 - 5 * math.cos(angle), angle)
    return odometry(stamp_ns, pose, Twist(Vector3(0.5, 0, 0), Vector3(0, 0, 0.1)))


def moved_frames(stamp_ns: int, t_s: float) -> bytes:
    """A base that drives, a gripper that waits for 5 s and turns, and a camera that never moves."""
    return transforms(
        stamp_ns,
        {
            "base": planar(0.5 * t_s, 0, 0),
            "gripper": planar(1, 0, max(t_s - 5, 0)),
            "camera": planar(0, 1, 0),
        },
    )


def walking_arm(stamp_ns: int, t_s: float) -> bytes:
    return joints(stamp_ns, {"hip": 0.5 * math.sin(2 * t_s), "knee": 0.2 * math.sin(4 * t_s), "wrist": 0.0})


def stop_button(_: int, t_s: float) -> bytes:
    """Pressed at 30 s, let go at 40 s."""
    return cdr(BOOL, message_of(BOOL, data=30 <= t_s < 40))


def bounds_of(run: ReplayRun, topic: str) -> dict[str, tuple[float, float, int]]:
    """The only bound of each property."""
    found = {}
    for name, (one,) in run.outcome.topics[topic].bounds.items():
        assert one.worst is not None
        found[name] = (one.bound, one.worst, one.broken)
    return found


def test_odometry_is_within_its_bound_after_every_message(tmp_path: Path) -> None:
    run = replay_content(
        recorded("/odom", ODOMETRY, 50, 20, driven),
        "SetFrequency /odom Full KeepWithin /odom position 0.1",
        tmp_path,
    )
    ((bound, worst, broken),) = bounds_of(run, "/odom").values()
    assert (bound, broken) == (0.1, 0)
    assert 0.08 < worst <= 0.1
    assert 90 <= len(run.on("/odom")) <= 110


def test_a_bound_alone_relays_whatever_it_needs(tmp_path: Path) -> None:
    source, bound = recorded("/odom", ODOMETRY, 50, 20, driven), "KeepWithin /odom position 0.1"
    run = replay_content(source, bound, tmp_path / "alone")
    assert run.on("/odom") == replay_content(source, f"SetFrequency /odom Full {bound}", tmp_path).on("/odom")
    assert [(one.planned.rate.is_full, one.planned.within) for one in run.decisions] == [
        (True, {"position": 0.1})
    ]


def test_a_block_that_is_never_known_leaves_a_topic_its_rate(tmp_path: Path) -> None:
    source, alone = recorded("/odom", ODOMETRY, 50, 20, driven), "SetFrequency /odom 10"
    block = "If CheckValue /battery_state level < 20 Then KeepWithin /odom position 0.5"
    run = replay_content(source, f"{alone} {block}", tmp_path / "doubt")
    assert run.on("/odom") == replay_content(source, alone, tmp_path / "alone").on("/odom")
    assert bounds_of(run, "/odom") == {}


def test_a_robot_that_is_reckoned_sends_a_heartbeat_and_what_is_recorded_was_sent(tmp_path: Path) -> None:
    content = recorded("/odom", ODOMETRY, 50, 20, driven)
    rules = "SetFrequency /odom Full KeepWithin /odom position 0.01"
    run = replay_content(content, rules, tmp_path, predict=frozenset({"/odom"}))
    ((_, worst, broken),) = bounds_of(run, "/odom").values()
    assert (worst <= 0.01, broken) == (True, 0)
    assert 10 <= len(run.on("/odom")) <= 12
    sent = {message.payload for message in content.messages}
    assert all(message.payload in sent for message in run.on("/odom"))


def test_of_frames_that_move_differently_the_one_that_moves_decides(tmp_path: Path) -> None:
    content = recorded("/tf", TRANSFORMS, 50, 10, moved_frames)
    rules = "SetFrequency /tf Full KeepWithin /tf position 0.1 KeepWithin /tf orientation 5"
    hold = replay_content(content, rules, tmp_path)
    assert all(broken == 0 and worst <= bound for bound, worst, broken in bounds_of(hold, "/tf").values())
    # 0.5 m/s in steps of 10 cm, while 57°/s in steps of 5° come on top from 5 s on.
    at_first = sum(message.stamp_ns < START_NS + 5 * SECOND_NS for message in hold.on("/tf"))
    assert 20 <= at_first <= 30
    assert 50 <= len(hold.on("/tf")) - at_first <= 65


def test_constant_twists_of_frames_are_reckoned(tmp_path: Path) -> None:
    content = recorded("/tf", TRANSFORMS, 50, 10, moved_frames)
    rules = "SetFrequency /tf Full KeepWithin /tf position 0.1 KeepWithin /tf orientation 5"
    run = replay_content(content, rules, tmp_path, predict=frozenset({"/tf"}))
    assert all(broken == 0 for _, _, broken in bounds_of(run, "/tf").values())
    assert len(run.on("/tf")) <= 12


def test_the_joints_of_a_walking_arm_are_within_their_bound(tmp_path: Path) -> None:
    content = recorded("/joint_states", JOINTS, 100, 10, walking_arm)
    rules = "SetFrequency /joint_states Full KeepWithin /joint_states positions 0.05"
    hold = replay_content(content, rules, tmp_path)
    (tmp_path / "reckoned").mkdir()
    reckoned = replay_content(content, rules, tmp_path / "reckoned", predict=frozenset({"/joint_states"}))
    for run in (hold, reckoned):
        ((_, worst, broken),) = bounds_of(run, "/joint_states").values()
        assert (worst <= 0.05, broken) == (True, 0)
    assert len(reckoned.on("/joint_states")) < len(hold.on("/joint_states")) < 250


def test_a_stop_button_passes_every_change_and_a_heartbeat(tmp_path: Path) -> None:
    content = recorded("/estop", BOOL, 10, 60, stop_button)
    run = replay_content(content, "SetFrequency /estop Full KeepWithin /estop data 0", tmp_path)
    assert bounds_of(run, "/estop") == {"data": (0, 0, 0)}
    changes = {START_NS + 30 * SECOND_NS, START_NS + 40 * SECOND_NS}
    passed = [message.stamp_ns for message in run.on("/estop")]
    assert changes <= set(passed)
    assert len(passed) <= 34


def test_a_ceiling_that_breaks_the_bound_is_counted_with_the_worst(tmp_path: Path) -> None:
    run = replay_content(
        recorded("/odom", ODOMETRY, 50, 20, driven),
        "SetFrequency /odom 1 KeepWithin /odom position 0.1",
        tmp_path,
    )
    ((bound, worst, broken),) = bounds_of(run, "/odom").values()
    # 0.5 m a second: the first 10 cm of each are within the bound.
    assert bound == 0.1
    assert worst == pytest.approx(0.5, abs=0.03)
    assert 740 <= broken <= 810
    assert 20 <= len(run.on("/odom")) <= 22


def test_each_bound_has_its_own_worst(tmp_path: Path) -> None:
    run = replay_content(
        recorded("/odom", ODOMETRY, 50, 20, driven),
        """SetFrequency /odom Full KeepWithin /odom position 0.5
        Rule "Late" Priority 5 If (CheckValue /odom pose_y > 2) Then KeepWithin /odom position 0.05 EndIf""",
        tmp_path,
    )
    loose, tight = sorted(run.outcome.topics["/odom"].bounds["position"], key=lambda one: -one.bound)
    assert (loose.bound, tight.bound, loose.broken, tight.broken) == (0.5, 0.05, 0, 0)
    assert loose.worst is not None
    assert tight.worst is not None
    assert 0.4 < loose.worst <= 0.5
    assert 0.03 < tight.worst <= 0.05


def test_messages_that_cannot_be_read_break_no_bound(tmp_path: Path) -> None:
    content = recorded("/odom", ODOMETRY, 50, 20, driven)
    cut = tuple(
        replace(one, payload=one.payload[:20]) if number % 10 == 5 else one
        for number, one in enumerate(content.messages)
    )
    rules = "SetFrequency /odom 1 KeepWithin /odom position 0.1"
    run = replay_content(replace(content, messages=cut), rules, tmp_path)
    assert run.outcome.topics["/odom"].unreadable == 100
    rule_set = load_rules([tmp_path / "rules.adirf"]).rule_set
    (sent,) = measure_loss(tmp_path / "bag", run.output, LossQuestion(rule_set=rule_set)).bounds
    assert bounds_of(run, "/odom") == {"position": (0.1, sent.worst, sent.broken)}
    assert (sent.messages, sent.unreadable) == (900, 100)


def test_fields_of_messages_that_cannot_be_decoded_are_counted_as_poses_are(tmp_path: Path) -> None:
    def broken(stamp_ns: int, t_s: float) -> bytes:
        return cdr(BOOL, message_of(BOOL)) if t_s < 5 else b"\x00\x01"

    content = recorded("/estop", BOOL, 2, 10, broken)
    run = replay_content(content, "SetFrequency /estop Full KeepWithin /estop data 0", tmp_path)
    assert run.outcome.topics["/estop"].unreadable == 10


def test_a_bound_of_what_cannot_be_read_at_all_has_no_worst(tmp_path: Path) -> None:
    content = recorded("/odom", ODOMETRY, 50, 2, lambda _stamp_ns, _t_s: b"\x00\x01\x00\x00")
    run = replay_content(content, "SetFrequency /odom 1 KeepWithin /odom position 0.1", tmp_path)
    (record,) = run.outcome.topics["/odom"].bounds["position"]
    assert (record.worst, record.broken) == (None, 0)


def test_json_and_text_say_how_bounds_were_kept(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    replay_content(recorded("/odom", ODOMETRY, 50, 2, driven), "SetFrequency /odom Full", tmp_path)
    rules = tmp_path / "bounds.adirf"
    rules.write_text("begin SetFrequency /odom Full KeepWithin /odom position 0.05 end")
    command = ["replay", str(tmp_path / "monitored"), "--rules", str(rules), "--predict", "/odom", "--output"]
    assert main([*command, str(tmp_path / "one"), "--json"]) == 0
    (bound,) = json.loads(capsys.readouterr().out)["topics"]["/odom"]["bounds"]["position"]
    assert (bound["bound"], bound["broken"]) == (0.05, 0)
    assert main([*command, str(tmp_path / "two")]) == 0
    assert "Bounds" in capsys.readouterr().out


def test_only_relayed_topics_can_be_predicted(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    replay_content(recorded("/odom", ODOMETRY, 50, 2, driven), "SetFrequency /odom Full", tmp_path)
    rules = tmp_path / "bounds.adirf"
    rules.write_text("begin SetFrequency /odom Full end")
    output = str(tmp_path / "one")
    arguments = ["replay", str(tmp_path / "monitored"), "--rules", str(rules), "--output", output]
    assert main([*arguments, "--predict", "/tf"]) != 0
    assert "no rule relays /tf" in capsys.readouterr().err


def test_predicted_topics_may_be_named_by_several_options(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    replay_content(recorded("/odom", ODOMETRY, 50, 20, driven), "SetFrequency /odom Full", tmp_path)
    rules = tmp_path / "bounds.adirf"
    rules.write_text("begin SetFrequency /tf 1 KeepWithin /odom position 0.05 end")
    command = ["replay", str(tmp_path / "monitored"), "--rules", str(rules), "--json", "--output"]
    sent = []
    for number, named in enumerate((["/odom", "/tf"], ["/odom", "--predict", "/tf"])):
        assert main([*command, str(tmp_path / str(number)), "--predict", *named]) == 0
        sent.append(json.loads(capsys.readouterr().out)["topics"]["/odom"]["out"])
    assert sent[0] == sent[1]
