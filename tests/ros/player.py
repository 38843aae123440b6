# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""Plays a recording again and again, as ``ros2 bag play --loop`` does.

usage: player.py BAG
Each topic has the QoS that it was recorded with, and its messages come as far apart as they were recorded.
``stop`` on stdin ends it.
"""

from __future__ import annotations

import sys
import threading
import time
from pathlib import Path

import rclpy
from rclpy.qos import DurabilityPolicy, QoSProfile

from smarttestudo.bags.reader import open_recording
from smarttestudo.robot.ros.message_types import message_type


def end_with_input(stopped: threading.Event) -> None:
    sys.stdin.readline()
    stopped.set()


def main() -> None:
    stopped = threading.Event()
    threading.Thread(target=end_with_input, args=(stopped,), daemon=True).start()
    rclpy.init()
    node = rclpy.create_node("rosbag2_player")
    with open_recording(Path(sys.argv[1])) as recording:
        messages = [(channel.topic, stamp_ns, payload) for channel, stamp_ns, payload in recording.messages()]
        publishers = {
            channel.topic: node.create_publisher(
                message_type(channel.type_name, channel.topic),
                channel.topic,
                QoSProfile(
                    depth=100,
                    durability=DurabilityPolicy.TRANSIENT_LOCAL
                    if channel.transient_local
                    else DurabilityPolicy.VOLATILE,
                ),
            )
            for channel in recording.channels
        }
    sys.stdout.write("ready\n")
    while not stopped.is_set():
        begun_s, first_ns = time.monotonic(), messages[0][1]
        for topic, stamp_ns, payload in messages:
            if stopped.wait(max(begun_s + (stamp_ns - first_ns) / 1e9 - time.monotonic(), 0)):
                break
            publishers[topic].publish(payload)
    node.destroy_node()
    rclpy.shutdown()


main()
