# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""Rules go from the page to a real robot, and what holds there is seen beside them."""

from __future__ import annotations

import re
import shutil
import signal
from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING

import pytest
from playwright.sync_api import Locator, expect

from axe import violations
from ros.ros_domains import free_domain
from ros.ros_processes import Process, SmallRobot
from ruler.browser.ruler_page import RulerPage

if TYPE_CHECKING:
    from playwright.sync_api import Browser

NOT_CONNECTED = re.compile(r"not connected|: silent for \d+ s")
IMU = "sensor_msgs/msg/Imu"
# Among the topics, not in the list of what was decided about it.
IMU_ROW = re.compile(r"^\/imu")
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


TIMED_RULES = """\
begin
    SetFrequency /imu 5

    Rule "Long"
    If (CheckValue /odom pose_x > 3 For 2 s AND (Not CheckValue /odom pose_x > 4) Within 10 min)
    Then
        SetFrequency /imu 10
    EndIf
end
"""


@dataclass(frozen=True, slots=True, kw_only=True)
class World:
    """A robot's sensors, and a Ruler that hears what runs beside them."""

    robot: SmallRobot
    source: Process
    project: Path
    url: str


@pytest.fixture(scope="module")
def world(ros: None, tmp_path_factory: pytest.TempPathFactory) -> Iterator[World]:
    project = tmp_path_factory.mktemp("project")
    (project / "patrol.adirf").write_text(RULES)
    (project / "timed.adirf").write_text(TIMED_RULES)
    with free_domain() as domain:
        robot = SmallRobot(domain, tmp_path_factory.mktemp("robot"))
        try:
            source = robot.source(imu={"type": IMU, "hz": 50}, odom={"type": ODOMETRY, "hz": 20})
            server = robot.testudo("ruler", str(project), "--port", "0", "--no-browser")
            url = server.line_with("http://").split(": ", 1)[1].split()[0]
            yield World(robot=robot, source=source, project=project, url=url)
        finally:
            robot.end()


@pytest.fixture
def page(browser: Browser, world: World) -> Iterator[RulerPage]:
    """The Ruler with the robot's rules open and the tab Robot chosen."""
    # What the test before did not save is open for everybody.
    shutil.rmtree(world.project / ".testudo" / "drafts", ignore_errors=True)
    context = browser.new_context(viewport={"width": 1440, "height": 900})
    page = RulerPage(context.new_page(), world.url)
    _reopen(page)
    yield page
    context.close()
    assert page.complaints == []
    foreign = [request for request in page.requests if not request.startswith((world.url, "data:", "blob:"))]
    assert foreign == []


@pytest.fixture
def runtime(world: World, page: RulerPage) -> Iterator[Process]:
    """``testudo run`` with the rules; the robot stands at x = 0. The next test begins when it is missed."""
    yield from _running(world, page)


@pytest.fixture
def consenting(world: World, page: RulerPage) -> Iterator[Process]:
    """The same, and its rule file may be written."""
    yield from _running(world, page, "--allow-writing-rules")


def _running(world: World, page: RulerPage, *arguments: str) -> Iterator[Process]:
    world.source.say("home odom")
    process = world.robot.runtime(RULES, *arguments)
    yield process
    process.signal(signal.SIGINT)
    process.exit_code()
    page.page.get_by_role("button", name=NOT_CONNECTED).wait_for()


