# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""What a bound of the picture costs, beside a check that reads a field of the same topic.

Run it with ``python benchmarks/bound_cost.py`` where ROS 2 is installed; it takes a minute. Of each case, two
runtimes hear the same source at the same time and pass about as many of its messages: one because a rule
bounds the picture, the other by a rate, while a check reads a field of every message. Their CPU in the same
window, by message of the source, makes the ratio; whatever else the machine does, both share it.
"""

from __future__ import annotations

import argparse
import math
import statistics
import sys
import tempfile
import threading
import time
from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import rclpy

from live.contenders import TESTUDO
from live.processes import Process, cpu_us_a_message, environment, processes
from live.roles import answers, message_class

DOMAIN = 72
SETTLE_S = 4.0
TIMEOUT_S = 60.0
SPEED_M_PER_S = 0.5
TURN_RAD_PER_S = 0.2
JOINT_RAD_PER_S = 0.5
"""What passes of these within the bounds below is about 10 messages a second."""


@dataclass(frozen=True, kw_only=True)
class Case:
    """``bound`` and ``check`` are the rules of the two runtimes, of one topic."""

    topic: str
    type_name: str
    bound: str
    check: str


CASES = {
    "Odometry, position": Case(
        topic="/odom",
        type_name="nav_msgs/msg/Odometry",
        bound="SetFrequency /odom Full KeepWithin /odom position 0.05",
        check="SetFrequency /odom 10 If CheckValue /odom pose_x > 1000 Then SetFrequency /odom 20 EndIf",
    ),
    "Odometry, position and orientation": Case(
        topic="/odom",
        type_name="nav_msgs/msg/Odometry",
        bound="SetFrequency /odom Full KeepWithin /odom position 0.05 KeepWithin /odom orientation 2",
        check="SetFrequency /odom 10 If CheckValue /odom pose_x > 1000 Then SetFrequency /odom 20 EndIf",
    ),
    "JointState with 12 joints, positions": Case(
        topic="/joint_states",
        type_name="sensor_msgs/msg/JointState",
        bound="SetFrequency /joint_states Full KeepWithin /joint_states positions 0.05",
        check="SetFrequency /joint_states 10 "
        "If CheckValue /joint_states position[0] > 1000 Then SetFrequency /joint_states 20 EndIf",
    ),
}


def write(message: Any, elapsed_s: float) -> None:
    """Move what the message tells of."""
    seconds, nanoseconds = divmod(time.time_ns(), 1_000_000_000)
    message.header.stamp.sec, message.header.stamp.nanosec = seconds, nanoseconds
    if hasattr(message, "position"):
        message.name = [f"joint_{number}" for number in range(12)]
        message.position = [math.sin(number) + JOINT_RAD_PER_S * elapsed_s for number in range(12)]
        message.velocity = [JOINT_RAD_PER_S] * 12
        return
    message.header.frame_id, message.child_frame_id = "odom", "base_footprint"
    angle, radius = TURN_RAD_PER_S * elapsed_s, SPEED_M_PER_S / TURN_RAD_PER_S
    pose, twist = message.pose.pose, message.twist.twist
    pose.position.x, pose.position.y = radius * math.sin(angle), radius * (1 - math.cos(angle))
    pose.orientation.z, pose.orientation.w = math.sin(angle / 2), math.cos(angle / 2)
    twist.linear.x, twist.angular.z = SPEED_M_PER_S, TURN_RAD_PER_S


@contextmanager
def asked_node(name: str, answer: Any) -> Iterator[tuple[Any, threading.Event]]:
    """A node of a process that answers every line on stdin; the event is set when stdin ends."""
    rclpy.init()
    yield rclpy.create_node(name), answers(lambda _: answer())


def source(topic: str, type_name: str, hz: float) -> None:
    """Publish a moving robot; answers how many messages were sent."""
    sent = 0
    with asked_node("source", lambda: sent) as (node, ended):
        message = message_class({"type": type_name})()
        publisher = node.create_publisher(type(message), topic, 10)
        start_s = time.monotonic()
        while not ended.wait(max(start_s + sent / hz - time.monotonic(), 0)):
            write(message, time.monotonic() - start_s)
            publisher.publish(message)
            sent += 1


def operator(topic: str, type_name: str) -> None:
    """Hear what both runtimes relay; answers how many messages came of each."""
    heard = {"bound": 0, "check": 0}

    def note(name: str) -> None:
        heard[name] += 1

    with asked_node("operator", lambda: heard) as (node, ended):
        kept = [
            node.create_subscription(
                message_class({"type": type_name}),
                f"/{name}{topic}",
                lambda _, name=name: note(name),
                10,
                raw=True,
            )
            for name in heard
        ]
        while not ended.is_set():
            rclpy.spin_once(node, timeout_sec=0.1)
        del kept


def runtime(name: str, rules: str, folder: Path, options: list[str]) -> list[str]:
    """The command of a runtime with these rules, of that name."""
    path = folder / f"{name}.adirf"
    path.write_text(f"begin {rules} end", encoding="utf-8")
    arguments = ["run", "--rules", str(path), "--output-topic", f"/{name}{{topic}}", *options]
    return [sys.executable, "-c", TESTUDO, *arguments, "--ros-args", "-r", f"__node:={name}"]


def measure(case: Case, arguments: argparse.Namespace) -> None:
    """Print what both cost in each window, and the ratio of their medians."""
    options = ["--data-path", arguments.data_path]
    with tempfile.TemporaryDirectory() as name:
        folder = Path(name)
        roles = [
            [sys.executable, __file__, "--role", "source", case.topic, case.type_name, str(arguments.hz)],
            [sys.executable, __file__, "--role", "operator", case.topic, case.type_name],
            runtime("bound", case.bound, folder, options),
            runtime("check", case.check, folder, options),
        ]
        with processes(roles, environment(arguments.domain, large_messages=False)) as started:
            sender, hearer, *runtimes = started
            wait_until_heard(hearer)
            time.sleep(SETTLE_S)
            costs_us = [
                cpu_us_a_message(sender, runtimes, arguments.seconds) for _ in range(arguments.windows)
            ]
            heard = hearer.ask("heard")
    bound_us, check_us = (statistics.median(costs) for costs in zip(*costs_us, strict=True))
    ratios = [f"{bound / check:.2f}" for bound, check in costs_us]
    passed = ", ".join(f"{count} with the {name}" for name, count in heard.items())
    print(f"  bound {bound_us:.0f} µs, check {check_us:.0f} µs of CPU a message: {bound_us / check_us:.2f} ×")
    print(f"  by window {', '.join(ratios)}; passed {passed}", flush=True)


def wait_until_heard(hearer: Process) -> None:
    """Return when both runtimes relay. Raises ``SystemExit`` where they do not."""
    end_s = time.monotonic() + TIMEOUT_S
    while not all(hearer.ask("heard").values()):
        if time.monotonic() > end_s:
            raise SystemExit("nothing is relayed")
        time.sleep(0.2)


def main() -> None:
    """Measure all cases."""
    parser = argparse.ArgumentParser(description="What a bound of the picture costs.")
    parser.add_argument("--case", default="", help="only cases whose name holds this text")
    parser.add_argument("--hz", type=float, default=100.0, help="rate of the source")
    parser.add_argument("--seconds", type=float, default=3.0, help="length of each window")
    parser.add_argument("--windows", type=int, default=5)
    parser.add_argument("--data-path", default="auto", help="as of 'testudo run'")
    parser.add_argument("--domain", type=int, default=DOMAIN, help="a ROS domain that nobody uses")
    parser.add_argument("--role", nargs="+", help=argparse.SUPPRESS)
    arguments = parser.parse_args()
    if arguments.role:
        role, topic, type_name, *hz = arguments.role
        source(topic, type_name, float(hz[0])) if role == "source" else operator(topic, type_name)
        return
    load = Path("/proc/loadavg").read_text(encoding="ascii").split()[0]
    print(f"source at {arguments.hz:g} Hz, load of the machine at the start {load}")
    for name, case in CASES.items():
        if arguments.case in name:
            print(name, flush=True)
            measure(case, arguments)


if __name__ == "__main__":
    main()
