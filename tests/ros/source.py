# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""A robot's sources: publishes each topic on a schedule, which it catches up with after a stall.

usage: source.py '{"imu": {"type": "sensor_msgs/msg/Imu", "hz": 195, "reliable": true}, …}'
The stamp of a message, or the ``linear.y`` of a Twist, is the monotonic time at which it was due. An Odometry
is at ``x``, or drives from there with ``twist``, forward in m/s and around in rad/s; a Twist asks for that. A
String is numbered, and padded to ``size_bytes``. A Clock begins at ``from_s`` and goes on by ``step_ms`` with
each message.
A topic without ``hz`` is latched: ``texts`` are published once, each by a publisher of its own. ``topic`` is
the topic's name where it is not the key. One that comes ``later`` is there from ``create camera`` on.

Lines on stdin, about all topics or those named: ``move odom`` puts the robot at x = 5, ``home odom`` at 0;
``spoil odom`` sends bytes that are no message until ``heal odom``; ``hush odom`` sends no more, until
``speak odom``; ``halt odom`` has a robot that drives stand still, until ``drive odom``; ``press estop`` sends
true, and then no more; ``break diagnostics`` says ERROR, until ``mend diagnostics``; ``rewind clock`` begins
again at 0, ``skip clock`` leaves out an hour. ``stop`` ends it.
"""

from __future__ import annotations

import json
import math
import queue
import sys
import threading
import time
from typing import Any

import rclpy
from rclpy.qos import DurabilityPolicy, QoSProfile, ReliabilityPolicy
from std_msgs.msg import String

from smarttestudo.robot.ros.message_types import message_type

NS_PER_MS = 1_000_000
NS_PER_S = 1_000_000_000
NO_MESSAGE = b"\x00\x01\x00\x00\x01"
PLACES_M = {"move": 5.0, "home": 0.0}
FAULT_LEVELS = {"break": b"\x02", "mend": b"\x00"}


class Drive:
    """A robot that drives an arc, as an Odometry tells of it."""

    def __init__(self, forward: float, around: float) -> None:
        self.forward = forward
        self.around = around
        self.driven_s = 0.0
        self.is_on = True

    def go_on(self, message: Any, elapsed_s: float) -> None:
        self.driven_s += elapsed_s * self.is_on
        angle = self.around * self.driven_s
        pose, twist = message.pose.pose, message.twist.twist
        pose.position.x = self.forward / self.around * math.sin(angle)
        pose.position.y = self.forward / self.around * (1 - math.cos(angle))
        pose.orientation.z, pose.orientation.w = math.sin(angle / 2), math.cos(angle / 2)
        twist.linear.x, twist.angular.z = self.forward * self.is_on, self.around * self.is_on


class Stream:
    def __init__(self, node: Any, name: str, topic: dict[str, Any]) -> None:
        self.message = message_type(topic["type"], name)()
        self.publisher = node.create_publisher(
            type(self.message), f"/{topic.get('topic', name)}", qos_of(topic)
        )
        if is_odometry(self.message):
            self.message.pose.pose.position.x = topic.get("x", 0.0)
        if is_diagnostics(self.message):
            self.message.status = [message_type("diagnostic_msgs/msg/DiagnosticStatus", name)(name="lidar")]
        self.drive = None
        if "twist" in topic and hasattr(self.message, "linear"):
            self.message.linear.x, self.message.angular.z = topic["twist"]
        elif "twist" in topic:
            self.drive = Drive(*topic["twist"])
        self.usual_period_s = self.period_s = 1.0 / topic["hz"]
        self.clock_ns = topic.get("from_s", 0) * NS_PER_S
        self.text_bytes = topic.get("size_bytes", 0)
        self.step_ns = topic.get("step_ms", 0) * NS_PER_MS
        self.start_s = time.monotonic()
        self.sent = 0
        self.is_spoilt = False

    @property
    def due_s(self) -> float:
        return float(self.start_s + self.sent * self.period_s)

    def speak(self) -> None:
        self.period_s = self.usual_period_s
        self.start_s = time.monotonic() - self.sent * self.period_s

    def send(self) -> None:
        write_due(self.message, self.due_s)
        if self.drive is not None:
            self.drive.go_on(self.message, self.period_s)
        if isinstance(self.message, String):
            self.message.data = str(self.sent).ljust(self.text_bytes)
        if self.step_ns:
            self.clock_ns += self.step_ns
            self.message.clock.sec, self.message.clock.nanosec = divmod(self.clock_ns, NS_PER_S)
        self.sent += 1
        self.publisher.publish(NO_MESSAGE if self.is_spoilt else self.message)


def qos_of(topic: dict[str, Any]) -> QoSProfile:
    reliable, latched = topic.get("reliable", True), topic.get("transient_local", False)
    return QoSProfile(
        depth=10,
        reliability=ReliabilityPolicy.RELIABLE if reliable else ReliabilityPolicy.BEST_EFFORT,
        durability=DurabilityPolicy.TRANSIENT_LOCAL if latched else DurabilityPolicy.VOLATILE,
    )


def write_due(message: Any, due_s: float) -> None:
    if hasattr(message, "header"):
        stamp = message.header.stamp
        stamp.sec, stamp.nanosec = divmod(round(due_s * NS_PER_S), NS_PER_S)
    elif hasattr(message, "linear"):
        message.linear.y = due_s


def is_odometry(message: Any) -> bool:
    return hasattr(getattr(message, "pose", None), "pose")


def is_diagnostics(message: Any) -> bool:
    return hasattr(message, "status") and hasattr(message, "header")


def latch(node: Any, name: str, topic: dict[str, Any]) -> list[Any]:
    qos = QoSProfile(depth=1, durability=DurabilityPolicy.TRANSIENT_LOCAL)
    kind = message_type(topic["type"], name)
    publishers = [node.create_publisher(kind, f"/{name}", qos) for _ in topic["texts"]]
    for publisher, text in zip(publishers, topic["texts"], strict=True):
        publisher.publish(kind(data=text))
    return publishers


def obey(stream: Stream, command: str) -> None:
    if command in PLACES_M and is_odometry(stream.message):
        stream.message.pose.pose.position.x = PLACES_M[command]
    elif command in FAULT_LEVELS and is_diagnostics(stream.message):
        stream.message.status[0].level = FAULT_LEVELS[command]
    elif command == "hush":
        stream.period_s = math.inf
    elif command == "speak":
        stream.speak()
    elif command in {"halt", "drive"} and stream.drive is not None:
        stream.drive.is_on = command == "drive"
    elif command in {"spoil", "heal"}:
        stream.is_spoilt = command == "spoil"
    elif command == "press":
        stream.period_s = math.inf
        stream.publisher.publish(type(stream.message)(data=True))
    elif command == "rewind":
        stream.clock_ns = 0
    elif command == "skip":
        stream.clock_ns += 3600 * NS_PER_S


def listen(lines: queue.SimpleQueue[str]) -> None:
    for line in sys.stdin:
        lines.put(line)
    lines.put("stop")


def next_line(lines: queue.SimpleQueue[str], timeout_s: float) -> str | None:
    try:
        return lines.get(timeout=timeout_s)
    except queue.Empty:
        return None


def main() -> None:
    topics = json.loads(sys.argv[1])
    rclpy.init()
    node = rclpy.create_node("source")
    latched = [latch(node, name, topic) for name, topic in topics.items() if "hz" not in topic]
    streams = {
        name: Stream(node, name, topic)
        for name, topic in topics.items()
        if "hz" in topic and not topic.get("later", False)
    }
    sys.stdout.write("ready\n")
    lines: queue.SimpleQueue[str] = queue.SimpleQueue()
    threading.Thread(target=listen, args=(lines,), daemon=True).start()
    words: list[str] = []
    # Commands come between messages: what one asks for counts for whole messages.
    while words != ["stop"]:
        if words:
            command, *names = words
            if command == "create":
                streams |= {name: Stream(node, name, topics[name]) for name in names}
            for name in names or streams:
                obey(streams[name], command)
        now_s = time.monotonic()
        for stream in streams.values():
            if stream.due_s <= now_s:
                stream.send()
        due_s = min((stream.due_s for stream in streams.values()), default=now_s + 0.1)
        words = (next_line(lines, min(max(due_s - time.monotonic(), 0), 0.1)) or "").split()
    del latched
    node.destroy_node()
    rclpy.shutdown()


main()
