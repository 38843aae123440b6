# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""A robot's sources: publishes each topic on a schedule, which it catches up with after a stall.

usage: source.py '{"imu": {"type": "sensor_msgs/msg/Imu", "hz": 195, "reliable": true}, …}'
The stamp of a message, or the ``linear.y`` of a Twist, is the monotonic time at which it was due. A topic
without ``hz`` is latched: ``texts`` are published once, each by a publisher of its own. On stdin the line
``move`` puts the robot of an Odometry at x = 5, ``home`` at x = 0, ``stop`` ends it. With each message, a
Clock goes on by ``step_ms``.
"""

from __future__ import annotations

import importlib
import json
import sys
import threading
import time
from typing import Any

import rclpy
from rclpy.qos import DurabilityPolicy, QoSProfile, ReliabilityPolicy

NS_PER_MS = 1_000_000
NS_PER_S = 1_000_000_000
PLACES_M = {"move": 5.0, "home": 0.0}


class Stream:
    def __init__(self, node: Any, name: str, topic: dict[str, Any]) -> None:
        message_type = message_class(topic["type"])
        policy = ReliabilityPolicy.RELIABLE if topic.get("reliable", True) else ReliabilityPolicy.BEST_EFFORT
        self.publisher = node.create_publisher(
            message_type, f"/{name}", QoSProfile(depth=10, reliability=policy)
        )
        self.message = message_type()
        self.period_s = 1.0 / topic["hz"]
        self.step_ns = topic.get("step_ms", 0) * NS_PER_MS
        self.start_s = time.monotonic()
        self.sent = 0

    @property
    def due_s(self) -> float:
        return self.start_s + self.sent * self.period_s

    def send(self) -> None:
        write_due(self.message, self.due_s)
        self.sent += 1
        if self.step_ns:
            self.message.clock.sec, self.message.clock.nanosec = divmod(self.sent * self.step_ns, NS_PER_S)
        self.publisher.publish(self.message)


def write_due(message: Any, due_s: float) -> None:
    if hasattr(message, "header"):
        stamp = message.header.stamp
        stamp.sec, stamp.nanosec = divmod(round(due_s * NS_PER_S), NS_PER_S)
    elif hasattr(message, "linear"):
        message.linear.y = due_s


def message_class(type_name: str) -> Any:
    package, _, name = type_name.split("/")
    return getattr(importlib.import_module(f"{package}.msg"), name)


def latch(node: Any, name: str, topic: dict[str, Any]) -> list[Any]:
    qos = QoSProfile(depth=1, durability=DurabilityPolicy.TRANSIENT_LOCAL)
    message_type = message_class(topic["type"])
    publishers = [node.create_publisher(message_type, f"/{name}", qos) for _ in topic["texts"]]
    for publisher, text in zip(publishers, topic["texts"], strict=True):
        publisher.publish(message_type(data=text))
    return publishers


def listen(streams: dict[str, Stream], stopped: threading.Event) -> None:
    for line in sys.stdin:
        x_m = PLACES_M.get(line.strip())
        if x_m is None:
            break
        for stream in streams.values():
            if hasattr(stream.message, "pose"):
                stream.message.pose.pose.position.x = x_m
    stopped.set()


def main() -> None:
    topics = json.loads(sys.argv[1])
    rclpy.init()
    node = rclpy.create_node("source")
    latched = [latch(node, name, topic) for name, topic in topics.items() if "hz" not in topic]
    streams = {name: Stream(node, name, topic) for name, topic in topics.items() if "hz" in topic}
    sys.stdout.write("ready\n")
    stopped = threading.Event()
    threading.Thread(target=listen, args=(streams, stopped), daemon=True).start()
    while not stopped.is_set():
        now_s = time.monotonic()
        for stream in streams.values():
            if stream.due_s <= now_s:
                stream.send()
        due_s = min((stream.due_s for stream in streams.values()), default=now_s + 0.1)
        stopped.wait(max(due_s - time.monotonic(), 0))
    del latched
    node.destroy_node()
    rclpy.shutdown()


main()