@pytest.mark.journey
def test_what_holds_on_the_robot_stands_beside_the_blocks(
    page: RulerPage, world: World, runtime: Process
) -> None:
    operator = world.robot.operator(imu={"type": IMU})
    page.page.set_viewport_size({"width": 1280, "height": 900})
    expect(page.button("connected to /smarttestudo")).to_be_visible()
    expect(badge(page, "✗ false 0 m")).to_be_visible()
    expect(badge(page, "✗ does not hold")).to_be_visible()
    world.source.say("move odom")
    expect(badge(page, "✓ true 5 m")).to_be_visible()
    expect(badge(page, "✓ holds")).to_be_visible()
    row = page.page.get_by_role("row", name=IMU_ROW)
    expect(row).to_contain_text(re.compile(r"50\.\d\s*10\s*10\.\d.*Far\s*relayed", re.DOTALL))

    height = "document.querySelector('header').offsetHeight"
    before = page.page.evaluate(height)
    page.change("Edit value: 3", "4")
    assert page.page.evaluate(height) == before
    expect(page.page.get_by_text("The robot has other rules")).to_be_visible()
    expect(badge(page, "● differs from the robot")).to_be_visible()
    expect(any_badge(page)).to_have_count(1)
    page.tool("Undo").click()
    expect(badge(page, "✓ holds")).to_be_visible()

    runtime.signal(signal.SIGINT)
    assert runtime.exit_code() == 0
    expect(page.page.get_by_role("button", name=NOT_CONNECTED)).to_be_visible()
    expect(any_badge(page)).to_have_count(0)
    operator.end()


def test_how_long_a_timed_condition_has_held_stands_beside_its_block(page: RulerPage, world: World) -> None:
    world.source.say("home odom")
    process = world.robot.runtime(TIMED_RULES)
    page.home()
    page.open("timed.adirf")
    page.open_pane("Robot")
    expect(badge(page, "✗ false 0 m · ✗ does not hold now")).to_be_visible()
    expect(badge(page, "✓ holds now")).to_be_visible()
    world.source.say("move odom")
    held = page.blocks.get_by_role("img", name=re.compile(r"✓ true 5 m · ✓ holds for \d+ s$"))
    expect(held).to_be_visible()
    ago = page.blocks.get_by_role("img", name=re.compile(r": ✓ held \d+ m?s ago$"))
    expect(ago).to_be_visible()
    expect(badge(page, "✓ holds")).to_be_visible()
    process.signal(signal.SIGINT)
    process.exit_code()
    page.page.get_by_role("button", name=NOT_CONNECTED).wait_for()


def test_axe_finds_nothing_beside_a_robot(page: RulerPage, world: World, runtime: Process) -> None:
    operator = world.robot.operator(imu={"type": IMU})
    expect(badge(page, "✗ does not hold")).to_be_visible()
    assert violations(page.page) == []
    page.change("Edit rate: 5", "20")
    page.tool("Send to robot").click()
    expect(page.page.get_by_role("list", name="Differences")).to_be_visible()
    assert violations(page.page) == []
    page.button("Cancel").click()
    expect(page.tool("Send to robot")).to_be_focused()
    # The page has asked all that it asks by then.
    expect(page.page.get_by_text("The robot has other rules")).to_be_visible()
    operator.end()


@pytest.mark.journey
def test_sent_rules_are_compared_tried_and_kept_with_the_keyboard_alone(
    page: RulerPage, world: World, runtime: Process
) -> None:
    keyboard = page.page.keyboard
    operator = world.robot.operator(imu={"type": IMU, "messages": 40, "within_s": 2.2})
    expect(badge(page, "✗ does not hold")).to_be_visible()
    page.tool("Send to robot").focus()
    keyboard.press("Enter")
    expect(page.page.get_by_text("The robot already has these rules")).to_be_visible()
    keyboard.press("Escape")
    expect(page.tool("Send to robot")).to_be_focused()

    page.change("Edit rate: 5", "20")
    page.expect_lines("SetFrequency /imu 20")
    page.tool("Send to robot").focus()
    keyboard.press("Enter")
    expect(page.page.get_by_role("list", name="Differences")).to_have_text("default: /imu 5 → 20 Hz")
    page.walk("Tab", "Send")
    keyboard.press("Enter")
    expect(page.page.get_by_text(re.compile(r"Trial for \d+ s"))).to_be_visible()
    expect(page.page.get_by_role("row", name=IMU_ROW).get_by_role("cell").nth(1)).to_have_text("20")
    page.walk("Tab", "Keep these rules")
    keyboard.press("Enter")
    expect(page.page.get_by_text("/smarttestudo keeps these rules")).to_be_visible()
    # Two seconds of messages: the robot would wait ten for who keeps the rules.
    operator.line_with("heard")
    runtime.line_with("pushed rules confirmed")
    # The page has asked all that it asks by then.
    expect(page.button("Write to its file")).to_be_visible()
    expect(badge(page, "✗ does not hold")).to_be_visible()
    operator.end()


