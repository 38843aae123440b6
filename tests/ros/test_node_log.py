# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""The node logs what rclpy's own log would."""

from __future__ import annotations

import importlib.util
import os
import time
from collections.abc import Iterator
from typing import Any

import pytest

from smarttestudo.domain.robot import Qos, Robot
from smarttestudo.robot.ros import open_robot
from smarttestudo.robot.ros.node_log import Utf8Log

TIMEOUT_S = 120.0
LOG = "rcl_interfaces/msg/Log"
LATCHED = Qos(reliable=True, transient_local=True, depth=100)


@pytest.fixture
def robot(in_domain: None) -> Iterator[Robot]:
    with open_robot() as opened:
        yield opened


def heard(robot: Robot, count: int) -> list[Any]:
    """The first ``count`` lines on /rosout."""
    lines: list[Any] = []
    path = robot.data_path
    path.subscribe(
        "/rosout", LOG, LATCHED, lambda payload, _: lines.append(path.decode("/rosout", LOG, payload))
    )
    end_s = time.monotonic() + TIMEOUT_S
    while len(lines) < count:
        assert time.monotonic() < end_s, "nothing came in time"
        robot.wait(None, 0.1)
    return lines


def test_a_line_has_the_level_and_the_place_that_rclpy_would_give_it(robot: Robot) -> None:
    rclpy_logging = importlib.import_module("rclpy.logging")
    for log in (robot.log, rclpy_logging.get_logger("smarttestudo")):
        log.info("as 10 Hz: 5 % less")
        log.warning("too late")
    lines = heard(robot, 4)
    ours, rclpys = lines[:2], lines[2:]

    def told(lines: list[Any]) -> list[tuple[object, ...]]:
        return [(one.level, one.name, one.msg, one.file, one.function, one.line) for one in lines]

    assert told(ours) == told(rclpys)
    assert ours[0].file == __file__


def test_names_of_others_are_logged_as_text_on_one_line(robot: Robot) -> None:
    rclpy_logging = importlib.import_module("rclpy.logging")
    name = os.fsdecode(b"r\xe9gles.adirf") + "\x1b[2J\n\x9b"
    for log in (robot.log, Utf8Log(rclpy_logging.get_logger("smarttestudo"))):
        log.info(name)
        log.warning(name)
    assert [one.msg for one in heard(robot, 4)] == [r"r\udce9gles.adirf\u001b[2J\n\u009b"] * 4


def test_what_the_level_leaves_out_is_not_logged(robot: Robot) -> None:
    rclpy_logging = importlib.import_module("rclpy.logging")
    rclpy_logging.set_logger_level("smarttestudo", rclpy_logging.LoggingSeverity.WARN)
    try:
        robot.log.info("left out")
        robot.log.warning("said")
    finally:
        rclpy_logging.set_logger_level("smarttestudo", rclpy_logging.LoggingSeverity.UNSET)
    assert [one.msg for one in heard(robot, 1)] == ["said"]
