# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""Texts, named elements, all elements and goals of real messages, as rclpy and recordings have them."""

from __future__ import annotations

import math
from array import array
from itertools import count
from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest

from bags.bag_factory import TYPES, cdr, message_of
from smarttestudo.bags.definitions import RosbagDecoder
from smarttestudo.domain.recording import Channel
from smarttestudo.domain.signal import MAX_TEXT_BYTES, Signal, SignalKind, Values
from smarttestudo.language.properties import signal_reader
from smarttestudo.language.properties.signal_readers import text

STATUS = "diagnostic_msgs/msg/DiagnosticStatus"
KEY_VALUE = "diagnostic_msgs/msg/KeyValue"
DIAGNOSTICS = "diagnostic_msgs/msg/DiagnosticArray"
JOINTS = "sensor_msgs/msg/JointState"
SCAN = "sensor_msgs/msg/LaserScan"
GOALS = "action_msgs/msg/GoalStatusArray"
UNKNOWN = math.nan


def diagnostics(levels: dict[str, int]) -> Any:
    status = [
        message_of(STATUS, name=name, level=level, values=[message_of(KEY_VALUE, key="t [°C]", value="41")])
        for name, level in levels.items()
    ]
    return message_of(DIAGNOSTICS, status=status)


def read(type_name: str, path: str, message: object, kind: SignalKind = SignalKind.NUMBER) -> Values | None:
    return signal_reader(type_name, Signal("/x", path, kind))(message)


def is_unknown(value: Values | None) -> bool:
    return isinstance(value, float) and math.isnan(value)


@pytest.mark.parametrize("decoded", ["recorded", "rclpy"])
def test_an_element_is_found_by_its_name_and_one_that_is_not_there_is_none(decoded: str) -> None:
    message = diagnostics({"battery": 0, 'lidar "front"': 2, "imu": 1})
    if decoded == "rclpy":
        serialization = pytest.importorskip("rclpy.serialization")
        messages = pytest.importorskip("diagnostic_msgs.msg")
        message = serialization.deserialize_message(cdr(DIAGNOSTICS, message), messages.DiagnosticArray)
    assert read(DIAGNOSTICS, r'status["lidar \"front\""].level', message) == 2
    assert read(DIAGNOSTICS, r'msg.status["imu"].level', message, SignalKind.STATE) == 1
    assert read(DIAGNOSTICS, 'status["camera"].level', message) is None
    assert read(DIAGNOSTICS, 'status["imu"].values["t [°C]"].value', message, SignalKind.TEXT) == "41"
    assert read(DIAGNOSTICS, 'status["imu"].values["volts"].value', message, SignalKind.TEXT) is None
    assert read(DIAGNOSTICS, "status[-1].name", message, SignalKind.TEXT) == "imu"
    assert read(DIAGNOSTICS, "status[*].level", message) == (0, 2, 1)
    assert read(DIAGNOSTICS, "status[*].name", message, SignalKind.TEXT) == (
        "battery",
        'lidar "front"',
        "imu",
    )
    assert read(DIAGNOSTICS, 'status[*].values["t [°C]"].value', message, SignalKind.TEXT) == ("41",)
    for path in ('status["imu"].levle', "status[3].level", "status[*].levle", "status[*].values[*].value"):
        assert is_unknown(read(DIAGNOSTICS, path, message)), path


def test_an_element_is_found_by_the_names_beside_the_array() -> None:
    joints = message_of(
        JOINTS, name=["left", "right"], position=np.array([0.5, 1.5]), velocity=np.array([2.0])
    )
    assert read(JOINTS, 'position["right"]', joints) == 1.5
    assert read(JOINTS, 'velocity["right"]', joints) is None
    assert read(JOINTS, 'position["arm"]', joints) is None
    assert read(JOINTS, "position[-1]", joints) == 1.5
    assert is_unknown(read(JOINTS, "effort[-1]", joints))
    assert is_unknown(read(JOINTS, 'header["right"]', joints))
    assert is_unknown(read(SCAN, 'ranges["right"]', message_of(SCAN, ranges=np.zeros(3, np.float32))))