def test_kept_rules_are_called_kept_only_while_the_robot_follows_them(
    page: RulerPage, world: World, runtime: Process
) -> None:
    expect(badge(page, "✗ does not hold")).to_be_visible()
    # The step is named from the start; it is done once the robot has confirmed it.
    steps = page.page.get_by_role("list", name="Sending the rules").get_by_role("listitem")
    kept = steps.filter(has_text="Kept, done")
    page.change("Edit rate: 5", "20")
    page.expect_lines("SetFrequency /imu 20")
    _keep(page)
    expect(kept).to_be_visible()

    rules = max(world.robot.folder.glob("rules*.adirf"), key=lambda path: path.stat().st_mtime_ns)
    rules.write_text(RULES.replace("/imu 5", "/imu 6"))
    replaced = "/smarttestudo no longer follows the rules that were sent to it. It follows the rule files"
    expect(page.page.get_by_text(replaced)).to_be_visible()
    expect(kept).to_have_count(0)

    _keep(page)
    expect(kept).to_be_visible()
    runtime.signal(signal.SIGINT)
    runtime.exit_code()
    expect(page.page.get_by_text("Which rules it follows now is not known")).to_be_visible()
    expect(kept).to_have_count(0)
    # A page that asks in the moment in which the robot ends gets a 504, which Chromium logs.
    assert [complaint for complaint in page.complaints if "504" not in complaint] == []
    page.complaints.clear()


def test_what_kept_lasts_for_is_said_and_why_the_file_stays(page: RulerPage, runtime: Process) -> None:
    expect(badge(page, "✗ does not hold")).to_be_visible()
    page.change("Edit rate: 5", "20")
    page.expect_lines("SetFrequency /imu 20")
    _keep(page)
    expect(page.page.get_by_text("keeps these rules until its runtime ends or its file")).to_be_visible()
    expect(page.button("Write to its file")).to_be_disabled()
    expect(page.page.get_by_text("It was not started with --allow-writing-rules")).to_be_visible()
    assert violations(page.page) == []
    # The page has asked all that it asks by then.
    expect(badge(page, "✗ does not hold")).to_be_visible()


def test_kept_rules_are_written_to_the_file_of_a_robot_that_consents(
    page: RulerPage, world: World, consenting: Process
) -> None:
    expect(badge(page, "✗ does not hold")).to_be_visible()
    page.change("Edit rate: 5", "20")
    page.expect_lines("SetFrequency /imu 20")
    _keep(page)
    page.button("Write to its file").click()
    expect(page.page.get_by_text("keeps these rules, and wrote them to its file")).to_be_visible()
    consenting.line_with("pushed rules written to")
    rules = max(world.robot.folder.glob("rules*.adirf"), key=lambda path: path.stat().st_mtime_ns)
    assert "SetFrequency /imu 20" in rules.read_text()
    assert rules.with_name(f"{rules.name}.previous").read_text() == RULES
    expect(badge(page, "✗ does not hold")).to_be_visible()


