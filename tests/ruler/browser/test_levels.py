# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""The six quality levels of a topic are set on the curve of what each rate loses."""

from __future__ import annotations

from pathlib import Path

import pytest
from playwright.sync_api import Locator, expect

from bags.bag_factory import small_mission, write_bag
from ruler.browser.ruler_page import RulerPage
from smarttestudo.rules.profile_file import load_profile

PROFILE = """\
# Our radio.
[topics."/odom"]
message_kb = 0.7
tiers_hz = [1, 2, 5, 10, 15, 20]
"""


@pytest.fixture
def project(tmp_path: Path) -> Path:
    folder = tmp_path / "project"
    folder.mkdir()
    (folder / "radio.toml").write_text(PROFILE)
    write_bag(folder / "monday", small_mission(8))
    return folder


def test_lines_are_dragged_or_moved_by_keys_and_the_table_follows(ruler: RulerPage, project: Path) -> None:
    ruler.page.get_by_role("link", name="radio.toml").click()
    desirable, cell = _line(ruler, "Desirable"), _cell(ruler, "Desirable")
    expect(desirable).to_have_attribute("aria-valuetext", "10 Hz")
    desirable.press("ArrowRight")
    expect(cell).to_have_value("11")
    desirable.press("End")
    expect(cell).to_have_value("15")
    desirable.press("ArrowUp")
    expect(cell).to_have_value("15")
    expect(ruler.page.get_by_text("Desirable stops at Competitive (15 Hz)")).to_be_visible()

    _drag(ruler, desirable, -60)
    expect(cell).not_to_have_value("15")
    assert 5 <= float(cell.input_value()) < 15
    ruler.tool("Undo").click()
    expect(cell).to_have_value("15")
    for _ in range(3):
        ruler.tool("Undo").click()
    expect(cell).to_have_value("10")
    expect(ruler.tool("Undo")).to_be_disabled()

    cell.fill("12")
    expect(desirable).to_have_attribute("aria-valuenow", "12")
    ruler.tool("Save").click()
    expect(ruler.page.get_by_text("Saved radio.toml")).to_be_visible()
    assert (project / "radio.toml").read_text() == PROFILE.replace("10", "12")


def test_a_name_takes_hold_of_its_own_line_and_does_not_jump(ruler: RulerPage, project: Path) -> None:
    close = PROFILE.replace("1, 2, 5, 10, 15, 20", "10, 11, 12, 14, 16, 200")
    (project / "radio.toml").write_text(close)
    ruler.page.get_by_role("link", name="radio.toml").click()
    cells = [_cell(ruler, level) for level in ("Unacceptable", "Marginal", "Acceptable", "Excessive")]
    _await_axis(ruler)
    name = ruler.page.get_by_text("Unacceptable 10 Hz").bounding_box()
    other = _line(ruler, "Marginal").bounding_box()
    assert name is not None
    assert other is not None
    x, y = other["x"] + other["width"] / 2, name["y"] + name["height"] / 2
    assert name["x"] < x < name["x"] + name["width"]
    mouse = ruler.page.mouse
    mouse.move(x, y)
    mouse.down()
    mouse.move(x - 3, y)
    expect(cells[0]).to_have_value("9.9")
    mouse.move(x - 60, y, steps=5)
    mouse.up()
    assert float(cells[0].input_value()) < 9
    assert [cell.input_value() for cell in cells[1:]] == ["11", "12", "200"]


@pytest.mark.parametrize("width", [1440, 1280, 900])
def test_the_button_that_removes_a_topic_is_whole_at_every_width(ruler: RulerPage, width: int) -> None:
    ruler.page.set_viewport_size({"width": width, "height": 800})
    ruler.page.get_by_role("link", name="radio.toml").click()
    button = ruler.button("Remove /odom").bounding_box()
    table = ruler.page.locator(".table-scroll").bounding_box()
    assert button is not None
    assert table is not None
    assert button["x"] + button["width"] < table["x"] + table["width"]


def test_levels_that_fall_are_refused_in_words(ruler: RulerPage) -> None:
    ruler.page.get_by_role("link", name="radio.toml").click()
    _cell(ruler, "Desirable").fill("3")
    problems = ruler.page.get_by_role("list", name="Problems")
    expect(problems).to_contain_text("Desirable (3 Hz) is below Acceptable (5 Hz)")
    expect(ruler.tool("Save")).to_be_disabled()
    _cell(ruler, "Desirable").fill("6")
    expect(problems.get_by_role("listitem")).to_have_count(0)
    expect(ruler.tool("Save")).to_be_enabled()


def test_the_curve_of_a_recording_proposes_levels_with_one_click(ruler: RulerPage, project: Path) -> None:
    ruler.page.get_by_role("link", name="radio.toml").click()
    ruler.page.get_by_role("combobox", name="Recording").select_option("monday")
    ruler.button("Show what each rate loses").click()
    ruler.page.get_by_text("The curve as numbers").click()
    expect(ruler.page.get_by_role("row").filter(has_text="pose_y").first).to_be_visible()
    ruler.button("Use the proposed levels").click()
    expect(_line(ruler, "Excessive")).to_have_attribute("aria-valuetext", "25 Hz")
    ruler.tool("Save").click()
    expect(ruler.page.get_by_text("Saved radio.toml")).to_be_visible()
    tiers_hz = load_profile(project / "radio.toml").topic("/odom").tiers_hz
    assert tiers_hz is not None
    assert list(tiers_hz) == sorted(tiers_hz)
    assert tiers_hz[-1] == 25
    shown = [_line(ruler, level).get_attribute("aria-valuenow") for level in ("Unacceptable", "Competitive")]
    assert [float(one or 0) for one in shown] == [tiers_hz[0], tiers_hz[4]]


def _line(ruler: RulerPage, level: str) -> Locator:
    return ruler.page.get_by_role("slider", name=f"{level} level of /odom (Hz)", exact=True)


def _cell(ruler: RulerPage, level: str) -> Locator:
    return ruler.page.get_by_label(f"{level} (Hz) of /odom", exact=True)


def _await_axis(ruler: RulerPage) -> None:
    """Wait until the levels stand on the axis, which is drawn a picture after they are there."""
    ruler.page.wait_for_function("() => document.querySelector('.level-area')?.clientWidth > 0")


def _drag(ruler: RulerPage, line: Locator, right_px: float) -> None:
    _await_axis(ruler)
    box = line.bounding_box()
    assert box is not None
    x, y = box["x"] + box["width"] / 2, box["y"] + box["height"] - 20
    mouse = ruler.page.mouse
    mouse.move(x, y)
    mouse.down()
    mouse.move(x + right_px, y, steps=5)
    mouse.up()
