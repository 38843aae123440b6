# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""Rules are tried on a recording before they are shipped: what they save, decide and lose at each moment."""

from __future__ import annotations

import re
import shutil
from pathlib import Path

import pytest
from playwright.sync_api import Locator, expect

from axe import TWO_PICTURES
from bags.bag_factory import small_mission, write_bag
from link.zenoh.ends import until
from ruler.browser.held_child import child_of_server, first_held
from ruler.browser.ruler_page import RulerPage
from smarttestudo.ruler.answers.child_process import ChildWork

RULES = """\
begin
    SetFrequency /odom 5
    SetFrequency /scan 1
    Rule "Far"
    If (CheckValue /odom pose_y > 2)
    Then
        SetFrequency /scan 5
    EndIf
end
"""


@pytest.fixture
def project(tmp_path: Path) -> Path:
    """A robot that drives 8 m along y in 8 s, and rules about how far it is."""
    folder = tmp_path / "project"
    folder.mkdir()
    (folder / "far.adirf").write_text(RULES)
    write_bag(folder / "monday", small_mission(8))
    return folder


def test_one_scrubber_moves_the_robot_the_rates_the_rules_and_the_mark_in_the_text(ruler: RulerPage) -> None:
    _try_rules(ruler)
    page = ruler.page
    time_slider = page.get_by_role("slider", name="Time in the recording (s)")
    far = page.get_by_role("region", name="Rules at this time").get_by_role("listitem")
    scan = page.get_by_role("figure", name="Rate of /scan")
    decisions = page.get_by_role("region", name="Decisions").get_by_role("row")
    expect(page.get_by_role("application", name="Path of the robot")).to_be_visible()

    time_slider.press("End")
    expect(far).to_have_text(re.compile("holds.*Far.*decides /scan"))
    expect(scan).to_contain_text("5 Hz by Far")
    expect(page.get_by_text("The robot is at x 0.0 m, y 8.0 m")).to_be_visible()
    expect(time_slider).to_have_attribute("aria-valuetext", re.compile("Far decides"))
    expect(ruler.text.locator(".spot").first).to_contain_text('Rule "Far"')

    ruler.button("Decision before").click()
    ruler.button("Decision before").click()
    expect(far).to_have_text(re.compile("does not hold.*Far"))
    expect(scan).to_contain_text("1 Hz by default")
    expect(ruler.text.locator(".spot")).to_have_count(0)
    expect(decisions.and_(page.locator("[aria-current]")).filter(has_text="/scan")).to_contain_text("default")

    _press_at(scan.locator("canvas"), 0.9)
    expect(far).to_have_text(re.compile("holds.*Far"))
    place = page.get_by_text(re.compile(r"The robot is at x 0.0 m, y 7\.\d m"))
    expect(place).to_be_visible()

    page.set_viewport_size({"width": 1000, "height": 900})
    page.wait_for_function("() => innerWidth === 1000")
    # Charts follow the width of the window with the next picture.
    page.evaluate(TWO_PICTURES)
    rates = page.get_by_text("Rates (Hz) over time (s)").bounding_box()
    words = place.bounding_box()
    assert rates is not None
    assert words is not None
    assert words["x"] + words["width"] <= rates["x"]


def test_the_loss_stands_beside_and_old_numbers_say_that_they_are_old(ruler: RulerPage) -> None:
    _try_rules(ruler)
    loss = ruler.page.get_by_role("region", name="What the operator loses")
    errors = loss.get_by_role("table", name="Error when the last received value is held")
    expect(errors.get_by_role("row", name="/odom pose_y")).to_contain_text("m")
    expect(loss.get_by_role("table", name="Age of the newest message received")).to_contain_text("/scan")
    expect(loss.get_by_role("table", name="Thresholds of your checks")).to_contain_text("/odom pose_y > 2")
    loss.get_by_label("Error over time of").select_option("/odom pose_y")
    expect(loss.get_by_role("figure", name="Error of /odom pose_y")).to_be_visible()

    ruler.text.get_by_text("SetFrequency /odom 5").click()
    ruler.page.keyboard.press("End")
    ruler.page.keyboard.type("0")
    expect(ruler.page.get_by_text("Stale: rules changed since.")).to_be_visible()
    ruler.button("Run the rules on it").click()
    expect(ruler.page.get_by_text("Stale: rules changed since.")).to_have_count(0)


