# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""The graph is looked at when it changes, and seldom while it does not."""

from __future__ import annotations

import time
from collections.abc import Callable, Iterator

import pytest

from smarttestudo.domain.robot import DataPathKind, GraphChange, OutputDomain, Qos, Robot
from smarttestudo.robot.ros import open_robot, real_timers
from smarttestudo.robot.ros.rcl import path
from smarttestudo.robot.ros.real_timers import GraphPolls, RealTimers

TIMEOUT_S = 120.0
QUIET_S = 2.0
TEXT = "std_msgs/msg/String"
PLAIN = Qos(reliable=True, transient_local=False)


class Looks:
    """Looks in virtual time, with what was known of the graph at each."""

    def __init__(self, *, is_told: bool) -> None:
        self.is_told = is_told
        self.now_s = 0.0
        self.seen: list[GraphChange] = []
        self._timers = RealTimers()
        self.looks = GraphPolls(self._timers, self.seen.append, lambda: self.is_told, lambda: self.now_s)

    def during(self, seconds: float) -> list[GraphChange]:
        """The looks of so many seconds."""
        self.seen.clear()
        end_s = self.now_s + seconds
        while self._timers.due_s <= end_s:
            self.now_s = self._timers.due_s
            self._timers.act(self.now_s)
        self.now_s = end_s
        return [*self.seen]


def test_a_quiet_graph_is_looked_at_once_a_second() -> None:
    looks = Looks(is_told=True)
    looks.during(1.0)
    assert looks.during(60.0) == [GraphChange.NONE] * 60


def test_a_graph_that_nobody_tells_of_is_looked_at_five_times_a_second() -> None:
    looks = Looks(is_told=False)
    assert looks.during(10.1) == [GraphChange.UNREPORTED] * 51


def test_a_graph_is_looked_at_at_once() -> None:
    assert Looks(is_told=True).during(0.0) == [GraphChange.NONE]


def test_when_changes_are_told_no_more_it_is_looked_at_five_times_a_second_again() -> None:
    looks = Looks(is_told=True)
    looks.during(10.5)
    looks.is_told = False
    looks.looks.changed()
    assert looks.during(10.1) == [GraphChange.REPORTED] + [GraphChange.UNREPORTED] * 50


def test_a_change_is_looked_at_without_delay() -> None:
    looks = Looks(is_told=True)
    looks.during(10.5)
    looks.looks.changed()
    assert looks.during(0.0) == [GraphChange.REPORTED]


def test_changes_one_after_the_other_are_looked_at_five_times_a_second_at_most_and_the_last_one_too() -> None:
    looks = Looks(is_told=True)
    looks.during(10.5)
    seen: list[GraphChange] = []
    for _ in range(100):
        looks.looks.changed()
        seen += looks.during(0.01)
    seen += looks.during(0.3)
    assert seen == [GraphChange.REPORTED] * 6


@pytest.fixture(params=[DataPathKind.RCL])
def robot(
    request: pytest.FixtureRequest, in_domain: None, monkeypatch: pytest.MonkeyPatch
) -> Iterator[Robot]:
    """A robot that looks at its graph only when that is told to have changed, wherever changes are told."""
    monkeypatch.setattr(real_timers, "NET_PERIOD_S", 10 * TIMEOUT_S)
    with open_robot(data_path=request.param) as opened:
        yield opened


def ends_of_words(robot: Robot) -> tuple[int, int]:
    """How many publishers and subscribers of /words there are."""
    return robot.publisher_count("/words"), robot.subscriber_count("/words")


def wait_until(robot: Robot, condition: Callable[[], bool]) -> None:
    end_s = time.monotonic() + TIMEOUT_S
    while not condition():
        assert time.monotonic() < end_s, f"nothing came in time; now there are {ends_of_words(robot)}"
        robot.wait(None, 0.1)


def wait_for_quiet(robot: Robot, looks: list[GraphChange]) -> None:
    """Wait until nothing was looked at for some seconds."""
    count, since_s = len(looks), time.monotonic()

    def is_quiet() -> bool:
        nonlocal count, since_s
        if len(looks) != count:
            count, since_s = len(looks), time.monotonic()
        return time.monotonic() >= since_s + QUIET_S

    wait_until(robot, is_quiet)


