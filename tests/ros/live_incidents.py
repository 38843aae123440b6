# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""A robot whose rules record, and what its incidents hold."""

from __future__ import annotations

import json
from pathlib import Path
from typing import Any

from bags.bag_factory import BagMessage
from ros.ros_processes import Process

ODOM = {"type": "nav_msgs/msg/Odometry", "hz": 20, "reliable": True}
COUNT = {"type": "std_msgs/msg/String", "hz": 100, "reliable": True}
FRAMES = {"type": "std_msgs/msg/String", "texts": ["one"]}
HEARD_COUNT = {"type": "std_msgs/msg/String", "topic": "/count", "reliable": True}


def record_of(folder: Path) -> dict[str, Any]:
    """What ``incident.json`` says."""
    found: dict[str, Any] = json.loads((folder / "incident.json").read_text())
    return found


def numbers(messages: list[BagMessage]) -> list[int]:
    """What the texts of /count say, which are numbers without a gap."""
    return [int(one.payload[8:].rstrip(b"\0")) for one in messages if one.topic == "/count"]


def recorded(runtime: Process) -> str:
    """The name of the next incident that is whole."""
    while True:
        name = runtime.line_with("incident ").split("incident ")[1].strip()
        if ":" not in name:
            return name
