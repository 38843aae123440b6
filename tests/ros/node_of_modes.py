# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""One process of a robot with modes, under the names of ``examples/robot_with_modes.adirf``.

usage: node_of_modes.py ROLE [NAME]
Each line on stdin is a JSON request, answered by a line ``reply JSON``. The roles:

- ``sensors`` publishes /mode and /estop (once, and when asked), /battery_state, /scan, /arm/state and
  /camera/NAME: ``["mode", "docking"]``, ``["estop", true]``, ``["charging", true]``, ``["distance", 0.5]``;
- ``camera`` publishes /camera/NAME;
- ``diagnostics`` publishes one status named NAME five times a second: ``["level", 2]``;
- ``driver`` is the node /camera_driver with the parameter ``jpeg_quality`` (90), and offers /lidar/reset:
  ``["quality"]``, ``["resets"]``;
- ``controller`` is the lifecycle node /controller_server, active: ``["deactivate"]``, ``["activate"]``,
  ``["fatal", text]``;
- ``logger`` is a node NAME that logs: ``["fatal", text]``;
- ``navigator`` is the action server and a client of /navigate_to_pose: ``["send"]`` answers when the goal is
  accepted, and aborts the one before; ``["abort"]`` and ``["succeed"]`` end it.
"""

from __future__ import annotations

import json
import sys
import threading
from collections.abc import Callable
from functools import partial
from typing import Any

import rclpy
from diagnostic_msgs.msg import DiagnosticArray, DiagnosticStatus
from rclpy.action import ActionClient, ActionServer
from rclpy.executors import SingleThreadedExecutor
from rclpy.lifecycle import LifecycleNode
from rclpy.qos import DurabilityPolicy, QoSProfile
from rclpy.task import Future
from sensor_msgs.msg import BatteryState, LaserScan
from std_msgs.msg import Bool, String
from std_srvs.srv import Trigger
from test_msgs.action import Fibonacci

Answer = Callable[..., object]
LATCHED = QoSProfile(depth=1, durability=DurabilityPolicy.TRANSIENT_LOCAL)


def camera(executor: Any, name: str) -> dict[str, Answer]:
    node = rclpy.create_node(f"camera_{name}")
    publisher = node.create_publisher(String, f"/camera/{name}", 10)
    node.create_timer(0.05, lambda: publisher.publish(String(data="picture")))
    executor.add_node(node)
    return {}


def sensors(executor: Any, name: str) -> dict[str, Answer]:
    node = rclpy.create_node("sensors")
    mode = node.create_publisher(String, "/mode", LATCHED)
    stop = node.create_publisher(Bool, "/estop", LATCHED)
    battery = node.create_publisher(BatteryState, "/battery_state", 10)
    scan = node.create_publisher(LaserScan, "/scan", 10)
    arm = node.create_publisher(String, "/arm/state", 10)
    power = BatteryState(power_supply_status=BatteryState.POWER_SUPPLY_STATUS_DISCHARGING)
    view = LaserScan(range_min=0.1, range_max=9.0, ranges=[5.0])

    def charge(is_charging: bool) -> None:
        statuses = (
            BatteryState.POWER_SUPPLY_STATUS_DISCHARGING,
            BatteryState.POWER_SUPPLY_STATUS_CHARGING,
        )
        power.power_supply_status = statuses[is_charging]

    def come_near(distance_m: float) -> None:
        view.ranges = [distance_m]

    node.create_timer(0.1, lambda: battery.publish(power))
    node.create_timer(0.025, lambda: scan.publish(view))
    node.create_timer(0.1, lambda: arm.publish(String(data="idle")))
    executor.add_node(node)
    mode.publish(String(data="driving"))
    stop.publish(Bool(data=False))
    return {
        **camera(executor, name),
        "mode": lambda text: mode.publish(String(data=text)),
        "estop": lambda is_pressed: stop.publish(Bool(data=is_pressed)),
        "charging": charge,
        "distance": come_near,
    }


def diagnostics(executor: Any, name: str) -> dict[str, Answer]:
    node = rclpy.create_node(f"diagnostics_{name.replace(' ', '_')}")
    publisher = node.create_publisher(DiagnosticArray, "/diagnostics", 10)
    status = DiagnosticStatus(name=name, level=DiagnosticStatus.OK)
    node.create_timer(0.2, lambda: publisher.publish(DiagnosticArray(status=[status])))
    executor.add_node(node)

    def rise(level: int) -> None:
        status.level = bytes([level])

    return {"level": rise}


def driver(executor: Any, _name: str) -> dict[str, Answer]:
    node = rclpy.create_node("camera_driver")
    node.declare_parameter("jpeg_quality", 90)
    resets: list[int] = []

    def reset(_request: Any, response: Any) -> Any:
        resets.append(1)
        response.success, response.message = True, "reset"
        return response

    node.create_service(Trigger, "/lidar/reset", reset)
    executor.add_node(node)
    return {"quality": lambda: node.get_parameter("jpeg_quality").value, "resets": lambda: len(resets)}


def logger(executor: Any, name: str) -> dict[str, Answer]:
    node = rclpy.create_node(name)
    executor.add_node(node)
    return {"fatal": lambda text: bool(node.get_logger().fatal(text))}


def controller(executor: Any, _name: str) -> dict[str, Answer]:
    node = LifecycleNode("controller_server")
    node.trigger_configure()
    node.trigger_activate()
    executor.add_node(node)
    return {
        "deactivate": lambda: str(node.trigger_deactivate()),
        "activate": lambda: str(node.trigger_activate()),
        "fatal": lambda text: bool(node.get_logger().fatal(text)),
    }


class Navigator:
    """An action server whose goals end when it is told to; a goal that a newer one replaces is aborted."""

    def __init__(self, executor: Any) -> None:
        self.executor = executor
        self.ending = Future()
        node = rclpy.create_node("bt_navigator")
        self.server = ActionServer(
            node,
            Fibonacci,
            "navigate_to_pose",
            self.run,
            handle_accepted_callback=self.accept,
        )
        self.client = ActionClient(node, Fibonacci, "navigate_to_pose")
        executor.add_node(node)

    def accept(self, goal: Any) -> None:
        self.ending.set_result("abort")
        self.ending = Future()
        goal.execute(partial(self.run, ending=self.ending))

    async def run(self, goal: Any, ending: Any) -> Any:
        getattr(goal, await ending)()
        return Fibonacci.Result()

    def send(self) -> None:
        while not self.client.server_is_ready():
            self.executor.spin_once(timeout_sec=0.02)
        sent = self.client.send_goal_async(Fibonacci.Goal())
        while not sent.done():
            self.executor.spin_once(timeout_sec=0.02)

    def end(self, way: str) -> None:
        self.ending.set_result(way)


def navigator(executor: Any, _name: str) -> dict[str, Answer]:
    it = Navigator(executor)
    return {"send": it.send, "abort": lambda: it.end("abort"), "succeed": lambda: it.end("succeed")}


ROLES = {
    role.__name__: role for role in (sensors, camera, diagnostics, driver, logger, controller, navigator)
}


def main() -> None:
    rclpy.init()
    executor = SingleThreadedExecutor()
    answers = ROLES[sys.argv[1]](executor, sys.argv[2] if len(sys.argv) > 2 else "")
    requests: list[str] = []
    thread = threading.Thread(target=lambda: requests.extend(iter(sys.stdin.readline, "")), daemon=True)
    thread.start()
    sys.stdout.write("ready\n")
    while thread.is_alive() or requests:
        executor.spin_once(timeout_sec=0.02)
        while requests:
            name, *arguments = json.loads(requests.pop(0))
            sys.stdout.write(f"reply {json.dumps(answers[name](*arguments))}\n")


main()
