# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""A recording that is dropped on the first screen becomes rules, sizes and a path on the map."""

from __future__ import annotations

import base64
from pathlib import Path

import pytest
from playwright.sync_api import expect

from axe import violations
from bags.bag_factory import small_mission, write_bag
from ruler.browser.ruler_page import RulerPage

DROP = """({name, data}) => {
    const bytes = Uint8Array.from(atob(data), (letter) => letter.charCodeAt(0));
    const carried = new DataTransfer();
    carried.items.add(new File([bytes], name));
    const how = {dataTransfer: carried, bubbles: true, cancelable: true};
    document.body.dispatchEvent(new DragEvent("drop", how));
}"""


@pytest.fixture
def project(tmp_path: Path) -> Path:
    (tmp_path / "project").mkdir()
    return tmp_path / "project"


@pytest.mark.journey
def test_a_dropped_recording_becomes_rules_sizes_and_a_path(
    ruler: RulerPage, project: Path, tmp_path: Path
) -> None:
    _drop(ruler, tmp_path)
    dialog = ruler.page.get_by_role("dialog", name="Start from monday.db3")
    expect(dialog.get_by_role("status")).to_have_text("5 topics, 7.96 s.")
    expect(dialog.get_by_role("textbox", name="Name")).to_have_value("monday")
    assert violations(ruler.page) == []
    dialog.get_by_role("button", name="Create").click()
    ruler.expect_lines("SetFrequency /odom Full", "SetFrequency /scan Full")
    expect(ruler.page.get_by_label("Topic parameters")).to_have_value("monday.toml")
    ruler.open_pane("Map")
    expect(ruler.page.get_by_label("Path of")).to_have_value("monday.db3")
    expect(ruler.tool("Save")).to_be_disabled()
    assert {each.name for each in project.iterdir()} >= {"monday.db3", "monday.adirf", "monday.toml"}


def test_what_is_there_is_not_replaced(ruler: RulerPage, project: Path, tmp_path: Path) -> None:
    (project / "monday.toml").write_text("budget_kb_per_s = 5\n")
    ruler.home()
    _drop(ruler, tmp_path)
    dialog = ruler.page.get_by_role("dialog", name="Start from monday.db3")
    dialog.get_by_role("button", name="Create").click()
    expect(dialog.get_by_role("alert")).to_have_text("monday.toml exists already: choose another name")
    assert (project / "monday.toml").read_text() == "budget_kb_per_s = 5\n"
    assert not (project / "monday.adirf").exists()


def _drop(ruler: RulerPage, tmp_path: Path) -> None:
    write_bag(tmp_path / "elsewhere", small_mission(8))
    (file,) = (tmp_path / "elsewhere").glob("*.db3")
    data = base64.b64encode(file.read_bytes()).decode()
    ruler.page.evaluate(DROP, {"name": "monday.db3", "data": data})
