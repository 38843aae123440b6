# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""What an accuracy costs: the messages of bounds, and the error of fixed rates of as many."""

from __future__ import annotations

import itertools
import json
import math
from collections.abc import Callable, Sequence
from pathlib import Path
from typing import Any

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from bags.bag_factory import BagMessage, write_bag
from pacing.reckoning.ros_messages import (
    ODOMETRY,
    STORE,
    TRANSFORMS,
    odometry,
    planar,
    transforms,
)
from replays.replay_runs import replay_content
from replays.test_replay_bounds import recorded
from smarttestudo.accuracy.arms import Arm, Strategy
from smarttestudo.accuracy.samples import Message as Sent
from smarttestudo.cli.main import main
from smarttestudo.language.properties import gauges_for
from smarttestudo.pacing.reckoning.estimate import Estimate
from smarttestudo.pacing.reckoning.motion import Twist, Vector3
from smarttestudo.pacing.sample import StreamKind

S = 1_000_000_000
Pose = tuple[float, float, float]


def waits_and_turns(stamp_ns: int, t_s: float) -> bytes:
    """It waits for 4 s, and then drives at 0.5 m/s in arcs, left and right in turn, of 2 s each."""
    x, y, yaw, speed, turn = 0.0, 0.0, 0.0, 0.0, 0.0
    left_s, part = t_s - 4, 0
    while left_s > 0:
        step_s = min(left_s, 2.0)
        speed, turn = 0.5, 0.8 if part % 2 else -0.8
        x, y, yaw = driven_on((x, y, yaw), speed, turn, step_s)
        left_s, part = left_s - step_s, part + 1
    return odometry(stamp_ns, planar(x, y, yaw), Twist(Vector3(speed, 0, 0), Vector3(0, 0, turn)))


def driven_on(pose: Pose, speed: float, turn: float, step_s: float) -> Pose:
    """The unicycle, by its textbook formula."""
    x, y, yaw = pose
    if not turn:
        return x + speed * step_s * math.cos(yaw), y + speed * step_s * math.sin(yaw), yaw
    after = yaw + turn * step_s
    radius = speed / turn
    ahead = math.sin(after) - math.sin(yaw), math.cos(yaw) - math.cos(after)
    return x + radius * ahead[0], y + radius * ahead[1], after


class Seen:
    """What an odometry message says, read by another implementation."""

    def __init__(self, message: BagMessage) -> None:
        read: Any = STORE.deserialize_cdr(message.payload, ODOMETRY)
        pose, twist = read.pose.pose, read.twist.twist
        self.received_ns = message.stamp_ns
        self.at_ns = read.header.stamp.sec * S + read.header.stamp.nanosec
        yaw = 2 * math.atan2(pose.orientation.z, pose.orientation.w)
        self.pose = (pose.position.x, pose.position.y, yaw)
        self.speed, self.turn = twist.linear.x, twist.angular.z


def naive_error(
    sent: Sequence[BagMessage], received: Sequence[BagMessage], *, reckons: bool
) -> tuple[float, float]:
    """RMSE over time and worst error of the position after each message of ``sent``."""
    seen = [Seen(message) for message in received]
    truths = [Seen(message) for message in sent]
    errors = []
    for truth in truths:
        last = [one for one in seen if one.received_ns <= truth.received_ns][-1]
        elapsed_s = (truth.at_ns - last.at_ns) / S
        shown = driven_on(last.pose, last.speed, last.turn, elapsed_s) if reckons else last.pose
        errors.append(math.dist(truth.pose[:2], shown[:2]))
    stamps = [truth.received_ns for truth in truths]
    lasted = [after - before for before, after in itertools.pairwise(stamps)]
    squares = sum(error * error * ns for error, ns in zip(errors, lasted, strict=False))
    return math.sqrt(squares / sum(lasted)), max(errors)


PATROL = recorded("/odom", ODOMETRY, 20, 20, waits_and_turns)


