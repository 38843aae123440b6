# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""Rules go from the page to a real robot, and what holds there is seen beside them."""

from __future__ import annotations

import importlib.util
import re
from collections.abc import Iterator
from pathlib import Path
from typing import TYPE_CHECKING

import pytest
from playwright.sync_api import Locator, expect

from ros.conftest import free_domain
from ros.ros_processes import Process, SmallRobot
from ruler.browser.ruler_page import RulerPage

if TYPE_CHECKING:
    from playwright.sync_api import Browser

IMU = "sensor_msgs/msg/Imu"
ODOMETRY = "nav_msgs/msg/Odometry"
RULES = """\
begin
    SetFrequency /imu 5

    Rule "Far"
    If (CheckValue /odom pose_x > 3)
    Then
        SetFrequency /imu 10
    EndIf
end
"""


@pytest.fixture
def robot(tmp_path: Path) -> Iterator[SmallRobot]:
    if importlib.util.find_spec("rclpy") is None:
        pytest.skip("ROS 2 (rclpy) is not installed")
    with free_domain() as domain:
        (tmp_path / "robot").mkdir()
        small_robot = SmallRobot(domain, tmp_path / "robot")
        yield small_robot
        small_robot.end()


@pytest.fixture
def source(robot: SmallRobot) -> Process:
    """The robot's sensors; it stands at x = 0 until it is told to move."""
    return robot.source(imu={"type": IMU, "hz": 50}, odom={"type": ODOMETRY, "hz": 20})


@pytest.fixture
def page(browser: Browser, robot: SmallRobot, tmp_path: Path) -> Iterator[RulerPage]:
    """The Ruler beside the robot, with the robot's rules open and the tab Robot chosen."""
    project = tmp_path / "project"
    project.mkdir()
    (project / "patrol.adirf").write_text(RULES)
    server = robot.testudo("ruler", str(project), "--port", "0", "--no-browser")
    url = server.line_with("http://").split(": ", 1)[1].split()[0]
    context = browser.new_context(viewport={"width": 1440, "height": 900})
    page = RulerPage(context.new_page(), url)
    page.home()
    page.open("patrol.adirf")
    page.page.get_by_role("tab", name="Robot", exact=True).click()
    yield page
    context.close()
    assert page.complaints == []
    assert [request for request in page.requests if not request.startswith((url, "data:", "blob:"))] == []


def test_what_holds_on_the_robot_stands_beside_the_blocks(
    page: RulerPage, robot: SmallRobot, source: Process
) -> None:
    expect(page.button("not connected")).to_be_visible()
    operator = robot.operator(imu={"type": IMU})
    runtime = robot.runtime(RULES)
    expect(page.button("connected to /smarttestudo")).to_be_visible()
    expect(badge(page, "✗ false 0 m")).to_be_visible()
    expect(badge(page, "✗ does not hold")).to_be_visible()
    source.say("move odom")
    expect(badge(page, "✓ true 5 m")).to_be_visible()
    expect(badge(page, "✓ holds")).to_be_visible()
    row = page.page.get_by_role("row", name="/imu")
    expect(row).to_contain_text(re.compile(r"50\.\d.*10.*10\.\d.*Far.*relayed"))

    page.change("Edit value: 3", "4")
    expect(page.page.get_by_text("The robot has other rules")).to_be_visible()
    expect(badge(page, "")).to_have_count(0)
    page.button("Undo").click()
    expect(badge(page, "✓ holds")).to_be_visible()
    runtime.end()
    expect(page.page.get_by_role("button", name=re.compile(r"robot silent for \d+ s"))).to_be_visible()
    expect(badge(page, "")).to_have_count(0)
    del operator


def test_sent_rules_are_compared_tried_and_kept(page: RulerPage, robot: SmallRobot, source: Process) -> None:
    operator = robot.operator(imu={"type": IMU, "messages": 40, "within_s": 2.2})
    runtime = robot.runtime(RULES)
    expect(badge(page, "✗ does not hold")).to_be_visible()
    page.button("Send to robot").click()
    expect(page.page.get_by_text("Nothing differs: nothing to send")).to_be_visible()
    page.button("Close").click()

    page.change("Edit rate: 5", "20")
    page.button("Send to robot").click()
    expect(page.page.get_by_role("list", name="Differences")).to_have_text("default: /imu 5 → 20 Hz")
    page.button("Send").click()
    expect(page.page.get_by_text(re.compile(r"Holds now, for \d+ s"))).to_be_visible()
    operator.line_with("heard")
    page.button("Keep these rules").click()
    expect(page.page.get_by_text("/smarttestudo keeps these rules")).to_be_visible()
    runtime.line_with("pushed rules confirmed")


def test_broken_rules_are_not_sent_and_unkept_ones_go_back(
    page: RulerPage, robot: SmallRobot, source: Process
) -> None:
    operator = robot.operator(imu={"type": IMU})
    robot.runtime(RULES)
    expect(badge(page, "✗ does not hold")).to_be_visible()
    page.text.get_by_text("SetFrequency /imu 5", exact=True).click()
    page.page.keyboard.press("End")
    page.page.keyboard.type("x")
    page.button("Send to robot").click()
    refusal = page.page.get_by_role("alert")
    expect(refusal).to_contain_text("Nothing was changed on the robot")
    refusal.get_by_role("button", name="line 2").click()
    expect(page.text).to_be_focused()
    page.page.keyboard.press("Control+z")

    page.change("Edit rate: 5", "7")
    page.button("Send to robot").click()
    page.button("Send").click()
    row = page.page.get_by_role("row", name="/imu")
    expect(row.get_by_role("cell", name="7", exact=True)).to_be_visible()
    expect(
        page.page.get_by_text("/smarttestudo went back to the rules from before by itself")
    ).to_be_visible()
    expect(row.get_by_role("cell", name="5", exact=True)).to_be_visible()
    del operator


def badge(page: RulerPage, words: str) -> Locator:
    """The signs beside blocks that say so; all of them for an empty text."""
    return page.blocks.get_by_role("img", name=f"On the robot: {words}", exact=words != "")
