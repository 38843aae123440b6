# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""``testudo run --link`` on a robot and ``testudo receive`` at its operator's, each in its own ROS domain."""

from __future__ import annotations

import json
import re
import signal
import sys
import time
from pathlib import Path
from typing import Any

import pytest

from link.zenoh.ends import robot_end
from ros.calm_window import Arrival, calm_window
from ros.ros_processes import LINE_TIMEOUT_S, TESTUDO, Process, SmallRobot, told_apart
from ros.test_telling import diagnostics_when
from smarttestudo.domain.link import StreamInfo
from smarttestudo.domain.robot import DataPathKind, Qos
from smarttestudo.robot.ros import open_robot
from smarttestudo.robot.ros.message_types import is_installed

IMU = "sensor_msgs/msg/Imu"
ODOMETRY = "nav_msgs/msg/Odometry"
EXAMPLES = Path(__file__).parents[2] / "examples"
TEXT = "std_msgs/msg/String"
RULES = "begin SetFrequency /imu Full SetFrequency /odom 10 SetFrequency /names Full end"
SOURCES: dict[str, Any] = {
    "imu": {"type": IMU, "hz": 50},
    "odom": {"type": ODOMETRY, "hz": 50, "reliable": False},
    "names": {"type": TEXT, "texts": ["hall", "yard"]},
}
NAMES: dict[str, Any] = {
    "type": TEXT,
    "topic": "/names",
    "transient_local": True,
    "values": ["hall", "yard"],
}
# Without rclpy, and on a terminal, on which Ctrl-C is typed.
WITHOUT_ROS = f"import sys; sys.modules['rclpy'] = None; {TESTUDO}"
ON_A_TERMINAL = "import os, pty, sys; sys.exit(os.waitstatus_to_exitcode(pty.spawn(sys.argv[1:])))"
CTRL_C = "\x03"
PROCESS = re.compile(r"_\d+$")
TARGETS_HZ = {"imu": 20, "odom": 8}
SPAN_S = 5.0
RUN_S = 8.0
# Of about so many seconds.
LAST = {name: round(RUN_S * rate_hz) for name, rate_hz in TARGETS_HZ.items()}
ATTEMPTS = 15
# Longer than a test waits: it ends because all was heard.
ENDLESS_S = "3600"


def linked_runtime(robot: SmallRobot, endpoint: str, *arguments: str, rules: str = RULES) -> Process:
    return robot.runtime(rules, "--link", endpoint, "--robot", "tb3", *arguments)


def endpoints(
    topic: str, publishers: int, domain: int, monkeypatch: pytest.MonkeyPatch
) -> set[tuple[str, str, bool, bool]]:
    """Node, type and QoS of those who publish a topic in a domain, once so many of them are known."""
    monkeypatch.setenv("ROS_DOMAIN_ID", str(domain))
    monkeypatch.setenv("ROS_AUTOMATIC_DISCOVERY_RANGE", "LOCALHOST")
    end_s = time.monotonic() + LINE_TIMEOUT_S
    with open_robot(name="onlooker", data_path=DataPathKind.RCLPY) as node:
        while (
            len(known := [one for one in node.publishers(topic) if "UNKNOWN" not in one.node]) != publishers
        ):
            assert time.monotonic() < end_s, f"{topic} has the publishers {known}"
            node.wait(None, 0.1)
    return {(PROCESS.sub("", one.node), one.type_name, one.reliable, one.transient_local) for one in known}


def mean_hz(arrivals: list[Arrival]) -> float:
    return (len(arrivals) - 1) / (arrivals[-1].at_s - arrivals[0].at_s)


def values(station: Process, name: str) -> list[str]:
    return [value for _, value, _ in station.result("go on")[name]]


@pytest.mark.contract
def test_what_arrives_is_byte_for_byte_what_the_robot_published(
    robot: SmallRobot, operators: SmallRobot, endpoint: str
) -> None:
    raw = {"type": IMU, "topic": "/imu", "raw": True, "reliable": True, "messages": 50}
    operators.receiver(endpoint)
    there = operators.operator(imu=raw)
    linked_runtime(robot, endpoint)
    here = robot.operator(imu=raw)
    robot.source(**SOURCES)
    # The robot's own subscriber may have found the source later than the runtime did.
    arrived: list[str] = []
    published: set[str] = set()
    end_s = time.monotonic() + LINE_TIMEOUT_S
    while len(arrived) < 10 or not published >= set(arrived):
        assert time.monotonic() < end_s, f"{len(set(arrived) - published)} messages were never published"
        there.line_with("heard")
        received = values(there, "imu")
        here.line_with("heard")
        published = set(values(here, "imu"))
        known = [place for place, value in enumerate(received) if value in published]
        arrived = received[known[0] :] if known else []
    assert len(set(arrived)) == len(arrived), "stamps tell messages apart"


