# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""The page of all robots, for none, one and twenty, and the link of one in the tab Robot."""

from __future__ import annotations

import json
import re
import sys
from collections.abc import Iterator, Sequence
from dataclasses import replace
from pathlib import Path
from typing import TYPE_CHECKING

import pytest
from playwright.sync_api import Locator, expect

from axe import violations
from link.zenoh.ends import until
from robot.status.statuses import RELAYED, STATUS
from ros.ros_domains import free_domain
from ros.ros_processes import Process, SmallRobot
from ruler.browser.ruler_page import RulerPage
from smarttestudo.domain.decision import Reason
from smarttestudo.domain.incident import IncidentState
from smarttestudo.domain.json_text import json_text
from smarttestudo.domain.link import CommandTopic, LinkState, StreamCounts, TopicOnLink
from smarttestudo.domain.record import to_json
from smarttestudo.domain.status import Fallback, RulesInForce, RulesOrigin, RuntimeStatus
from smarttestudo.rules.profile_file import load_profile

if TYPE_CHECKING:
    from playwright.sync_api import Browser

FLEET = Path(__file__).with_name("fleet.py")
RULES = "begin\n    SetFrequency /imu 5\nend\n"
IMU = "sensor_msgs/msg/Imu"
LINK = LinkState(is_connected=True, capacity_kb_per_s=231.5, round_trip_ms=24.0, outages=2)
INCIDENTS = IncidentState(held_bytes=1_000_000, memory_bytes=256_000_000, topics=2, recorded=3)
# Rows stay as they are then, and robots that a busy machine has not heard for a moment stand above.
FOCUS_IN_ROW = """([place, words]) => {
    const link = document.querySelectorAll(".robot-table tbody tr")[place]?.querySelector("a");
    if (!link?.textContent.includes(words)) return false;
    link.focus();
    return true;
}"""
PHONE, DESK = (390, 844), (1280, 800)


def status(number: int, age_ms: float | None = None) -> RuntimeStatus:
    """A robot that is well; the last message of a topic was ``age_ms`` old."""
    on_link = TopicOnLink(
        counts=StreamCounts(sent=480, replaced=20, queued_bytes=1200),
        age_ms=20.0 + number if age_ms is None else age_ms,
    )
    newer = replace(on_link, age_ms=1.0)
    return replace(
        STATUS,
        node=f"/r{number:02}/smarttestudo",
        rules=RulesInForce(paths=("/etc/testudo/patrol.adirf",), sha256="0f" * 32),
        link=LINK,
        topics={"/imu": replace(RELAYED, on_link=newer), "/scan": replace(RELAYED, on_link=on_link)},
        blocks=(),
    )


def publish(fleet: Process, statuses: Sequence[RuntimeStatus]) -> None:
    fleet.say(json.dumps([json_text(to_json(one)) for one in statuses]))


@pytest.fixture
def robot(ros: None, tmp_path: Path) -> Iterator[SmallRobot]:
    with free_domain() as domain:
        small_robot = SmallRobot(domain, tmp_path)
        yield small_robot
        small_robot.end()


@pytest.fixture
def page(browser: Browser, robot: SmallRobot, tmp_path: Path) -> Iterator[RulerPage]:
    """The page of all robots, of a project with rules."""
    project = tmp_path / "project"
    project.mkdir()
    (project / "patrol.adirf").write_text(RULES)
    server = robot.testudo("ruler", str(project), "--port", "0", "--no-browser")
    url = server.line_with("http://").split(": ", 1)[1].split()[0]
    context = browser.new_context(viewport={"width": DESK[0], "height": DESK[1]})
    page = RulerPage(context.new_page(), url)
    page.home()
    page.page.get_by_role("link", name="Robots").click()
    yield page
    context.close()
    assert page.complaints == []


@pytest.fixture
def fleet(robot: SmallRobot) -> Process:
    return robot.command(sys.executable, str(FLEET))


def rows(page: RulerPage) -> Locator:
    return page.page.get_by_role("table", name="Robots").locator("tbody").get_by_role("row")


def has_no_sideways_scroll(page: RulerPage) -> bool:
    return bool(page.page.evaluate("document.documentElement.scrollWidth <= innerWidth"))


def test_without_robots_it_says_what_to_start(page: RulerPage) -> None:
    hint = page.page.get_by_role("main").get_by_text("Start 'testudo run' on the robot")
    expect(hint).to_be_visible()
    assert page.page.url.endswith("#/robots/")


