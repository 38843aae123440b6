# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""What one needs stays in sight on a tablet that is turned."""

from __future__ import annotations

from pathlib import Path

from playwright.sync_api import Locator, ViewportSize, expect

from ruler.browser.ruler_page import RulerPage
from ruler.browser.screens import FOLDED

LYING: ViewportSize = {"width": 1180, "height": 820}
STANDING: ViewportSize = {"width": 820, "height": 1180}


def test_a_tablet_that_is_turned_keeps_the_blocks_in_sight(ruler: RulerPage, project: Path) -> None:
    (project / "long.adirf").write_text(f"begin\n    SetFrequency /odom 10\n{FOLDED}end\n")
    ruler.page.set_viewport_size(LYING)
    ruler.home()
    ruler.open("long.adirf")
    outline = ruler.page.get_by_role("listbox", name="Rules in the order of the text")
    expect(outline).to_be_visible()
    kinds = ruler.blocks.locator(".blocklyToolbox")
    ruler.field("Edit rate: 10")
    assert _box(kinds)["width"] < _box(kinds)["height"]

    ruler.page.set_viewport_size(STANDING)
    expect(outline).to_be_hidden()
    expect(kinds).to_have_attribute("layout", "h")
    assert _box(kinds)["width"] > _box(kinds)["height"]
    ruler.change("Edit rate: 10", "20")
    expect(ruler.text).to_contain_text("SetFrequency /odom 20")

    ruler.page.set_viewport_size(LYING)
    expect(outline).to_be_visible()
    expect(kinds).to_have_attribute("layout", "v")
    ruler.change("Edit rate: 20", "30")
    expect(ruler.text).to_contain_text("SetFrequency /odom 30")


def _box(what: Locator) -> dict[str, float]:
    box = what.bounding_box()
    assert box is not None
    return {"x": box["x"], "y": box["y"], "width": box["width"], "height": box["height"]}
