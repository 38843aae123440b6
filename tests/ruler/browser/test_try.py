# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""Rules are tried on a recording before they are shipped: what they save, decide and lose at each moment."""

from __future__ import annotations

import re
from pathlib import Path

import pytest
from playwright.sync_api import Locator, expect

from axe import TWO_PICTURES
from bags.bag_factory import small_mission, write_bag
from link.zenoh.ends import until
from ruler.browser.held_child import child_of_server, first_held
from ruler.browser.ruler_page import RulerPage
from smarttestudo.ruler.tries.try_rules import try_on

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


@pytest.mark.journey
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
    rates = scan.locator("canvas").bounding_box()
    words = place.bounding_box()
    assert rates is not None
    assert words is not None
    assert rates["x"] + rates["width"] <= words["x"]


@pytest.mark.journey
def test_cancel_ends_the_replay(ruler: RulerPage) -> None:
    ruler.open("far.adirf")
    ruler.open_pane("Try on a recording")
    with first_held(try_on) as replay:
        ruler.button("Run the rules on it").click()
        child = replay()
        expect(ruler.page.get_by_role("progressbar", name="Replaying monday")).to_be_visible()
        ruler.button("Cancel").click()
        expect(ruler.page.get_by_text("Cancelled.")).to_be_visible()
        until(lambda: child_of_server(try_on) != child)
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
    expect(ruler.pane("Robot")).to_have_attribute("aria-expanded", "true")
    expect(ruler.page.get_by_role("region", name="Results")).to_be_in_viewport()


def _try_rules(ruler: RulerPage) -> None:
    if ruler.page.get_by_role("link", name="far.adirf").count():
        ruler.open("far.adirf")
        ruler.open_pane("Try on a recording")
    ruler.button("Run the rules on it").click()
    expect(ruler.page.get_by_text(re.compile(r"[\d.]+ % less"))).to_be_visible()
    expect(ruler.page.get_by_text("The rules decided")).to_be_visible()


def _press_at(chart: Locator, share: float) -> None:
    """Press where this share of the chart is left of."""
    box = chart.bounding_box()
    assert box is not None
    chart.click(position={"x": box["width"] * share, "y": box["height"] / 2}, force=True)
