# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""The six accuracies of a topic are set on the curve of the messages that each needs."""

from __future__ import annotations

from pathlib import Path

import pytest
from playwright.sync_api import Locator, expect

from bags.bag_factory import small_mission, write_bag
from ruler.browser.ruler_page import RulerPage
from smarttestudo.domain.profile import AccuracyTiers, LevelledProperty
from smarttestudo.rules.profile_file import load_profile

PROFILE = """\
[topics."/odom"]
message_kb = 0.7

[topics."/scan"]
type = "sensor_msgs/msg/LaserScan"
"""


@pytest.fixture
def project(tmp_path: Path) -> Path:
    folder = tmp_path / "project"
    folder.mkdir()
    (folder / "radio.toml").write_text(PROFILE)
    write_bag(folder / "monday", small_mission(8))
    return folder


@pytest.mark.journey
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


def _open(ruler: RulerPage) -> None:
    ruler.page.get_by_role("link", name="radio.toml").click()
    ruler.page.get_by_role("combobox", name="Levels of").select_option("Accuracy of position")


def _line(ruler: RulerPage, level: str) -> Locator:
    return ruler.page.get_by_role("slider", name=f"{level} level of /odom position (m)", exact=True)


def _need(ruler: RulerPage, level: str) -> Locator:
    return ruler.page.get_by_role("table", name="What the levels need").get_by_role("row", name=level)


def _saved(project: Path) -> AccuracyTiers:
    return load_profile(project / "radio.toml").topic("/odom").accuracies[LevelledProperty.POSITION]