@pytest.fixture
def curves(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> Callable[..., list[dict[str, Any]]]:
    def measured(*options: str) -> list[dict[str, Any]]:
        write_bag(tmp_path / "patrol", PATROL)
        assert main(["bag", "loss", str(tmp_path / "patrol"), *options, "--json"]) == 0
        found: list[dict[str, Any]] = json.loads(capsys.readouterr().out)["accuracy"]
        return found

    return measured


@pytest.mark.parametrize("receiver", ["hold", "reckoned"])
def test_messages_and_errors_are_those_of_replays(
    curves: Callable[..., list[dict[str, Any]]], tmp_path: Path, receiver: str
) -> None:
    """Those that replays under the bound and at the fixed rate pass; a naive receiver of them errs so."""
    position, _ = curves()
    assert [point["bound"] for point in position["points"]] == [0.01, 0.02, 0.05, 0.1, 0.2]
    reckons = receiver == "reckoned"
    for number, point in enumerate(position["points"][::3]):
        told = point[receiver]
        for arm, rules in (
            (told, f"SetFrequency /odom Full KeepWithin /odom position {point['bound']}"),
            (told["fixed"], f"SetFrequency /odom {told['fixed']['hz']:.12f}"),
        ):
            folder = tmp_path / f"{number}-{len(rules)}-{receiver}"
            folder.mkdir()
            predict = frozenset({"/odom"} if reckons and "Within" in rules else ())
            relayed = replay_content(PATROL, rules, folder, predict=predict).on("/odom")
            # What is still held at the end goes out after it, which no receiver within the recording sees.
            received = [one for one in relayed if one.stamp_ns <= PATROL.messages[-1].stamp_ns]
            rmse, worst = naive_error(PATROL.messages, received, reckons=reckons)
            assert arm["messages"] == len(received)
            assert arm["rmse"] == pytest.approx(rmse, rel=1e-6, abs=1e-9)
            assert arm["worst"] == pytest.approx(worst, rel=1e-6, abs=1e-9)
            assert arm["unknown"] == 0
        assert told["worst"] <= point["bound"]
        assert abs(told["messages"] - told["fixed"]["messages"]) <= 1


def test_the_gain_beforehand_is_mean_over_largest_speed(
    curves: Callable[..., list[dict[str, Any]]],
) -> None:
    """It waits for 4 of 19.95 s, and drives at 0.5 m/s else; chords are a little shorter than arcs."""
    position, orientation = curves()
    assert (position["topic"], position["property"], position["unit"]) == ("/odom", "position", "m")
    assert position["max_per_s"] == pytest.approx(0.5, rel=1e-3)
    assert position["mean_over_max"] == pytest.approx(15.95 / 19.95, rel=1e-3)
    assert orientation["max_per_s"] == pytest.approx(math.degrees(0.8), rel=1e-6)


def test_fields_that_are_asked_for_have_accuracies_of_their_own(
    curves: Callable[..., list[dict[str, Any]]],
) -> None:
    pose_x, yaw_rate = curves("--field", "/odom", "pose_x", "yaw_rate")
    assert [point["bound"] for point in pose_x["points"]] == [0.01, 0.02, 0.05, 0.1, 0.2]
    # ±0.8 rad/s have a range of 1.6.
    assert [point["bound"] for point in yaw_rate["points"]] == pytest.approx([0.016, 0.032, 0.08, 0.16, 0.32])
    # It changes nine times, and a message in 2 s passes anyway.
    assert {point["hold"]["messages"] for point in yaw_rate["points"]} <= set(range(9, 22))


def test_of_frames_the_fixed_rate_has_as_many_messages(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    """Two broadcasters: at a rate for each frame, twice as many messages would pass."""
    base = recorded("/tf", TRANSFORMS, 20, 20, lambda at, t: transforms(at, {"base": planar(t, 0, 0)}))
    arm = tuple(
        BagMessage("/tf", one.stamp_ns + S // 100, transforms(one.stamp_ns, {"arm": planar(0, t / 40, 0)}))
        for t, one in enumerate(base.messages)
    )
    both = sorted((*base.messages, *arm), key=lambda one: one.stamp_ns)
    write_bag(tmp_path / "tf", type(base)(base.topics, tuple(both)))
    assert main(["bag", "loss", str(tmp_path / "tf"), "--json"]) == 0
    position, *_ = json.loads(capsys.readouterr().out)["accuracy"]
    assert position["part"] == "base"
    for point in position["points"]:
        hold = point["hold"]
        assert hold["fixed"]["messages"] == pytest.approx(hold["messages"], rel=0.02, abs=2)


@settings(max_examples=50)
@given(
    st.lists(st.tuples(st.integers(1, S), st.integers(-50, 50)), min_size=2, max_size=40),
    st.sampled_from([0.0, 1.0, 7.0]),
)
def test_a_bound_is_never_broken_by_its_own_pacing(steps: list[tuple[int, int]], bound: float) -> None:
    class Message:
        def __init__(self, data: float) -> None:
            self.data = data

    gauges = gauges_for("std_msgs/msg/Float64", ["data"])
    arms = [
        Arm(Estimate(gauges, reckons=False), "data", StreamKind.VOLATILE, strategy)
        for strategy in (Strategy(reckons=False, bound=bound), Strategy(reckons=False))
    ]
    now_ns = 0
    for step_ns, value in steps:
        now_ns += step_ns
        readings = tuple(gauge.read(b"", Message(value), now_ns) for gauge in gauges)
        for arm in arms:
            arm.send(Sent(now_ns, readings))
    within, everything = (arm.finish(now_ns) for arm in arms)
    assert (within.worst <= bound, within.unknown) == (True, 0)
    assert (everything.messages, everything.rmse, everything.worst) == (len(steps), 0, 0)
    assert within.rmse <= within.worst