def test_a_result_stays_with_its_file_and_says_what_changed_since(ruler: RulerPage, project: Path) -> None:
    write_bag(project / "longer", small_mission(12))
    (project / "other.adirf").write_text("begin\n    SetFrequency /scan 1\nend\n")
    shutil.copy(project / "far.adirf", project / "monday.adirf")
    ruler.home()
    ruler.open("monday.adirf")
    ruler.tool("Try on a recording").click()
    # The one that the rules have their name from, though another is longer.
    expect(ruler.page.get_by_role("combobox", name="Recording")).to_have_value("monday")
    _try_rules(ruler)
    ruler.page.get_by_role("slider", name="Time in the recording (s)").press("End")
    replays = _asked(ruler, "api/try")

    ruler.page.get_by_role("link", name="Home").click()
    ruler.open("other.adirf")
    ruler.tool("Try on a recording").click()
    expect(ruler.page.get_by_text("% less sent")).to_have_count(0)
    ruler.page.get_by_role("link", name="Home").click()
    ruler.open("monday.adirf")
    ruler.tool("Try on a recording").click()
    expect(ruler.page.get_by_role("slider", name="Time in the recording (s)")).to_have_value("7.96")
    expect(ruler.page.get_by_text("Stale:")).to_have_count(0)
    assert _asked(ruler, "api/try") == replays

    shutil.rmtree(project / "monday")
    write_bag(project / "monday", small_mission(9))
    ruler.page.evaluate("dispatchEvent(new Event('focus'))")
    expect(ruler.page.get_by_text("Stale: recording changed since.")).to_be_visible()


def test_a_try_goes_on_while_another_page_is_looked_at(ruler: RulerPage) -> None:
    ruler.open("far.adirf")
    ruler.tool("Try on a recording").click()
    ruler.button("Run the rules on it").click()
    ruler.page.get_by_role("link", name="Home").click()
    ruler.open("far.adirf")
    ruler.tool("Try on a recording").click()
    expect(ruler.page.get_by_text("% less")).to_be_visible()
    assert _asked(ruler, "api/try") == 1


def test_gain_and_loss_stand_on_one_line_and_messages_are_sentences(ruler: RulerPage, project: Path) -> None:
    (project / "few.adirf").write_text(
        "begin\n    SetFrequency /image 1\n    SetFrequency /scan Marginal\nend\n"
    )
    ruler.home()
    ruler.open("few.adirf")
    expect(ruler.page.get_by_text("1 finding", exact=True)).to_have_count(1)
    finding = ruler.page.get_by_role("list", name="Findings").locator(".message")
    expect(finding).to_have_text([re.compile(r"^[A-Z/]")])
    ruler.text.get_by_text("SetFrequency /scan").click()
    ruler.page.keyboard.press("End")
    for _ in "Marginal":
        ruler.page.keyboard.press("Backspace")
    ruler.page.keyboard.type("Full")
    ruler.tool("Try on a recording").click()
    ruler.button("Run the rules on it").click()
    gain = re.compile(r"^[\d.]+ % less sent; /image: \d+ of \d+, dark for [\d.]+ s$")
    expect(ruler.page.get_by_text(gain)).to_be_visible()
    expect(ruler.page.get_by_text("The rules decided 2 times")).to_be_visible()