def test_twenty_robots_are_ordered_by_trouble_and_stay_in_place_under_the_keyboard(
    page: RulerPage, fleet: Process
) -> None:
    late = status(7, age_ms=2500.0)
    lost = replace(late.topics["/scan"].on_link, counts=StreamCounts(overflowed=3, is_losing=True))  # type: ignore[type-var]
    robots = [status(number) for number in range(20)]
    robots[7] = late
    robots[3] = replace(robots[3], link=replace(LINK, is_connected=False))
    robots[5] = replace(robots[5], topics={"/scan": replace(RELAYED, on_link=lost)})
    robots[9] = replace(robots[9], budget_kb_per_s=10.0)
    publish(fleet, robots)
    expect(rows(page)).to_have_count(20)
    expect(page.page.get_by_text("20 robots, 4 with trouble")).to_be_visible()
    for place, words in enumerate(
        [
            r"/r03/.*no operator is connected over the link",
            r"/r05/.*lost on the link: /scan",
            r"/r07/.*late: /scan",
            r"/r09/.*over budget: 32.0 of 10.0 KB/s",
            r"/r00/.*relays 2 topics.*now.*232 KB/s, round trip 24 ms, 2 outages.*32 of 1 000 KB/s.*patrol",
            r"/r01/.*relays 2 topics",
        ]
    ):
        expect(rows(page).nth(place)).to_contain_text(re.compile(words, re.DOTALL))

    page.page.wait_for_function(FOCUS_IN_ROW, arg=[4, "/r00/"])
    robots[1] = replace(robots[1], link=replace(LINK, is_connected=False))
    publish(fleet, robots)
    expect(page.page.get_by_role("row", name="/r01/")).to_contain_text("no operator connected")
    expect(rows(page).nth(5)).to_contain_text("/r01/")
    page.page.get_by_label("Only those with trouble").focus()
    expect(rows(page).nth(0)).to_contain_text("/r01/")

    publish(fleet, robots[:19])
    expect(rows(page).nth(0)).to_contain_text(re.compile(r"/r19/.*silent for \d+ s"))
    page.page.get_by_label("Only those with trouble").check()
    expect(rows(page)).to_have_count(6)

    page.page.set_viewport_size({"width": PHONE[0], "height": PHONE[1]})
    page.page.wait_for_function(f"() => innerWidth === {PHONE[0]}")
    expect(rows(page)).to_have_count(6)
    until(lambda: has_no_sideways_scroll(page))
    expect(page.page.get_by_role("row", name="/r05/").get_by_role("cell").first).to_be_visible()


def test_axe_finds_nothing_on_robots_that_are_well_or_not(page: RulerPage, fleet: Process) -> None:
    robots = [status(number) for number in range(4)]
    robots[1] = replace(robots[1], link=replace(LINK, is_connected=False))
    robots[2] = replace(robots[2], budget_kb_per_s=10.0)
    publish(fleet, robots)
    expect(rows(page)).to_have_count(4)
    publish(fleet, robots[:3])
    expect(rows(page).nth(0)).to_contain_text(re.compile(r"/r03/.*silent for \d+ s"))
    assert violations(page.page) == []


def test_rules_that_wait_or_were_pushed_are_told_apart(page: RulerPage, fleet: Process) -> None:
    waiting = RulesInForce(sha256="ab" * 32, origin=RulesOrigin.WAITING, waits_s=8.0)
    pushed = RulesInForce(sha256="cd" * 32, origin=RulesOrigin.PUSHED)
    everything = RulesInForce(origin=RulesOrigin.FALLBACK)
    nothing = RulesInForce(origin=RulesOrigin.FALLBACK, fallback=Fallback.OFF)
    origins = (waiting, pushed, everything, nothing)
    publish(fleet, [replace(status(number), rules=rules) for number, rules in enumerate(origins)])
    expect(page.page.get_by_role("row", name="/r00/")).to_contain_text(
        re.compile(r"waiting to be confirmed, \d s left")
    )
    expect(page.page.get_by_role("row", name="/r01/")).to_contain_text("pushed")
    expect(page.page.get_by_role("row", name="/r02/")).to_contain_text("none: everything is relayed")
    expect(page.page.get_by_role("row", name="/r03/")).to_contain_text("none: nothing is relayed")


