# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""``testudo bag accuracy`` with the examples that bound something else than the demo's odometry."""

from __future__ import annotations

import json
import math
from collections.abc import Callable
from pathlib import Path
from typing import Any

import pytest

from bags.bag_factory import (
    START_NS,
    BagContent,
    BagMessage,
    BagTopic,
    cdr,
    message_of,
    write_bag,
)
from pacing.reckoning.ros_messages import (
    JOINTS,
    ODOMETRY,
    TRANSFORMS,
    joints,
    odometry,
    planar,
    transforms,
)
from smarttestudo.cli.main import main
from smarttestudo.pacing.reckoning.motion import Twist, Vector3

EXAMPLES = Path(__file__).parents[2] / "examples"
SECOND_NS = 1_000_000_000
BOOL = "std_msgs/msg/Bool"
HOURS = 3
PRESSED_S = (3600.5, 7200.5)
PRESSED_FOR_S = 60


def stream(
    topic: str, type_name: str, hz: float, seconds: float, write: Callable[[int, float], bytes]
) -> BagContent:
    stamps = [START_NS + round(number * SECOND_NS / hz) for number in range(round(hz * seconds))]
    return BagContent(
        (BagTopic(topic, type_name),),
        tuple(BagMessage(topic, stamp, write(stamp, (stamp - START_NS) / SECOND_NS)) for stamp in stamps),
    )


def both(one: BagContent, other: BagContent) -> BagContent:
    messages = sorted((*one.messages, *other.messages), key=lambda message: message.stamp_ns)
    return BagContent((*one.topics, *other.topics), tuple(messages))


def manipulator_frames(stamp_ns: int, t_s: float) -> bytes:
    """It drives for 20 s, then stands; the gripper turns from 30 s to 32 s; the camera never moves."""
    return transforms(
        stamp_ns,
        {
            "base": planar(0.5 * min(t_s, 20), 0, 0),
            "gripper": planar(1, 0, min(max(t_s - 30, 0), 2)),
            "camera": planar(0, 1, 0),
        },
    )


def manipulator_odometry(stamp_ns: int, t_s: float) -> bytes:
    pose = planar(0.5 * min(t_s, 20), 0, 0)
    return odometry(stamp_ns, pose, Twist(Vector3(0.5 if t_s < 20 else 0, 0, 0), Vector3(0, 0, 0)))


