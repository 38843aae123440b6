# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""Prometheus at both ends of a link, ``testudo run`` on the robot and ``testudo receive`` at its operator."""

from __future__ import annotations

import math
import re
import signal
import time
from collections.abc import Callable

import pytest

from link.openmetrics.scraping import Samples, require_only_growth, samples, value
from link.zenoh.ends import free_endpoint
from ros.ros_processes import LINE_TIMEOUT_S, Process, SmallRobot

IMU = "sensor_msgs/msg/Imu"
ODOMETRY = "nav_msgs/msg/Odometry"
RULES = "begin SetFrequency /imu Full SetFrequency /odom 10 end"
PERIOD_S = 0.2


def port_of(process: Process) -> int:
    return int(process.line_with("Metrics: ").rsplit(":", 1)[1].partition("/")[0])


def scraped_until(port: int, holds: Callable[[Samples], object]) -> Samples:
    """The first samples for which ``holds``; no counter falls meanwhile."""
    end_s = time.monotonic() + LINE_TIMEOUT_S
    before, types = samples(port)
    while not holds(before):
        assert time.monotonic() < end_s, before
        time.sleep(PERIOD_S)
        # A family without a sample is not told, so it may be in the earlier one only.
        after, types_after = samples(port)
        require_only_growth(before, after, types)
        before, types = after, types_after
    return before


@pytest.mark.contract
def test_both_ends_of_a_link_tell_rates_ages_and_the_link(robot: SmallRobot, operators: SmallRobot) -> None:
    endpoint = free_endpoint()
    receiving = operators.testudo("receive", "--no-ros", "--listen", endpoint, "--openmetrics", "0")
    there = port_of(receiving)
    running = robot.runtime(RULES, "--link", endpoint, "--robot", "tb3", "--openmetrics", "127.0.0.1:0")
    here = port_of(running)
    robot.source(imu={"type": IMU, "hz": 50}, odom={"type": ODOMETRY, "hz": 50})

    def has_aged(found: Samples) -> bool:
        age_s = value(found, "testudo_topic_link_age_seconds", robot="tb3", topic="/odom")
        return age_s is not None and value(found, "testudo_link_connected", robot="tb3") == 1

    def is_full(found: Samples) -> bool:
        # What the link carries is not known in its first seconds.
        rates_hz = [value(found, target, robot="tb3", topic=topic) for topic in ("/imu", "/odom")]
        return has_aged(found) and rates_hz == [math.inf, 10]

    target = "testudo_topic_target_hertz"
    at_robot = scraped_until(here, is_full)
    assert (value(at_robot, "testudo_decisions_total", robot="tb3") or 0) >= 2

    def has_all(found: Samples) -> bool:
        rate_hz = value(found, "testudo_receive_topic_hertz", robot="tb3", topic="/odom")
        return has_aged(found) and rate_hz is not None and 8 < rate_hz < 12

    at_operator = scraped_until(there, has_all)
    assert value(at_operator, "testudo_receive_connected", robot="tb3") == 1
    # The robot's own status comes over the link, so one address tells of all robots.
    assert value(at_operator, "testudo_topic_target_hertz", robot="tb3", topic="/odom") == 10
    scraped_until(here, lambda found: (value(found, "testudo_uptime_seconds", robot="tb3") or 0) > 5)


def test_a_run_without_a_link_has_metrics_under_the_name_of_its_machine(robot: SmallRobot) -> None:
    running = robot.runtime(RULES, "--openmetrics", "0")
    robot.operator(odom={"type": ODOMETRY})
    robot.source(odom={"type": ODOMETRY, "hz": 50})
    here = port_of(running)

    def relayed(found: Samples) -> float:
        return max(
            (number for (name, _), number in found.items() if name == "testudo_topic_relayed_messages_total"),
            default=0,
        )

    found = scraped_until(here, lambda found: relayed(found) > 20)
    assert {name for name, _ in found if "link" in name} == set()
    assert {name for name, _ in found} >= {"testudo_rules_info", "testudo_memory_bytes", "testudo_cpu_ratio"}


def test_lost_messages_are_those_that_the_log_warns_of(robot: SmallRobot) -> None:
    running = robot.runtime("begin SetFrequency /imu Full end", "--openmetrics", "0")
    robot.operator(imu={"type": IMU})
    robot.source(imu={"type": IMU, "hz": 200})
    here, name = port_of(running), "testudo_topic_lost_messages_total"

    def total(found: Samples, of: str) -> float:
        return sum(number for (metric, _), number in found.items() if metric == of)

    scraped_until(here, lambda found: total(found, "testudo_topic_relayed_messages_total") > 20)
    running.signal(signal.SIGSTOP)
    time.sleep(2.0)
    running.signal(signal.SIGCONT)
    lost = re.search(r"/imu: lost (\d+) messages", running.line_with("before they could be relayed"))
    assert lost is not None
    scraped_until(here, lambda found: total(found, name) >= int(lost[1]) > 0)
