# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""Somebody far away who sets parameters of a SmartTestudo and calls its service, as ``ros2 param`` would.

usage: remote_control.py
Each line on stdin is a JSON request, answered by a line ``reply JSON``: ``["set", {"rules_text": "…"}]`` with
the reasons of those that were refused, ``["get", "rules_hash"]`` with the value, ``["reload"]`` with
[success, message].
"""

from __future__ import annotations

import json
import sys
from typing import Any

import rclpy
from rcl_interfaces.srv import GetParameters, SetParameters
from rclpy.parameter import Parameter, parameter_value_to_python
from std_srvs.srv import Trigger

NODE = "/smarttestudo"


class Remote:
    def __init__(self, node: Any) -> None:
        self.node = node
        self.clients = {
            kind: node.create_client(kind, f"{NODE}/{name}")
            for kind, name in (
                (GetParameters, "get_parameters"),
                (SetParameters, "set_parameters"),
                (Trigger, "reload"),
            )
        }
        for client in self.clients.values():
            while not client.wait_for_service(timeout_sec=1.0):
                pass

    def call(self, request: Any, kind: Any) -> Any:
        future = self.clients[kind].call_async(request)
        rclpy.spin_until_future_complete(self.node, future)
        return future.result()

    def answer(self, what: str, about: Any = None) -> object:
        if what == "set":
            parameters = [Parameter(name, value=value).to_parameter_msg() for name, value in about.items()]
            reply = self.call(SetParameters.Request(parameters=parameters), SetParameters)
            return [one.reason for one in reply.results if not one.successful]
        if what == "get":
            return parameter_value_to_python(
                self.call(GetParameters.Request(names=[about]), GetParameters).values[0]
            )
        reply = self.call(Trigger.Request(), Trigger)
        return [reply.success, reply.message]


def main() -> None:
    rclpy.init()
    node = rclpy.create_node("remote_control")
    remote = Remote(node)
    sys.stdout.write("ready\n")
    for line in sys.stdin:
        sys.stdout.write(f"reply {json.dumps(remote.answer(*json.loads(line)))}\n")
    node.destroy_node()
    rclpy.shutdown()


main()
