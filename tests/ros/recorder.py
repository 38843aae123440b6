# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""An ordinary recording of a robot's topics.

usage: recorder.py FOLDER '{"odom": {"type": "nav_msgs/msg/Odometry"}, …}'
The line ``more`` on stdin prints ``more`` when, from then on, every topic was heard for a second;
``stop`` ends it.
"""

from __future__ import annotations

import json
import queue
import sys
import threading
import time
from collections import deque
from collections.abc import Hashable
from functools import partial
from pathlib import Path

from smarttestudo.domain.recording import Channel
from smarttestudo.domain.robot import Payload, Qos, Robot
from smarttestudo.robot.ros import open_robot
from smarttestudo.simulation.demo.live import recorded

SPAN_S = 1.0


class Listener:
    """Hears what is recorded, a little later: its subscriptions are the younger ones."""

    def __init__(self, robot: Robot, channels: list[Channel]) -> None:
        self.since_s: dict[str, float] | None = None
        self.topics = len(channels)
        qos = Qos(reliable=True, transient_local=False)
        for channel in channels:
            robot.data_path.subscribe(
                channel.topic, channel.type_name, qos, partial(self.hear, channel.topic)
            )

    def hear(self, topic: str, _payload: Payload, _publisher: Hashable) -> None:
        if self.since_s is None:
            return
        now_s = time.monotonic()
        self.since_s.setdefault(topic, now_s)
        if len(self.since_s) == self.topics and now_s - max(self.since_s.values()) >= SPAN_S:
            self.since_s = None
            sys.stdout.write("more\n")


def main() -> None:
    topics = json.loads(sys.argv[2])
    channels = [Channel(topic=f"/{name}", type_name=topic["type"]) for name, topic in topics.items()]
    lines: queue.Queue[str] = queue.Queue()
    threading.Thread(target=lambda: deque(map(lines.put, sys.stdin), maxlen=0), daemon=True).start()
    with open_robot(name="recorder") as robot, recorded(robot, Path(sys.argv[1]), channels, {}):
        listener = Listener(robot, channels)
        sys.stdout.write("ready\n")
        line = ""
        while line != "stop":
            robot.wait(None, 0.1)
            if not lines.empty():
                line = lines.get().strip()
                listener.since_s = {}
    sys.stdout.write("result null\n")


main()