def walking_arm(stamp_ns: int, t_s: float) -> bytes:
    """A stride of 0.3 Hz, with pauses of 5 s in 15 s."""
    phase = 2 * math.pi * 0.3 * (min(t_s % 15, 10) + 10 * (t_s // 15))
    return joints(stamp_ns, {"hip": 0.5 * math.sin(phase), "knee": 0.2 * math.sin(2 * phase), "wrist": 0.0})


def is_pressed(t_s: float) -> bool:
    return any(start <= t_s < start + PRESSED_FOR_S for start in PRESSED_S)


def compared(
    content: BagContent, example: str, folder: Path, capsys: pytest.CaptureFixture[str], *more: str
) -> dict[str, Any]:
    """The ways of choosing what passes, by rules and what is shown."""
    bag, rules = write_bag(folder / "bag", content), str(EXAMPLES / example)
    assert main(["bag", "accuracy", str(bag), "--rules", rules, *more, "--json"]) == 0
    said = json.loads(capsys.readouterr().out)
    return {f"{arm['name']}, {arm['shows']}": arm for arm in said["arms"]}


@pytest.mark.full
def test_frames_of_different_motion_are_each_within_the_bound(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    content = both(
        stream("/tf", TRANSFORMS, 30, 60, manipulator_frames),
        stream("/odom", ODOMETRY, 20, 60, manipulator_odometry),
    )
    predicted = ("--predicted", str(EXAMPLES / "moving_frames.adirf"))

    arms = compared(content, "moving_frames.adirf", tmp_path, capsys, *predicted)

    held, reckoned, fixed = (
        arms[name]["topics"]["/tf"]
        for name in ("moving_frames, hold", "moving_frames, dead reckoning", "fixed rates, hold")
    )
    for said in (held["properties"], reckoned["properties"]):
        assert (said["position"]["bounds"], said["orientation"]["bounds"]) == ([0.02, 0.05], [2.0, 5.0])
        assert said["position"]["worst"] <= 0.05
        assert said["orientation"]["worst"] <= 2.0
        assert (said["position"]["broken"], said["orientation"]["broken"]) == (0, 0)
    # 10 m in steps of up to 5 cm, 115° in steps of up to 2°, a heartbeat; reckoned, little but that.
    assert 200 <= held["messages"] <= 350
    assert reckoned["messages"] <= 50
    assert fixed["properties"]["orientation"]["worst"] > 4 * held["properties"]["orientation"]["worst"]


def swerving_odometry(stamp_ns: int, t_s: float) -> bytes:
    """It drives, stands for 3 s in 10, and changes its speed with a jerk."""
    phase_s = t_s % 10
    speed = 0.0 if phase_s > 7 else 0.2 + 0.3 * math.floor(phase_s / 2)
    way_m = sum(0.2 + 0.3 * math.floor(step / 2) for step in range(int(min(phase_s, 7))))
    way_m += (min(phase_s, 7) % 1) * speed + math.floor(t_s / 10) * 4.1
    return odometry(stamp_ns, planar(way_m, 0, 0), Twist(Vector3(speed, 0, 0), Vector3(0, 0, 0)))


def test_rules_that_are_shown_reckoned_stand_beside_fixed_rates_that_are_reckoned_too(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    rules, tighter = tmp_path / "within.adirf", tmp_path / "tighter.adirf"
    rules.write_text("begin KeepWithin /odom position 0.05 end")
    tighter.write_text("begin KeepWithin /odom position 0.005 end")
    bag = write_bag(tmp_path / "bag", stream("/odom", ODOMETRY, 25, 60, swerving_odometry))
    command = ["bag", "accuracy", str(bag), "--rules", str(rules)]
    command += ["--predicted", str(rules), "--predicted", str(tighter)]

    assert main([*command, "--json"]) == 0

    arms = json.loads(capsys.readouterr().out)["arms"]
    assert [(arm["name"], arm["shows"], arm["fixed"]) for arm in arms] == [
        ("fixed rates", "hold", True),
        ("within", "hold", False),
        ("within", "dead reckoning", False),
        ("fixed rates for within", "dead reckoning", True),
        ("tighter", "dead reckoning", False),
        ("fixed rates for tighter", "dead reckoning", True),
    ]
    for by_rules, fixed in ((2, 3), (4, 5)):
        kept, rival = (arms[number]["topics"]["/odom"] for number in (by_rules, fixed))
        assert rival["messages"] == pytest.approx(kept["messages"], rel=0.05, abs=2)
        assert kept["properties"]["position"]["worst"] < rival["properties"]["position"]["worst"]
        assert rival["properties"]["position"]["bounds"] == []

    assert main(command) == 0

    said = capsys.readouterr().out
    head = (
        "Beside fixed rates that are shown alike (dead reckoning), tighter shows the position of /odom with "
    )
    assert head in said


@pytest.mark.full
def test_the_joints_of_a_walking_arm_are_within_the_bound(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    arms = compared(
        stream("/joint_states", JOINTS, 100, 60, walking_arm), "walking_arm.adirf", tmp_path, capsys
    )

    held, fixed = (
        arms[name]["topics"]["/joint_states"] for name in ("walking_arm, hold", "fixed rates, hold")
    )
    said = held["properties"]["positions"]
    assert (said["bounds"], said["unit"], said["broken"]) == ([0.02], "rad", 0)
    assert said["worst"] <= 0.02
    assert held["messages"] < 6000 / 2
    assert fixed["properties"]["positions"]["rmse"] > said["rmse"]
    assert fixed["properties"]["positions"]["worst"] > 1.5 * said["worst"]


@pytest.mark.full
def test_a_button_that_is_pressed_twice_in_hours_is_never_shown_wrong(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    messages = {pressed: cdr(BOOL, message_of(BOOL, data=pressed)) for pressed in (False, True)}
    hours = stream("/estop", BOOL, 1, HOURS * 3600, lambda _, t_s: messages[is_pressed(t_s)])

    arms = compared(hours, "stop_button.adirf", tmp_path, capsys)

    held, fixed = (arms[name]["topics"]["/estop"] for name in ("stop_button, hold", "fixed rates, hold"))
    assert held["properties"]["data"] == {
        "unit": "", "rmse": 0.0, "worst": 0.0, "bounds": [0.0], "broken": 0
    }  # fmt: skip
    # One in 10 s, and two presses with their ends.
    assert HOURS * 360 <= held["messages"] <= HOURS * 360 + 5
    assert fixed["properties"]["data"]["worst"] == 1.0


def test_without_a_bound_the_joints_that_the_rules_relay_are_compared(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    bag = write_bag(tmp_path / "bag", stream("/joint_states", JOINTS, 50, 10, walking_arm))
    rules = tmp_path / "rates.adirf"
    rules.write_text("begin SetFrequency /joint_states 10 end")

    assert main(["bag", "accuracy", str(bag), "--rules", str(rules), "--csv"]) == 0

    head, fixed, by_rules = capsys.readouterr().out.splitlines()
    assert head.startswith("name,shows,all_bytes,topic,messages,bytes,property,unit,rmse,worst,bounds,broken")
    assert fixed.startswith("fixed rates,hold,")
    assert by_rules.startswith("rates,hold,")
    assert ",positions,rad,0.0" in by_rules


def test_messages_that_cannot_be_compared_and_topics_that_are_not_there_are_told(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    def half_cut_off(stamp_ns: int, t_s: float) -> bytes:
        return cdr(BOOL, message_of(BOOL)) if t_s < 5 else b"\x00\x01"

    bag = write_bag(tmp_path / "bag", stream("/estop", BOOL, 2, 10, half_cut_off))
    rules = tmp_path / "within.adirf"
    rules.write_text("begin SetFrequency /estop Full SetFrequency /odom 5 KeepWithin /estop data 0 end")
    command = ["bag", "accuracy", str(bag), "--rules", str(rules), "--predicted", str(rules), "--json"]

    assert main(command) == 0

    notices = json.loads(capsys.readouterr().out)["notices"]
    assert notices.count("/odom: not in the recording, so nothing of it is relayed") == 1
    unread = "/estop: 10 messages could not be compared with the receiver's picture"
    assert notices.count(f"{unread}, without a value, and count for no bound of it") == 1


def test_rules_that_relay_nothing_that_can_be_measured_are_wrong_usage(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    bag = write_bag(tmp_path / "bag", stream("/estop", BOOL, 1, 3, lambda *_: cdr(BOOL, message_of(BOOL))))
    rules = tmp_path / "rates.adirf"
    rules.write_text("begin SetFrequency /estop 10 end")

    assert main(["bag", "accuracy", str(bag), "--rules", str(rules)]) == 2

    said = capsys.readouterr()
    assert (said.out, said.err.count("\n")) == ("", 1)
    assert said.err.startswith(f"{bag}: error: no rule relays a topic whose picture can be measured; ")


def test_rules_with_an_error_are_refused_with_their_place(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    bag = write_bag(tmp_path / "bag", stream("/estop", BOOL, 1, 3, lambda *_: cdr(BOOL, message_of(BOOL))))
    rules = tmp_path / "wrong.adirf"
    rules.write_text("begin\n    SetFrequency /estop\nend\n")

    assert main(["bag", "accuracy", str(bag), "--rules", str(rules)]) == 1

    said = capsys.readouterr()
    assert said.out == ""
    assert f"{rules}:2:" in said.err
