# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""Many robots at once: publishes each second the statuses in the last line on stdin, a JSON list of texts."""

from __future__ import annotations

import json
import sys
import threading

import rclpy
from rclpy.qos import DurabilityPolicy, QoSProfile
from std_msgs.msg import String

PERIOD_S = 1.0

rclpy.init()
node = rclpy.create_node("fleet")
qos = QoSProfile(depth=100, durability=DurabilityPolicy.TRANSIENT_LOCAL)
publisher = node.create_publisher(String, "/testudo/status", qos)
texts: list[str] = []


def read() -> None:
    for line in sys.stdin:
        texts[:] = json.loads(line)
        publish()


def publish() -> None:
    for text in texts:
        publisher.publish(String(data=text))


threading.Thread(target=read, daemon=True).start()
timer = node.create_timer(PERIOD_S, publish)
rclpy.spin(node)
