# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""The six accuracies of a topic are set on the curve of the messages that each needs."""

from __future__ import annotations

from pathlib import Path

import pytest
from playwright.sync_api import Locator, expect

from bags.bag_factory import small_mission, write_bag
from ruler.browser.ruler_page import RulerPage
from smarttestudo.domain.accuracy import AccuracyTiers, LevelledProperty
from smarttestudo.rules.profile_file import load_profile

PROFILE = """\
[topics."/odom"]
message_kb = 0.7

[topics."/scan"]
type = "sensor_msgs/msg/LaserScan"
"""
TIERS = "tiers_m = [0.5, 0.2, 0.1, 0.05, 0.02, 0.01]  # our arm's reach\n"
NEEDS = "tiers_m_need_hz = [0.6, 1, 2, 4, 8, 12]\n"


@pytest.fixture
def project(tmp_path: Path) -> Path:
    folder = tmp_path / "project"
    folder.mkdir()
    (folder / "radio.toml").write_text(PROFILE)
    write_bag(folder / "monday", small_mission(8))
    return folder


def test_levels_are_placed_on_the_measured_curve_dragged_and_saved(ruler: RulerPage, project: Path) -> None:
    _open(ruler)
    ruler.page.get_by_role("combobox", name="Recording").select_option("monday")
    ruler.button("Show what each accuracy needs").click()
    expect(ruler.page.get_by_text("Dashed: it shows dead reckoning.")).to_be_visible()
    ruler.page.get_by_text("The curve as numbers").click()
    expect(ruler.page.get_by_role("row", name="0.05").first).to_be_visible()
    ruler.button("Place six levels").click()
    line = _line(ruler, "Marginal")
    expect(line).to_have_attribute("aria-valuetext", "0.2 m")
    expect(_need(ruler, "Marginal")).to_contain_text("measured")

    box = line.bounding_box()
    assert box is not None
    x, y = box["x"] + box["width"] / 2, box["y"] + box["height"] - 20
    ruler.page.mouse.move(x, y)
    ruler.page.mouse.down()
    ruler.page.mouse.move(x + 40, y, steps=5)
    ruler.page.mouse.up()
    expect(_need(ruler, "Marginal")).to_contain_text("interpolated")
    ruler.tool("Save").click()
    expect(ruler.page.get_by_text("Saved radio.toml")).to_be_visible()

    saved = _saved(project)
    assert saved.needs_hz is not None
    assert saved.bounds[0] == 0.5
    assert 0.2 < saved.bounds[1] < 0.5
    assert saved.bounds[2:] == (0.1, 0.05, 0.02, 0.01)
    assert saved.needs_hz[0] <= saved.needs_hz[1] <= saved.needs_hz[2]
    assert float(line.get_attribute("aria-valuenow") or 0) == saved.bounds[1]


def test_keys_keep_the_order_and_without_a_recording_the_needs_go_with_a_word(
    ruler: RulerPage, project: Path
) -> None:
    (project / "radio.toml").write_text(PROFILE.replace("0.7\n", f"0.7\n{TIERS}{NEEDS}"))
    _open(ruler)
    line = _line(ruler, "Marginal")
    expect(_need(ruler, "Marginal")).to_contain_text("the profile")
    line.press("ArrowRight")
    expect(line).to_have_attribute("aria-valuetext", "0.21 m")
    expect(ruler.page.get_by_text("What the levels needed was removed")).to_be_visible()
    line.press("End")
    expect(line).to_have_attribute("aria-valuetext", "0.5 m")
    line.press("ArrowRight")
    expect(
        ruler.page.get_by_text("Marginal stops at Unacceptable (0.5 m): it cannot lie above")
    ).to_be_visible()
    for _ in range(3):
        ruler.tool("Undo").click()
    expect(line).to_have_attribute("aria-valuetext", "0.2 m")
    expect(_need(ruler, "Marginal")).to_contain_text("the profile")
    line.press("ArrowLeft")
    ruler.tool("Save").click()
    expect(ruler.page.get_by_text("Saved radio.toml")).to_be_visible()
    assert _saved(project) == AccuracyTiers(bounds=(0.5, 0.19, 0.1, 0.05, 0.02, 0.01))
    assert "# our arm's reach" in (project / "radio.toml").read_text()


def test_a_topic_without_a_position_has_levels_of_rates_only(ruler: RulerPage) -> None:
    _open(ruler)
    ruler.page.get_by_role("combobox", name="Topic").select_option("/scan")
    expect(ruler.page.get_by_role("combobox", name="Levels of")).to_have_count(0)
    expect(ruler.page.get_by_text("/scan has no six levels yet.")).to_be_visible()


def _open(ruler: RulerPage) -> None:
    ruler.page.get_by_role("link", name="radio.toml").click()
    ruler.page.get_by_role("combobox", name="Levels of").select_option("Accuracy of position")


def _line(ruler: RulerPage, level: str) -> Locator:
    return ruler.page.get_by_role("slider", name=f"{level} level of /odom position (m)", exact=True)


def _need(ruler: RulerPage, level: str) -> Locator:
    return ruler.page.get_by_role("table", name="What the levels need").get_by_role("row", name=level)


def _saved(project: Path) -> AccuracyTiers:
    return load_profile(project / "radio.toml").topic("/odom").accuracies[LevelledProperty.POSITION]
