# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""An operator who hears the robot's own /odom beside what is relayed of it.

usage: picture_watcher.py
Prints ``heard N`` after every message of the source that comes after a first relayed one and is no older. The
line ``relayed`` on stdin prints when the last relayed message was due, any other the result so far, and
``stop`` ends it: of both topics each message as [seconds at which it came, seconds at which it was due, x,
y], in the order in which they came.
"""

from __future__ import annotations

import importlib
import json
import queue
import sys
import threading
import time
from collections import deque
from functools import partial
from typing import Any

import rclpy
from rclpy.qos import QoSProfile

TOPICS = {"source": "/odom", "relayed": "/testudo/odom"}


class Watcher:
    def __init__(self, node: Any) -> None:
        self.heard: dict[str, list[tuple[float, ...]]] = {name: [] for name in TOPICS}
        self.compared = 0
        odometry = importlib.import_module("nav_msgs.msg").Odometry
        self.subscriptions = [
            node.create_subscription(odometry, topic, partial(self.hear, name), QoSProfile(depth=1000))
            for name, topic in TOPICS.items()
        ]

    def hear(self, name: str, message: Any) -> None:
        stamp, position = message.header.stamp, message.pose.pose.position
        self.heard[name].append((time.monotonic(), stamp.sec + stamp.nanosec / 1e9, position.x, position.y))
        relayed = self.heard["relayed"]
        if name == "source" and relayed and self.heard["source"][-1][1] >= relayed[0][1]:
            self.compared += 1
            sys.stdout.write(f"heard {self.compared}\n")


def main() -> None:
    rclpy.init()
    node = rclpy.create_node("picture_watcher")
    watcher = Watcher(node)
    sys.stdout.write("ready\n")
    lines: queue.Queue[str] = queue.Queue()
    threading.Thread(target=lambda: deque(map(lines.put, sys.stdin), maxlen=0), daemon=True).start()
    line = ""
    while line != "stop":
        rclpy.spin_once(node, timeout_sec=0.1)
        if not lines.empty():
            line = lines.get().strip()
            if line == "relayed":
                sys.stdout.write(f"relayed {watcher.heard['relayed'][-1][1]!r}\n")
            else:
                sys.stdout.write(f"result {json.dumps(watcher.heard)}\n")
    node.destroy_node()
    rclpy.shutdown()


main()