def test_a_robot_without_valid_rules_is_an_error_wherever_it_is_named_and_once_it_ended(
    page: RulerPage, fleet: Process
) -> None:
    broken = replace(status(0), rules=RulesInForce(origin=RulesOrigin.FALLBACK))
    publish(fleet, [broken])
    pill = page.page.get_by_role("button", name="/r00/smarttestudo: no valid rules")
    expect(pill).to_have_css("color", colour_of(page, "--error"))
    trouble = rows(page).first.get_by_text("no valid rules: everything is relayed")
    expect(trouble).to_have_css("color", colour_of(page, "--error"))
    open_alone(page)
    expect(page.page.get_by_role("alert").get_by_text("It has no valid rules")).to_be_visible()
    publish(fleet, [])
    silent = page.page.get_by_role("button", name=re.compile(r"r00.smarttestudo: silent for"))
    expect(silent).to_have_css("color", colour_of(page, "--error"))
    page.page.reload()
    expect(page.page).to_have_title(re.compile(r"✕ .r00.smarttestudo: silent for"))
    page.page.get_by_role("link", name="Robots").click()
    page.page.get_by_role("button", name="Remove /r00/smarttestudo").click()
    expect(page.page.get_by_role("main").get_by_text("Start 'testudo run' on the robot")).to_be_visible()


def test_the_page_says_of_a_robot_what_top_and_diagnostics_say(page: RulerPage, fleet: Process) -> None:
    imu = replace(RELAYED, incompatible=("/rviz",))
    robot = replace(
        status(0),
        floors_break_budget=True,
        topics={"/imu": imu, "/scan": replace(RELAYED, error_percent=-30.0, keeps_rate=False)},
        accepted=(
            CommandTopic(topic="/cmd_vel"),
            CommandTopic(topic="/goal", type_name="x/msg/Y", delivered=3),
        ),
        incidents=replace(INCIDENTS, problem="the disk is full"),
    )
    publish(fleet, [robot])
    floors = "the floors alone are more than the budget"
    pill = page.page.get_by_role("button", name=f"/r00/smarttestudo: {floors}")
    expect(pill).to_have_css("color", colour_of(page, "--error"))
    expect(rows(page).first.get_by_text(floors, exact=True)).to_have_css("color", colour_of(page, "--error"))
    open_alone(page)
    expect(page.page.get_by_role("alert").filter(has_text="The floors alone are more")).to_be_visible()
    topics = page.page.get_by_role("table", name="Topics of the robot")
    expect(topics.get_by_role("row", name="/imu")).to_contain_text("incompatible QoS: /rviz")
    expect(topics.get_by_role("row", name="/scan")).to_contain_text("rate off: -30.0 %")
    for name, words in (
        ("Accepts /cmd_vel", "no node subscribes to it"),
        ("Accepts /goal", "3 delivered, 0 too old, 0 refused"),
        ("Records", "2 topics in 1.0 of 256 MB; incidents: 0 open, 3 recorded: the disk is full"),
    ):
        expect(page.page.locator(f".robot-totals div:has(dt:text-is('{name}')) dd")).to_have_text(words)


def test_a_project_starts_from_what_a_robot_relays(page: RulerPage, fleet: Process, tmp_path: Path) -> None:
    publish(fleet, [status(0)])
    expect(rows(page)).to_have_count(1)
    open_alone(page)
    page.page.get_by_role("button", name="Start a project from this robot").click()
    dialog = page.page.get_by_role("dialog")
    expect(dialog.get_by_text("2 topics relayed now.")).to_be_visible()
    dialog.get_by_role("button", name="Create").click()
    expect(page.page.get_by_role("region", name="Blocks", exact=True)).to_be_visible()
    rules = (tmp_path / "project" / "r00.adirf").read_text()
    assert rules.endswith("begin\n    SetFrequency /imu Full\n    SetFrequency /scan Full\nend\n")
    profile = load_profile(tmp_path / "project" / "r00.toml")
    assert profile.budget_kb_per_s == 1000.0
    imu = profile.topic("/imu")
    assert (imu.type_name, imu.source_hz, imu.message_kb) == (IMU, 195.0, 0.32)
    assert imu.tiers_hz is not None


