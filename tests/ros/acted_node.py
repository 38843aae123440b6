# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""A node that rules act on: parameters, services, and a topic that says when.

usage: acted_node.py
The node /camera has the parameters ``quality`` (90), ``gain`` (0.5), ``picky`` (1), which it lets nobody set,
and the services /dock (Trigger), /light (SetBool) and /wipe (Empty). /hang (Trigger) never answers. /level
(std_msgs/msg/Float64) is published twenty times a second.

Each line on stdin is a JSON request, answered by a line ``reply JSON``: ``["level", 9]``, ``["get",
"quality"]``, ``["set", "quality", 55]``, ``["calls"]`` with what was called so far, ``["hide"]`` and
``["show"]`` for the node to go and come back.
"""

from __future__ import annotations

import json
import sys
import threading
from typing import Any

import rclpy
from rcl_interfaces.msg import SetParametersResult
from rclpy.executors import SingleThreadedExecutor
from rclpy.parameter import Parameter
from std_msgs.msg import Float64
from std_srvs.srv import Empty, SetBool, Trigger

PICKY = "no; $(rm -rf /)\x1b[2J " + "x" * 5000


class Camera:
    """The node with its parameters, as long as it is there."""

    def __init__(self) -> None:
        self.calls: list[object] = []
        self.node: Any = None
        self.executor = SingleThreadedExecutor()
        self.show()

    def show(self) -> None:
        self.node = node = rclpy.create_node("camera")
        for name, value in (("quality", 90), ("gain", 0.5), ("picky", 1)):
            node.declare_parameter(name, value)
        node.add_on_set_parameters_callback(self.asked)
        node.create_service(Trigger, "/dock", self.docked)
        node.create_service(SetBool, "/light", self.lit)
        node.create_service(Empty, "/wipe", self.wiped)
        self.executor.add_node(node)

    def hide(self) -> None:
        self.executor.remove_node(self.node)
        self.node.destroy_node()

    def asked(self, parameters: list[Any]) -> Any:
        is_picky = any(one.name == "picky" for one in parameters)
        return SetParametersResult(successful=not is_picky, reason=PICKY if is_picky else "")

    def docked(self, _request: Any, response: Any) -> Any:
        self.calls.append("dock")
        response.success, response.message = True, "docked\x1b[2J" + "y" * 10_000_000
        return response

    def lit(self, request: Any, response: Any) -> Any:
        self.calls.append(["light", request.data])
        response.success, response.message = False, "the bulb is broken"
        return response

    def wiped(self, _request: Any, response: Any) -> Any:
        self.calls.append("wipe")
        return response


def answer(camera: Camera, request: list[Any], level: list[float]) -> object:
    match request:
        case ["level", value]:
            level[0] = float(value)
        case ["get", name]:
            return camera.node.get_parameter(name).value
        case ["set", name, value]:
            camera.node.set_parameters([Parameter(name, value=value)])
        case ["calls"]:
            return camera.calls
        case ["hide"]:
            camera.hide()
        case ["show"]:
            camera.show()
    return None


def main() -> None:
    rclpy.init()
    camera = Camera()
    # Nobody spins it.
    silent = rclpy.create_node("silent")
    silent.create_service(Trigger, "/hang", lambda _, response: response)
    source = rclpy.create_node("source")
    level = [0.0]
    publisher = source.create_publisher(Float64, "/level", 10)
    source.create_timer(0.05, lambda: publisher.publish(Float64(data=level[0])))
    camera.executor.add_node(source)
    requests: list[str] = []
    thread = threading.Thread(target=lambda: requests.extend(iter(sys.stdin.readline, "")), daemon=True)
    thread.start()
    sys.stdout.write("ready\n")
    while thread.is_alive() or requests:
        camera.executor.spin_once(timeout_sec=0.02)
        while requests:
            reply = answer(camera, json.loads(requests.pop(0)), level)
            sys.stdout.write(f"reply {json.dumps(reply)}\n")


main()
