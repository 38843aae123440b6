# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""Prints each message on /diagnostics: ``diagnostics {name: {level, message, hardware_id, values}}``."""

from __future__ import annotations

import json
import sys
from typing import Any

import rclpy
from diagnostic_msgs.msg import DiagnosticArray


def show(message: Any) -> None:
    statuses = {
        status.name: {
            "level": int.from_bytes(status.level, "little"),
            "message": status.message,
            "hardware_id": status.hardware_id,
            "values": {value.key: value.value for value in status.values},
        }
        for status in message.status
    }
    sys.stdout.write(f"diagnostics {json.dumps(statuses)}\n")


rclpy.init()
node = rclpy.create_node("diagnostics_listener")
subscription = node.create_subscription(DiagnosticArray, "/diagnostics", show, 10)
rclpy.spin(node)
