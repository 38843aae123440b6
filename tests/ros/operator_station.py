# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""The operator's side: notes when each relayed message arrives.

usage: operator_station.py SPAN_S '{"imu": {"type": "sensor_msgs/msg/Imu", "transient_local": false}, …}'
A topic is heard by the name ``/testudo/imu``, or as its ``topic`` says, and not ``reliable`` unless latched.
Prints ``heard N`` when every topic has been heard for N times SPAN_S, first to last message. With SPAN_S 0 it
prints it whenever of each topic the last ``messages`` (default 1) have come, and were due ``within_s``
(default: any time), and all its ``values`` came. The line ``graph`` on stdin prints the topics there are, any
other the result so far, and ``stop`` ends it: arrivals as [seconds, value, seconds at which it was due], the
value being the x of an Odometry or the text of a String or what a Bool says, or the serialized message in hex
where the topic is ``raw``.
"""

from __future__ import annotations

import json
import math
import queue
import sys
import threading
import time
from collections import deque
from typing import Any

import rclpy
from rclpy.qos import DurabilityPolicy, QoSProfile, ReliabilityPolicy

from smarttestudo.robot.ros.message_types import message_type

Arrival = tuple[float, Any, float]


class Station:
    def __init__(self, node: Any, topics: dict[str, dict[str, Any]], span_s: float) -> None:
        self.arrivals: dict[str, list[Arrival]] = {name: [] for name in topics}
        self.topics = topics
        self.span_s = span_s
        self.heard = 0
        self.subscriptions = [self.subscribe(node, name, topic) for name, topic in topics.items()]

    def subscribe(self, node: Any, name: str, topic: dict[str, Any]) -> Any:
        latched = topic.get("transient_local", False)
        reliable = topic.get("reliable", latched)
        qos = QoSProfile(
            depth=100,
            reliability=ReliabilityPolicy.RELIABLE if reliable else ReliabilityPolicy.BEST_EFFORT,
            durability=DurabilityPolicy.TRANSIENT_LOCAL if latched else DurabilityPolicy.VOLATILE,
        )
        return node.create_subscription(
            message_type(topic["type"], name),
            topic.get("topic", f"/testudo/{name}"),
            lambda message: self.note(name, message),
            qos,
            raw=topic.get("raw", False),
        )

    def note(self, name: str, message: Any) -> None:
        self.arrivals[name].append((time.monotonic(), value_of(message), due_s_of(message)))
        if all(self.enough(topic) for topic in self.topics):
            self.heard += 1
            sys.stdout.write(f"heard {self.heard}\n")

    def enough(self, name: str) -> bool:
        arrivals = self.arrivals[name]
        if not self.span_s:
            messages = self.topics[name].get("messages", 1)
            within_s = self.topics[name].get("within_s", math.inf)
            return (
                len(arrivals) >= messages
                and arrivals[-1][2] - arrivals[-messages][2] <= within_s
                and {*self.topics[name].get("values", [])} <= {value for _, value, _ in arrivals}
            )
        return bool(arrivals) and arrivals[-1][0] - arrivals[0][0] >= self.span_s * (self.heard + 1)


def value_of(message: Any) -> Any:
    if isinstance(message, bytes):
        return message.hex()
    if hasattr(message, "pose"):
        return message.pose.pose.position.x
    data = getattr(message, "data", None)
    return data if isinstance(data, str | bool) else None


def due_s_of(message: Any) -> float:
    """As ``source.py`` wrote it."""
    if hasattr(message, "header"):
        return float(message.header.stamp.sec + message.header.stamp.nanosec / 1e9)
    return float(message.linear.y) if hasattr(message, "linear") else 0.0


def main() -> None:
    rclpy.init()
    node = rclpy.create_node("operator")
    station = Station(node, json.loads(sys.argv[2]), float(sys.argv[1]))
    sys.stdout.write("ready\n")
    lines: queue.Queue[str] = queue.Queue()
    threading.Thread(target=lambda: deque(map(lines.put, sys.stdin), maxlen=0), daemon=True).start()
    line = ""
    while line != "stop":
        rclpy.spin_once(node, timeout_sec=0.1)
        if not lines.empty():
            line = lines.get().strip()
            if line == "graph":
                topics = [name for name, _ in node.get_topic_names_and_types()]
                sys.stdout.write(f"graph {json.dumps(topics)}\n")
                continue
            sys.stdout.write(f"result {json.dumps(station.arrivals)}\n")
    node.destroy_node()
    rclpy.shutdown()


main()