@pytest.mark.calm
def test_publishers_and_subscribers_that_come_and_go_are_looked_at_and_nothing_else_is(robot: Robot) -> None:
    looks: list[GraphChange] = []
    counts: list[tuple[int, int]] = []

    def look(graph: GraphChange) -> None:
        looks.append(graph)
        counts.append(ends_of_words(robot))

    robot.poll_graph(look)
    wait_for_quiet(robot, looks)
    with open_robot(name="other") as other:
        publisher = other.data_path.advertise("/words", TEXT, PLAIN)
        wait_until(robot, lambda: counts[-1] == (1, 0))
        subscription = other.data_path.subscribe("/words", TEXT, PLAIN, lambda *_: None)
        wait_until(robot, lambda: counts[-1] == (1, 1))
        wait_for_quiet(robot, looks)
        publisher.close()
        wait_until(robot, lambda: counts[-1] == (0, 1))
        subscription.close()
        wait_until(robot, lambda: counts[-1] == (0, 0))
    told = [graph is GraphChange.REPORTED for graph in looks]
    assert all(told[1:]), "only the first look is not one at a change"


@pytest.mark.calm
@pytest.mark.usefixtures("robot")
def test_an_operator_in_another_domain_is_looked_at_when_it_comes(
    other_domain: int, monkeypatch: pytest.MonkeyPatch
) -> None:
    looks: list[GraphChange] = []
    counts: list[int] = []

    with open_robot(name="relay", output_domain=OutputDomain(number=other_domain)) as relay:

        def look(graph: GraphChange) -> None:
            looks.append(graph)
            counts.append(relay.subscriber_count("/words"))

        relay.poll_graph(look)
        wait_for_quiet(relay, looks)
        monkeypatch.setenv("ROS_DOMAIN_ID", str(other_domain))
        with open_robot(name="operator") as operator:
            operator.data_path.subscribe("/words", TEXT, PLAIN, lambda *_: None)
            wait_until(relay, lambda: counts[-1] == 1)


# Kilted's rclpy warns by a method that it has deprecated itself.
@pytest.mark.calm
@pytest.mark.filterwarnings("ignore:Deprecated in favor:DeprecationWarning")
def test_after_a_quiet_time_rclpy_warns_of_a_subscriber_that_an_output_does_not_suit(
    robot: Robot, monkeypatch: pytest.MonkeyPatch, capfd: pytest.CaptureFixture[str]
) -> None:
    monkeypatch.setattr(path, "WARNS_S", QUIET_S / 2)
    looks: list[GraphChange] = []
    robot.poll_graph(looks.append)
    robot.data_path.advertise("/words", TEXT, Qos(reliable=False, transient_local=False))
    wait_for_quiet(robot, looks)
    with open_robot(name="other") as other:
        other.data_path.subscribe("/words", TEXT, PLAIN, lambda *_: None)
        wait_until(robot, lambda: "'/words', requesting incompatible QoS" in capfd.readouterr().err)


@pytest.mark.parametrize("robot", [DataPathKind.RCLPY], indirect=True)
def test_through_rclpy_the_graph_is_looked_at_though_nobody_tells_of_changes(robot: Robot) -> None:
    looks: list[GraphChange] = []
    robot.poll_graph(looks.append)
    wait_until(robot, lambda: len(looks) >= 3)
    assert set(looks) == {GraphChange.UNREPORTED}


def test_where_librcl_does_not_tell_of_changes_it_says_why_and_the_graph_is_looked_at(
    domain: int, monkeypatch: pytest.MonkeyPatch
) -> None:
    rclpy_node = pytest.importorskip("rclpy.node", reason="ROS 2 (rclpy) is not installed")
    monkeypatch.setenv("ROS_DOMAIN_ID", str(domain))
    monkeypatch.setenv("ROS_AUTOMATIC_DISCOVERY_RANGE", "LOCALHOST")
    monkeypatch.delattr(rclpy_node.Node, "create_guard_condition")
    with open_robot(data_path=DataPathKind.RCL) as robot:
        said = robot.data_path.description
        assert said.startswith("librcl, ")
        assert "the graph checked five times a second because " in said
        assert "create_guard_condition" in said
        looks: list[GraphChange] = []
        robot.poll_graph(looks.append)
        wait_until(robot, lambda: len(looks) >= 3)
        assert set(looks) == {GraphChange.UNREPORTED}


@pytest.mark.usefixtures("in_domain")
def test_a_topic_of_dds_that_ros_lists_and_then_refuses_is_none(monkeypatch: pytest.MonkeyPatch) -> None:
    listed = [("/" + "a" * size, [TEXT]) for size in (5, 246, 247)] + [("/a b", [TEXT]), ("/1", [TEXT])]
    with open_robot(data_path=DataPathKind.RCLPY) as robot:
        # DDS itself takes such names, rclpy makes none.
        monkeypatch.setattr("rclpy.node.Node.get_topic_names_and_types", lambda _: listed)
        assert [len(name) for name in robot.topics()] == [6, 247]
        for name in robot.topics():
            robot.publishers(name)