def test_a_threshold_that_is_dragged_says_when_it_would_have_held(ruler: RulerPage) -> None:
    _try_rules(ruler)
    rules = ruler.page.get_by_role("region", name="Rules at this time")
    expect(rules.get_by_role("img", name=re.compile(r"^Far: Holds for 5\.\d+ s of 7\.96 s"))).to_be_visible()

    why = ruler.page.get_by_role("region", name="Why this threshold")
    why.get_by_role("combobox").select_option("/odom pose_y > 2 (Far)")
    expect(why.get_by_role("figure", name="Value of /odom pose_y").locator("canvas")).to_be_visible()
    expect(why.get_by_role("status")).to_have_text(re.compile(r"^> 2: Holds for 5\.\d+ s of 7\.96 s"))
    line = why.get_by_role("slider", name="Threshold")
    line.hover()
    # The pointer may have scrolled the chart into view.
    box = why.locator(".u-over").bounding_box()
    assert box is not None
    ruler.page.mouse.down()
    ruler.page.mouse.move(box["x"] + box["width"] / 2, box["y"] + box["height"] / 2)
    ruler.page.mouse.up()
    expect(why.get_by_role("status")).to_have_text(
        re.compile(r"^> (3\.9|4).*: Holds for (3\.9|4).* s of 7\.96 s")
    )
    line.press("PageUp")
    expect(why.get_by_role("status")).to_have_text(
        re.compile(r"^> [45]\S*: Holds for [23]\.\d+ s of 7\.96 s")
    )

    # The bar of the condition moves the one time, as the charts do.
    _press_at(why.get_by_role("img", name=re.compile("^The condition: ")), 0.5)
    slider = ruler.page.get_by_role("slider", name="Time in the recording (s)")
    expect(slider).to_have_attribute("aria-valuetext", re.compile(r"^(3\.9|4\.0)"))

    value = line.get_attribute("aria-valuenow")
    why.get_by_role("button", name=re.compile("^Write .* into the rules$")).click()
    ruler.expect_lines(f"CheckValue /odom pose_y > {value}")
    expect(ruler.page.get_by_text("Stale: rules changed since.")).to_be_visible()


def test_cancel_ends_the_replay(ruler: RulerPage) -> None:
    ruler.open("far.adirf")
    ruler.tool("Try on a recording").click()
    with first_held(ChildWork.TRIAL) as replay:
        ruler.button("Run the rules on it").click()
        child = replay()
        expect(ruler.page.get_by_role("progressbar", name="Replaying monday")).to_be_visible()
        ruler.button("Cancel").click()
        expect(ruler.page.get_by_text("Cancelled.")).to_be_visible()
        until(lambda: child_of_server(ChildWork.TRIAL) != child)
    _try_rules(ruler)


def test_a_tier_without_parameters_says_what_can_be_done_on_the_page(ruler: RulerPage, project: Path) -> None:
    (project / "tier.adirf").write_text("begin\n    SetFrequency /odom Desirable\nend\n")
    ruler.home()
    ruler.open("tier.adirf")
    findings = ruler.page.get_by_role("list", name="Findings")
    expect(findings).to_contain_text("choose or create a profile")
    findings.get_by_role("link", name="Topic parameters").click()
    expect(ruler.page.get_by_role("heading", name="Topic parameters")).to_be_visible()


def test_a_telephone_looks_tries_and_sends(ruler: RulerPage) -> None:
    ruler.page.set_viewport_size({"width": 390, "height": 844})
    _try_rules(ruler)
    expect(ruler.page.get_by_text("% less sent")).to_be_in_viewport()
    ruler.page.get_by_role("button", name="Full screen: results").click()
    ruler.button("Next decision").click()
    expect(ruler.page.get_by_role("slider", name="Time in the recording (s)")).not_to_have_attribute(
        "aria-valuetext", re.compile(r"^0\.0 s")
    )
    ruler.page.get_by_role("button", name="Leave full screen: results").click()
    ruler.tool("Send to robot").click()
    expect(ruler.page.get_by_role("tab", name="Robot")).to_have_attribute("aria-selected", "true")
    expect(ruler.page.get_by_role("tabpanel", name="robot")).to_be_in_viewport()


def _try_rules(ruler: RulerPage) -> None:
    if ruler.page.get_by_role("link", name="far.adirf").count():
        ruler.open("far.adirf")
        ruler.tool("Try on a recording").click()
    ruler.button("Run the rules on it").click()
    expect(ruler.page.get_by_text(re.compile(r"[\d.]+ % less"))).to_be_visible()
    expect(ruler.page.get_by_text("The rules decided")).to_be_visible()


def _asked(ruler: RulerPage, path: str) -> int:
    """How often the page asked for that."""
    return ruler.requests.count(f"{ruler.url.rstrip('/')}/{path}")


def _press_at(chart: Locator, share: float) -> None:
    """Press where this share of the chart is left of."""
    box = chart.bounding_box()
    assert box is not None
    chart.click(position={"x": box["width"] * share, "y": box["height"] / 2}, force=True)