def test_what_a_robot_decided_before_somebody_looked_is_told(page: RulerPage, fleet: Process) -> None:
    one = status(0)
    publish(fleet, [one])
    expect(rows(page)).to_have_count(1)
    slower = replace(one.topics["/imu"], target_hz=5.0, rule="Bay", reason=Reason.BLOCK)
    publish(fleet, [replace(one, topics={**one.topics, "/imu": slower}, budget_kb_per_s=500.0)])
    expect(rows(page).first).to_contain_text("of 500 KB/s")
    open_alone(page)
    changes = page.page.get_by_role("table", name="Changes of the last hour")
    expect(changes.get_by_role("row", name="/imu")).to_contain_text(re.compile(r"50 Hz\s*5 Hz\s*Bay"))


def open_alone(page: RulerPage) -> None:
    """The page of the first robot, without rules beside it."""
    page.page.evaluate("location.hash = '#/robots/%2Fr00%2Fsmarttestudo'")


def colour_of(page: RulerPage, name: str) -> str:
    return str(
        page.page.evaluate(
            """name => {
              const probe = document.body.appendChild(document.createElement('i'));
              probe.style.color = `var(${name})`;
              const colour = getComputedStyle(probe).color;
              probe.remove();
              return colour;
            }""",
            name,
        )
    )


def test_the_keyboard_opens_a_robot_beside_its_rules_with_the_link_of_each_topic(
    page: RulerPage, fleet: Process
) -> None:
    unlinked = replace(status(0), link=None, topics={"/imu": RELAYED})
    publish(fleet, [unlinked, status(1, age_ms=312.4)])
    expect(rows(page)).to_have_count(2)
    page.page.get_by_role("link", name="/r01/smarttestudo").focus()
    page.page.keyboard.press("Enter")
    page.page.get_by_role("link", name="Open patrol.adirf").focus()
    page.page.keyboard.press("Enter")
    expect(page.pane("Robot")).to_have_attribute("aria-expanded", "true")
    topics = page.page.get_by_role("table", name="Topics of the robot")
    expect(topics.get_by_role("row", name="/scan")).to_contain_text(
        re.compile(r"16\.0\s*312\s*20, 0, 0\s*1\.2\s*–.*relayed")
    )
    expect(page.page.get_by_text("232 KB/s, round trip 24 ms, 2 outages")).to_be_visible()
    assert page.page.url.endswith("#/rules/patrol.adirf?robot=%2Fr01%2Fsmarttestudo")

    page.page.get_by_role("combobox", name="Robot").select_option("/r00/smarttestudo")
    expect(topics.get_by_role("row", name="/scan")).to_have_count(0)
    expect(topics.get_by_role("columnheader")).to_have_count(8)
    page.page.get_by_role("link", name="Robots").click()
    expect(rows(page)).to_have_count(2)


def test_sixty_topics_with_long_names_stay_on_the_screen(page: RulerPage, fleet: Process) -> None:
    names = [f"/warehouse_robot_{n:02}/camera_front_left/depth_registered/image_rect_raw" for n in range(60)]
    one = status(0)
    publish(fleet, [replace(one, topics=dict.fromkeys(names, one.topics["/scan"]))])
    page.page.get_by_role("link", name="/r00/smarttestudo").click()
    topics = page.page.get_by_role("table", name="Topics of the robot")
    expect(topics.locator("tbody").get_by_role("row")).to_have_count(60)
    until(lambda: has_no_sideways_scroll(page))
    box = topics.bounding_box()
    assert box is not None
    assert box["x"] + box["width"] <= DESK[0]


@pytest.mark.journey
def test_a_real_run_is_a_row_and_without_rules_in_the_project_has_a_page_of_its_own(
    browser: Browser, robot: SmallRobot, tmp_path: Path
) -> None:
    robot.runtime(RULES)
    robot.operator(imu={"type": IMU})
    robot.source(imu={"type": IMU, "hz": 50})
    (tmp_path / "empty").mkdir()
    server = robot.testudo("ruler", str(tmp_path / "empty"), "--port", "0", "--no-browser")
    url = server.line_with("http://").split(": ", 1)[1].split()[0]
    tab = browser.new_page()
    tab.goto(f"{url}#/robots/")
    row = tab.get_by_role("row", name="/smarttestudo")
    expect(row).to_contain_text(re.compile(r"relays 1 topic.*none.*no budget"))
    row.get_by_role("link").click()
    topics = tab.get_by_role("table", name="Topics of the robot")
    expect(topics.get_by_role("row", name="/imu")).to_contain_text(re.compile(r"5\s*5\.\d"))
    tab.close()
