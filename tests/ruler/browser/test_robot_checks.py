# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""What a running robot's checks read, beside their thresholds, and when its rules held."""

from __future__ import annotations

import re
import signal
from collections.abc import Iterator
from pathlib import Path
from typing import TYPE_CHECKING

import pytest
from playwright.sync_api import Locator, expect

from axe import violations
from ros.ros_domains import free_domain
from ros.ros_processes import SmallRobot
from ruler.browser.ruler_page import EDGES, RulerPage

if TYPE_CHECKING:
    from playwright.sync_api import Browser

IMU, ODOMETRY = "sensor_msgs/msg/Imu", "nav_msgs/msg/Odometry"
RULES = """\
begin
    SetFrequency /imu 5

    Rule "Far"
    If (CheckValue /odom pose_x > 3 AND CheckValue /odom pose_y < 90)
    Then
        SetFrequency /imu 10
    EndIf
end
"""
CHECK = "/odom pose_x > 3 (Far)"


@pytest.fixture
def robot(ros: None, tmp_path: Path) -> Iterator[SmallRobot]:
    with free_domain() as domain:
        small_robot = SmallRobot(domain, tmp_path)
        yield small_robot
        small_robot.end()


@pytest.fixture
def options() -> tuple[str, ...]:
    """What the Ruler is started with, besides the project."""
    return ()


@pytest.fixture
def page(
    browser: Browser, robot: SmallRobot, tmp_path: Path, options: tuple[str, ...]
) -> Iterator[RulerPage]:
    """The Ruler beside a robot that stands at x = 0, and then at x = 5."""
    project = tmp_path / "project"
    project.mkdir()
    (project / "patrol.adirf").write_text(RULES)
    source = robot.source(imu={"type": IMU, "hz": 50}, odom={"type": ODOMETRY, "hz": 20})
    runtime = robot.runtime(RULES)
    server = robot.testudo("ruler", str(project), "--port", "0", "--no-browser", *options)
    url = server.line_with("http://").split(": ", 1)[1].split()[0]
    context = browser.new_context(viewport={"width": 1440, "height": 900})
    page = RulerPage(context.new_page(), url)
    page.home()
    page.page.evaluate("location.hash = '#/robots/%2Fsmarttestudo'")
    expect(far(page)).to_have_text(re.compile("does not hold.*Far"))
    source.say("move odom")
    expect(far(page)).to_have_text(re.compile("^holds.*Far"))
    yield page
    context.close()
    runtime.signal(signal.SIGINT)
    runtime.exit_code()
    assert page.complaints == []


@pytest.mark.journey
def test_the_page_of_a_robot_shows_a_value_its_threshold_and_when_each_rule_held(page: RulerPage) -> None:
    checks = section(page)
    bar = checks.get_by_role("img", name=re.compile(r"^Far: Holds for [\d.]+ s of 10 min; unknown for"))
    expect(bar).to_be_visible()
    checks.get_by_role("combobox", name="Value and threshold of").select_option(CHECK)
    chart = checks.get_by_role("figure", name="Value of /odom pose_x, threshold 3")
    expect(chart.locator("canvas")).to_be_visible()
    expect(chart.locator(".threshold-line")).to_be_visible()
    expect(checks.get_by_role("status")).to_have_text(
        re.compile(r"^> 3: Holds for [\d.]+ s of 10 min; unknown for .*, as the robot decided\.$")
    )
    # Beside its time is where it was then.
    expect(checks.get_by_role("application", name="Path of the robot")).to_be_visible()
    expect(checks.locator(".robot-place")).to_contain_text("The robot is at x 5.0 m")
    edges = checks.locator(".scrubber-track, .lane-plot, .lane .u-over").evaluate_all(EDGES)
    assert len(edges) == 5
    assert all(abs(one - other) <= 1 for edge in edges for one, other in zip(edge, edges[0], strict=True))
    # Nothing is open that could be changed.
    expect(checks.get_by_role("slider", name="Threshold")).to_have_count(0)

    checks.get_by_role("combobox", name="Shown").select_option("3600")
    expect(checks.get_by_role("img", name=re.compile(r"^Far: .* of 60 min"))).to_be_visible()
    # The bar moves the time that the rules are told of.
    checks.get_by_role("img", name=re.compile(r"^Far: ")).click()
    expect(far(page)).to_have_text(re.compile("^unknown.*Far"))
    assert violations(page.page) == []


def test_beside_the_same_rules_the_line_is_dragged_and_written_into_them(page: RulerPage) -> None:
    page.page.evaluate("location.hash = '#/rules/patrol.adirf'")
    page.open_pane("Robot")
    checks = section(page)
    checks.get_by_role("combobox", name="Value and threshold of").select_option(CHECK)
    line = checks.get_by_role("slider", name="Threshold")
    expect(line).to_have_attribute("aria-valuenow", "3")
    line.focus()
    # New values do not take the line out of the hand; a browser counts no more than 250 by itself.
    for _ in range(2):
        with page.page.expect_response("**/api/robot/checks"):
            pass
    page.page.keyboard.press("ArrowUp")
    expect(checks.get_by_role("status")).to_have_text(re.compile("^> 3: .*as the robot decided"))
    expect(line).not_to_have_attribute("aria-valuenow", "3")
    value = line.get_attribute("aria-valuenow")
    assert value is not None
    assert 3 < float(value) < 4
    checks.get_by_role("button", name=f"Write {value} into the rules").click()
    page.expect_lines(f"CheckValue /odom pose_x > {value}")
    expect(page.page.get_by_text("The robot has other rules")).to_be_visible()


@pytest.mark.parametrize("options", [("--watch-only",)])
def test_who_may_only_watch_sees_the_robot_and_changes_nothing_of_it(page: RulerPage) -> None:
    section(page).get_by_role("combobox", name="Value and threshold of").select_option(CHECK)
    expect(section(page).get_by_role("figure", name="Value of /odom pose_x, threshold 3")).to_be_visible()
    start = page.button("Start a project from this robot")
    expect(start).to_be_disabled()
    page.page.evaluate("location.hash = '#/rules/patrol.adirf'")
    expect(page.page.get_by_role("button", name="connected to /smarttestudo")).to_be_visible()
    expect(page.button("Send to robot")).to_be_disabled()
    expect(page.page.get_by_role("status").filter(has_text="You may only watch here.")).to_be_visible()


def section(page: RulerPage) -> Locator:
    return page.page.get_by_role("region", name="Rules and checks over time")


def far(page: RulerPage) -> Locator:
    return section(page).get_by_role("listitem")