def test_refused_rules_change_nothing_and_unkept_ones_go_back(
    page: RulerPage, world: World, runtime: Process
) -> None:
    expect(badge(page, "✗ does not hold")).to_be_visible()
    _append(page, "SetFrequency /imu 5", "x")
    page.tool("Send to robot").click()
    refusal = page.page.get_by_role("alert")
    expect(refusal).to_contain_text("Nothing was changed on the robot")
    refusal.get_by_role("button", name="line 2").click()
    expect(page.text).to_be_focused()
    page.page.keyboard.press("Control+z")

    # Only the robot knows that it would relay this into itself.
    _append(page, "SetFrequency /imu 5", " SetFrequency /testudo/imu 1")
    _send(page)
    expect(refusal).to_contain_text("/testudo/imu")
    assert [complaint for complaint in page.complaints if "422" not in complaint] == []
    page.complaints.clear()
    # What was left is in the house style, which is a step of its own.
    for _ in range(2):
        page.page.keyboard.press("Control+z")

    page.change("Edit rate: 5", "7")
    page.expect_lines("SetFrequency /imu 7")
    _send(page)
    target = page.page.get_by_role("row", name=IMU_ROW).get_by_role("cell").nth(1)
    expect(target).to_have_text("7")
    went_back = "/smarttestudo returned to its previous rules"
    expect(page.page.get_by_text(went_back)).to_be_visible()
    expect(target).to_have_text("5")
    expect(page.page.get_by_text("The robot has other rules")).to_be_visible()


def test_a_lost_confirmation_is_not_called_without_effect(
    page: RulerPage, world: World, runtime: Process
) -> None:
    expect(badge(page, "✗ does not hold")).to_be_visible()
    page.change("Edit rate: 5", "8")
    page.expect_lines("SetFrequency /imu 8")
    page.page.route("**/api/push/confirm", lambda route: route.abort())
    with page.page.expect_console_message(lambda message: "ERR_FAILED" in message.text):
        _keep(page)
    failure = page.page.get_by_role("alert")
    expect(failure).to_contain_text(
        "It is not known whether the rules were kept. If not, the robot reverts them"
    )
    expect(failure).not_to_contain_text("Nothing was changed")
    page.forgive("ERR_FAILED")
    # A page that compares rules while the robot ends gets a 504, which Chromium logs.
    page.home()


def test_topics_of_the_robot_are_suggested_and_measured(page: RulerPage, runtime: Process) -> None:
    expect(badge(page, "✗ does not hold")).to_be_visible()
    _append(page, "SetFrequency /imu 5", "\n    SetFrequency /od")
    expect(page.page.get_by_text("the blocks show how it was before")).to_be_visible()
    option = page.page.get_by_role("option", name=re.compile("odom.*on the robot now"))
    page.page.keyboard.press("Control+Space")
    expect(option).to_be_visible()
    page.page.keyboard.press("Escape")
    page.page.get_by_role("link", name="Create", exact=True).click()
    page.button("Measure on the robot").click()
    page.page.get_by_label("Seconds").fill("2")
    page.button("Measure").click()
    rate, size = (
        page.page.get_by_label(f"{column} of /imu") for column in ("Source (Hz)", "Message size (KB)")
    )
    expect(rate).to_have_value(re.compile(r"^[45]\d(\.\d+)?$"))
    expect(size).to_have_value(re.compile(r"^0\.3\d*$"))


def _reopen(page: RulerPage) -> None:
    page.home()
    page.open("patrol.adirf")
    page.open_pane("Robot")


def _append(page: RulerPage, line: str, text: str) -> None:
    page.text.get_by_text(line, exact=True).click()
    page.page.keyboard.press("End")
    # Keys with a pause between them would be several steps of undo.
    page.page.keyboard.insert_text(text)


def _send(page: RulerPage) -> None:
    page.tool("Send to robot").click()
    page.button("Send").click()


def _keep(page: RulerPage) -> None:
    _send(page)
    page.button("Keep these rules").click()


def any_badge(page: RulerPage) -> Locator:
    """The signs beside blocks."""
    return page.blocks.get_by_role("img", name="On the robot")


def badge(page: RulerPage, words: str) -> Locator:
    """The sign beside a block that says so."""
    return page.blocks.get_by_role("img", name=f"On the robot: {words}", exact=True)