def test_of_all_elements_each_value_comes_once_and_what_is_unknown_does_not_count() -> None:
    ranges = np.array([0.0, 1.0, math.nan, 2.0, 1.0, 50.0, math.inf], np.float32)
    scan = message_of(SCAN, ranges=ranges, range_min=0.1, range_max=10.0)
    assert read(SCAN, "ranges[*]", scan) == (1.0, 2.0, math.inf)
    assert read(SCAN, "ranges[*]", message_of(SCAN, ranges=np.zeros(0, np.float32), range_max=1.0)) == ()
    assert is_unknown(read(SCAN, "ranges[*]", message_of(SCAN, ranges=np.full(3, np.nan), range_max=1.0)))
    assert is_unknown(read(SCAN, "ranges[*].x", scan))
    assert is_unknown(read(SCAN, "range_max[*]", scan))
    assert is_unknown(read(SCAN, "ranges[*]", scan, SignalKind.TEXT))
    grid = SimpleNamespace(data=array("b", bytes(10_000_000)))
    assert read("", "data[*]", grid) == (0,)


@pytest.mark.parametrize(
    ("part", "expected"),
    [
        ("docking", "docking"),
        ("docking\0rest", "docking"),
        (b"mode 3\0\0\0", "mode 3"),
        (array("B", b"mode 3\0old"), "mode 3"),
        (np.frombuffer(b"mode 3\0\xff", np.uint8), "mode 3"),
        ([b"m", b"o", b"\0"], "mo"),
        ("x" * MAX_TEXT_BYTES, "x" * MAX_TEXT_BYTES),
        ("é" * 10_000_000, "é" * MAX_TEXT_BYTES + "…"),
        (np.frombuffer(b"x" * 9000, np.uint8), "x" * MAX_TEXT_BYTES + "…"),
        ("", ""),
    ],
)
def test_what_is_read_as_a_text(part: object, expected: str) -> None:
    assert text(part) == expected


@pytest.mark.parametrize("part", [1, 1.5, True, None, b"x", ["a"], np.zeros(3), array("b", b"abc"), object()])
def test_what_is_no_text(part: object) -> None:
    assert is_unknown(text(part))


class ActionServer:
    """The status messages of an action server, whose goals have a stamp a second later each."""

    def __init__(self) -> None:
        self._count = count(1)
        self.goals: dict[int, int] = {}

    def accept(self) -> int:
        goal = next(self._count)
        self.goals[goal] = 1
        return goal

    @property
    def message(self) -> object:
        info, time, goal_id = (
            TYPES.types[name]
            for name in (
                "action_msgs/msg/GoalInfo",
                "builtin_interfaces/msg/Time",
                "unique_identifier_msgs/msg/UUID",
            )
        )
        status = [
            message_of(
                "action_msgs/msg/GoalStatus",
                goal_info=info(goal_id(np.full(16, goal, np.uint8)), time(goal, 0)),
                status=status,
            )
            for goal, status in self.goals.items()
        ]
        return message_of(GOALS, status_list=status)


def test_the_goal_is_the_one_accepted_last_of_those_that_had_not_ended_before() -> None:
    server = ActionServer()
    server.goals[server.accept()] = 6
    goal = signal_reader(GOALS, Signal("/a/_action/status", "goal", SignalKind.STATE))
    course = []

    def see() -> None:
        course.append(goal(server.message))

    see()  # one that was aborted before the start
    first = server.accept()
    see()
    server.goals[first] = 6
    see()
    see()
    second = server.accept()
    see()
    server.goals[second] = 6
    see()
    third, fourth = server.accept(), server.accept()
    see()
    server.goals[third] = 6  # the fourth replaced it
    server.goals[fourth] = 2
    see()
    server.goals = {fourth: 4}
    see()
    server.goals = {}
    see()
    assert is_unknown(course[0])
    assert course[1:] == [1, 6, 6, 1, 6, 1, 2, 4, 4]


def test_a_goal_that_runs_when_the_robot_is_first_seen_counts() -> None:
    server = ActionServer()
    running = server.accept()
    goal = signal_reader(GOALS, Signal("/a/_action/status", "goal"))
    assert goal(server.message) == 1
    server.goals[running] = 6
    assert goal(server.message) == 6


@pytest.mark.parametrize("data", [b"dock\0ing", b"a\xff\xfeb", b"\xed\xa0\x80", "é".encode(), b""])
def test_a_recorded_text_is_the_one_that_a_robot_reads(data: bytes) -> None:
    serialization = pytest.importorskip("rclpy.serialization")
    messages = pytest.importorskip("std_msgs.msg")
    kind = "std_msgs/msg/String"
    payload = b"\0\1\0\0" + (len(data) + 1).to_bytes(4, "little") + data + b"\0"
    live = serialization.deserialize_message(payload, messages.String)
    recorded = RosbagDecoder().decode(Channel(topic="/x", type_name=kind), payload)
    assert read(kind, "data", recorded, SignalKind.TEXT) == read(kind, "data", live, SignalKind.TEXT)