def test_rules_that_are_broken_at_the_start_send_what_can_be_read_of_them_until_they_are_mended(
    robot: SmallRobot, operators: SmallRobot, endpoint: str
) -> None:
    operators.receiver(endpoint)
    there = operators.operator(imu={"type": IMU, "topic": "/imu"})
    robot.source(**SOURCES)
    path = robot.rule_file("begin SetFrequency /odom 5 SetFrequency /imu Off If CheckValue end")
    runtime = robot.testudo_run("--rules", path, "--link", endpoint, "--robot", "tb3")
    for rate in ("/imu: 1 Hz", "/names: 1 Hz", "/odom: 5 Hz"):
        runtime.line_with(f"{rate} (fallback)")
    there.line_with("heard")
    Path(path).write_text("begin SetFrequency /imu 20 end", encoding="utf-8")
    runtime.line_with("/imu: 1 Hz → 20 Hz (reload)")


@pytest.mark.usefixtures("test_msgs")
def test_hidden_topics_of_actions_and_services_that_rules_name_arrive_too(
    robot: SmallRobot, operators: SmallRobot, endpoint: str
) -> None:
    # Events of services are of Iron and later.
    kinds = {
        "go/_action/feedback": "test_msgs/action/Fibonacci_FeedbackMessage",
        "go/_action/status": "action_msgs/msg/GoalStatusArray",
        "switch/_service_event": "std_srvs/srv/SetBool_Event",
    }
    known = {name: kind for name, kind in kinds.items() if is_installed(kind)}
    sources: dict[str, Any] = {name: {"type": kind, "hz": 20} for name, kind in known.items()}
    arrived: dict[str, Any] = {name: {"type": kind, "topic": f"/{name}"} for name, kind in known.items()}
    rules = "\n".join(f"SetFrequency /{name} 10" for name in known)
    operators.receiver(endpoint)
    there = operators.operator(**arrived)
    linked_runtime(robot, endpoint, rules=f"begin {rules} end")
    robot.source(**sources)
    there.line_with("heard")


