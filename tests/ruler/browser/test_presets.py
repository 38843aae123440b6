# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""The thesis's case by hand, from a preset: rule, table, rates, a thinner link, and rules that fit it."""

from __future__ import annotations

from pathlib import Path

import pytest
from playwright.sync_api import expect

from ruler.browser.counted_page import CountedPage
from ruler.browser.ruler_page import RulerPage
from ruler.browser.thesis import DEFAULT_RATES, build_rule
from smarttestudo.rules.profile_file import load_profile

MOST_CLICKS = 25
MOST_KEYS = 60
BUDGET = "Budget: total bandwidth (KB/s)"


@pytest.fixture
def project(tmp_path: Path) -> Path:
    """A project without a file."""
    (tmp_path / "project").mkdir()
    return tmp_path / "project"


def test_the_thesis_case_from_a_preset_takes_few_clicks_and_keys(ruler: RulerPage, project: Path) -> None:
    me = CountedPage(ruler.page)
    me.click("button", "New Rule File")
    me.type("shelf")
    me.press("Enter")
    build_rule(me)
    ruler.expect_lines("SetFrequency /camera/image_raw Excessive")
    _fill_from_a_preset(ruler, me)
    _add_two_defaults(ruler, me)
    with ruler.page.expect_download() as waiting:
        me.click("button", "Optimize and Download")
    rates = waiting.value.path().read_text()
    # The thesis calls this topic otherwise than a robot does, and two defaults stand in the rules.
    named = {topic.replace("joint_state", "joint_states"): rate for topic, rate in DEFAULT_RATES.items()}
    for topic, rate_hz in named.items():
        assert f"SetFrequency {topic} {rate_hz}" in rates
    assert "SetFrequency /imu 200\n        SetFrequency /camera/image_raw 35\n" in rates
    expect(ruler.page.get_by_text("219 881.72 of 275 000 KB/s").first).to_be_visible()
    _fit_a_thin_link(ruler, me)
    rules = (project / "shelf.adirf").read_text()
    assert "SetFrequency /camera/image_raw Excessive" not in rules
    profile = load_profile(project / "shelf.toml")
    assert profile.budget_kb_per_s == 15000
    assert profile.topics.keys() == named.keys()
    assert not any(topic.measured for topic in profile.topics.values())
    assert me.clicks <= MOST_CLICKS, me.done
    assert me.keys <= MOST_KEYS, me.done


def _fill_from_a_preset(ruler: RulerPage, me: CountedPage) -> None:
    me.click("link", "Create")
    expect(ruler.page.get_by_label("Topic of row 3")).to_have_value("/odom")
    me.click("button", "From a preset")
    me.click("radio", "TurtleBot3 in Gazebo…")
    me.click("button", "Fill")
    me.sees("Filled from TurtleBot3 in Gazebo: not measured")
    me.click("textbox", BUDGET)
    me.type("275000")
    _save_and_go_back(ruler, me)


def _add_two_defaults(ruler: RulerPage, me: CountedPage) -> None:
    expect(ruler.page.get_by_label("Findings").last).to_contain_text("from a preset, not measured")
    me.click("button", "add SetFrequency /imu Unacceptable, up to 50 Hz")
    ruler.expect_lines("SetFrequency /imu Unacceptable")
    me.click("button", "add SetFrequency /camera/image_raw Unacceptable, up to 2 Hz")
    ruler.expect_lines("SetFrequency /camera/image_raw Unacceptable")


def _fit_a_thin_link(ruler: RulerPage, me: CountedPage) -> None:
    me.click("link", "Edit")
    me.click("textbox", BUDGET)
    me.press("Control+a")
    me.type("15000")
    _save_and_go_back(ruler, me)
    me.click("button", str(ruler.page.locator(".budget-bar").text_content()))
    refused = ruler.page.get_by_role("alert").get_by_role("button").first
    me.click("button", str(refused.text_content()))
    me.sees("Everything fits into 15 000 KB/s")
    me.press("Escape")
    me.click("button", "Save")
    me.sees("Saved shelf.adirf")


def _save_and_go_back(ruler: RulerPage, me: CountedPage) -> None:
    me.click("button", "Save")
    me.sees("Saved shelf.toml")
    me.click("link", "Back to shelf.adirf")
    expect(ruler.page.get_by_label("Profile (topic parameters)")).to_have_value("shelf.toml")
