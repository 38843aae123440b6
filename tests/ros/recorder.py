# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""An ordinary recording of a robot's topics.

usage: recorder.py FOLDER '{"odom": {"type": "nav_msgs/msg/Odometry"}, …}'
The line ``stop`` on stdin ends it.
"""

from __future__ import annotations

import json
import sys
import threading
from pathlib import Path

from smarttestudo.adapters.ros import open_robot
from smarttestudo.composition.live_recorder import recorded
from smarttestudo.domain.recording import Channel


def main() -> None:
    topics = json.loads(sys.argv[2])
    channels = [Channel(topic=f"/{name}", type_name=topic["type"]) for name, topic in topics.items()]
    stopped = threading.Event()
    threading.Thread(target=lambda: (sys.stdin.readline(), stopped.set()), daemon=True).start()
    with open_robot(name="recorder") as robot, recorded(robot, Path(sys.argv[1]), channels, {}):
        sys.stdout.write("ready\n")
        while not stopped.is_set():
            robot.wait(None, 0.1)
    sys.stdout.write("result null\n")


main()