@told_apart
def test_publishers_stay_apart_with_type_and_qos_and_a_late_subscriber_gets_what_each_latched(
    robot: SmallRobot,
    operators: SmallRobot,
    other_domain: int,
    endpoint: str,
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    linked_runtime(robot, endpoint)
    robot.source(**SOURCES)
    operators.receiver(endpoint)
    node = "/testudo_receive"
    assert endpoints("/names", 2, other_domain, monkeypatch) == {(node, TEXT, True, True)}
    assert endpoints("/imu", 1, other_domain, monkeypatch) == {(node, IMU, True, False)}
    assert endpoints("/odom", 1, other_domain, monkeypatch) == {(node, ODOMETRY, False, False)}
    late = operators.operator(names=NAMES)
    late.line_with("heard")
    assert sorted(values(late, "names")) == ["hall", "yard"]


@told_apart
def test_what_a_node_latched_before_it_was_restarted_is_given_to_nobody_at_the_operator(
    robot: SmallRobot, operators: SmallRobot, endpoint: str
) -> None:
    operators.receiver(endpoint)
    linked_runtime(robot, endpoint)
    for text in ("hall", "yard"):
        source = robot.source(names={"type": TEXT, "texts": [text]})
        # One notes what comes, another one comes later.
        for _ in range(2):
            late = operators.operator(names={**NAMES, "values": [text]})
            late.line_with("heard")
        assert values(late, "names") == [text]
        source.signal(signal.SIGINT)
        source.exit_code()


@pytest.mark.calm
def test_the_rates_at_the_operator_are_those_of_the_rules(
    robot: SmallRobot, operators: SmallRobot, endpoint: str
) -> None:
    operators.receiver(endpoint)
    station = operators.operator(
        span_s=RUN_S, imu={"type": IMU, "topic": "/imu"}, odom={"type": ODOMETRY, "topic": "/odom"}
    )
    linked_runtime(robot, endpoint, rules="begin SetFrequency /imu 20 SetFrequency /odom 8 end")
    robot.source(imu={"type": IMU, "hz": 50}, odom={"type": ODOMETRY, "hz": 30})
    seen = []
    for attempt in range(1, ATTEMPTS + 1):
        station.line_with(f"heard {attempt}")
        arrivals = {name: [Arrival(*one) for one in all_] for name, all_ in station.result("go on").items()}
        # While a process stands still, newer messages replace those that wait, and are not late.
        window = calm_window({name: all_[-LAST[name] :] for name, all_ in arrivals.items()}, SPAN_S)
        if window is None:
            continue
        seen.append({name: mean_hz(inside) for name, inside in window.items()})
        assert all(rate_hz <= 1.02 * TARGETS_HZ[name] for name, rate_hz in seen[-1].items())
        if seen[-1] == pytest.approx(TARGETS_HZ, rel=0.02):
            return
    pytest.fail(f"in no five seconds were these the rates: {seen}")


@pytest.mark.contract
def test_an_operator_s_top_shows_the_status_of_the_robot(
    robot: SmallRobot, operators: SmallRobot, endpoint: str
) -> None:
    operators.receiver(endpoint)
    linked_runtime(robot, endpoint)
    robot.source(**SOURCES)
    operators.operator(imu={"type": IMU, "topic": "/imu"}).line_with("heard")
    top = operators.testudo("top", "--once", "--json", "--timeout", ENDLESS_S)
    assert top.exit_code() == 0
    nodes = json.loads("".join(top.output))["nodes"]
    assert nodes.keys() == {"tb3:/smarttestudo"}
    assert nodes["tb3:/smarttestudo"]["topics"].keys() == {"/imu", "/odom", "/names"}


def test_the_robot_s_own_graph_gets_nothing_of_what_goes_over_the_link(
    robot: SmallRobot,
    operators: SmallRobot,
    domain: int,
    endpoint: str,
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    operators.receiver(endpoint)
    linked_runtime(robot, endpoint)
    robot.source(**SOURCES)
    here = robot.operator(imu={"type": IMU, "topic": "/imu"})
    operators.operator(imu={"type": IMU, "topic": "/imu"}).line_with("heard")
    assert endpoints("/imu", 1, domain, monkeypatch) == {("/source", IMU, True, False)}
    assert not any(
        topic.startswith("/testudo") for topic in here.topics() - {"/testudo/decisions", "/testudo/status"}
    )


def test_with_an_output_topic_both_graphs_get_it(
    robot: SmallRobot, operators: SmallRobot, endpoint: str
) -> None:
    operators.receiver(endpoint)
    linked_runtime(robot, endpoint, "--output-topic", "/op{topic}")
    robot.source(**SOURCES)
    for side in (robot, operators):
        side.operator(imu={"type": IMU, "topic": "/op/imu"}).line_with("heard")


def test_an_operator_s_end_that_was_killed_gets_everything_again_when_it_is_back(
    robot: SmallRobot, operators: SmallRobot, endpoint: str
) -> None:
    runtime = linked_runtime(robot, endpoint)
    robot.source(**SOURCES)
    topics: dict[str, Any] = {"imu": {"type": IMU, "topic": "/imu", "messages": 10}, "names": NAMES}
    for _ in range(2):
        receiving = operators.receiver(endpoint)
        operators.operator(**topics).line_with("heard")
        receiving.signal(signal.SIGKILL)
        assert receiving.exit_code() == -signal.SIGKILL
    runtime.signal(signal.SIGINT)
    assert runtime.exit_code() == 0


@pytest.mark.contract
def test_without_ros_a_laptop_records_and_shows_what_arrives_until_ctrl_c(
    robot: SmallRobot, operators: SmallRobot, endpoint: str
) -> None:
    folder = operators.folder / "recorded"
    receive = ["receive", "--no-ros", "--record", str(folder), "--listen", endpoint]
    laptop = [sys.executable, "-c", WITHOUT_ROS]
    receiving = operators.command(sys.executable, "-c", ON_A_TERMINAL, *laptop, *receive)
    linked_runtime(robot, endpoint)
    robot.source(**SOURCES)
    receiving.line_with("tb3 ")
    for topic, messages in (("/imu", 10), ("/names", 2)):
        while int(receiving.line_with(f"{topic} ").split()[4]) < messages:
            pass
    receiving.say(CTRL_C)
    assert receiving.exit_code() == 0
    info = operators.command(*laptop, "bag", "info", str(folder / "tb3"), "--json")
    assert info.exit_code() == 0
    topics = json.loads("".join(info.output))["topics"]
    assert topics.keys() >= {"/imu", "/names"}
    assert topics["/imu"]["messages"] >= 10


def test_the_robots_own_diagnostics_say_whether_an_operator_is_connected_and_how_topics_do(
    robot: SmallRobot, operators: SmallRobot, endpoint: str
) -> None:
    listener = robot.diagnostics()
    linked_runtime(robot, endpoint)
    robot.source(**SOURCES)
    alone = diagnostics_when(listener, lambda statuses: "smarttestudo" in statuses)["smarttestudo"]
    assert (alone["level"], alone["message"]) == (1, "no operator is connected over the link")
    operators.receiver(endpoint)

    def has_aged(statuses: dict[str, Any]) -> bool:
        return bool(statuses["/imu"]["values"].get("link_age_ms", "N/A") != "N/A")

    statuses = diagnostics_when(listener, has_aged)
    assert statuses["smarttestudo"]["values"]["link_connected"] == "true"
    assert int(statuses["/imu"]["values"]["link_sent"]) > 0
    assert statuses["/imu"]["values"]["link_overflowed"] == "0"


def test_the_robots_diagnostics_are_relayed_while_its_own_graph_gets_those_of_the_relay(
    robot: SmallRobot, operators: SmallRobot, endpoint: str
) -> None:
    listener = robot.diagnostics()
    linked_runtime(robot, endpoint, rules=(EXAMPLES / "failing_sensor.adirf").read_text())
    robot.source(diagnostics={"type": "diagnostic_msgs/msg/DiagnosticArray", "hz": 10})
    diagnostics_when(listener, lambda statuses: "smarttestudo" in statuses)
    operators.receiver(endpoint)
    there = {"type": "diagnostic_msgs/msg/DiagnosticArray", "topic": "/diagnostics", "messages": 3}
    operators.operator(diagnostics=there).line_with("heard")


def test_a_topic_whose_name_is_too_long_at_the_operators_costs_itself_alone(
    robot: SmallRobot, operators: SmallRobot, endpoint: str
) -> None:
    long = "a" * 243
    receiving = operators.receiver(endpoint, "--output-topic", "/{robot}{topic}")
    linked_runtime(robot, endpoint, rules=f"begin SetFrequency /imu Full SetFrequency /{long} Full end")
    robot.source(**{long: {"type": IMU, "hz": 50}, "imu": {"type": IMU, "hz": 50}})
    receiving.line_with(f"/{long}: error: its name here would have 248 letters, and ROS 2 takes 247")
    operators.operator(imu={"type": IMU, "topic": "/tb3/imu"}).line_with("heard")


def test_a_topic_that_a_namesake_has_otherwise_is_the_robots_again_once_that_is_gone(
    robot: SmallRobot, operators: SmallRobot, endpoint: str
) -> None:
    receiving = operators.receiver(endpoint)
    other = StreamInfo(topic="/imu", type_name=TEXT, qos=Qos(reliable=True, transient_local=False))
    station = operators.operator(imu={"type": IMU, "topic": "/imu"})
    with robot_end(endpoint, "tb3", lambda _: None) as namesake:
        namesake.advertise(other)
        receiving.line_with("tb3: sends /imu (std_msgs/msg/String)")
        linked_runtime(robot, endpoint)
        robot.source(**SOURCES)
        receiving.line_with(
            "tb3: a second robot of this name sends /imu as sensor_msgs/msg/Imu, not std_msgs"
        )
    receiving.line_with("tb3: /imu is sensor_msgs/msg/Imu now, not std_msgs/msg/String")
    station.line_with("heard")
    with robot_end(endpoint, "tb3", lambda _: None) as namesake:
        namesake.advertise(other)
        receiving.line_with(
            "tb3: a second robot of this name sends /imu as std_msgs/msg/String, not sensor_msgs"
        )
        heard = len(values(station, "imu"))
        station.line_with(f"heard {heard + 20}")


def test_an_operators_end_on_the_robots_own_graph_feeds_nothing_back(
    robot: SmallRobot, endpoint: str
) -> None:
    robot.receiver(endpoint, "--output-topic", "/op{topic}")
    runtime = robot.testudo_run("--link", endpoint, "--robot", "tb3")
    robot.source(**SOURCES)
    runtime.line_with(
        "publishes what this robot sends on the robot's own ROS graph; that is not relayed again"
    )
    there = robot.operator(imu={"type": IMU, "topic": "/op/imu", "messages": 100})
    there.line_with("heard")
    # Nodes may be discovered later than their topics, which are given up then.
    end_s = time.monotonic() + LINE_TIMEOUT_S
    while again := {topic for topic in there.topics() if topic.startswith("/op/op")}:
        assert time.monotonic() < end_s, again


@pytest.mark.parametrize("number", [signal.SIGINT, signal.SIGTERM])
def test_a_signal_ends_both_ends_cleanly(
    robot: SmallRobot, operators: SmallRobot, endpoint: str, number: signal.Signals
) -> None:
    receiving = operators.receiver(endpoint)
    runtime = linked_runtime(robot, endpoint)
    robot.source(**SOURCES)
    operators.operator(imu={"type": IMU, "topic": "/imu"}).line_with("heard")
    for process in (runtime, receiving):
        process.signal(number)
        assert process.exit_code() == 0
        assert not [line for line in process.output if "Traceback" in line or "error" in line]
