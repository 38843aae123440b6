# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""The page never calls saved what is not, and loses nothing that somebody typed."""

from __future__ import annotations

from pathlib import Path

from playwright.sync_api import Locator, expect

from ruler.browser.ruler_page import RulerPage

RULES = "begin\n    SetFrequency /odom 10\nend\n"
LATE_TIMERS = (
    "const soon = setTimeout; window.setTimeout = (work, ms, ...more) => soon(work, ms || 700, ...more)"
)


def test_a_block_that_the_text_does_not_take_goes_again(ruler: RulerPage, project: Path) -> None:
    rates = _open_rules(ruler, project)
    ruler.page.context.set_offline(True)
    _type_below(ruler, "SetFrequency /scan 3")
    ruler.button("New rule").click()
    expect(ruler.page.get_by_text("blocks stay as they are")).to_be_visible()
    expect(rates).to_have_count(1)
    expect(ruler.text).not_to_contain_text("CheckValue")
    ruler.page.context.set_offline(False)
    ruler.field("Edit rate: 10").click()
    ruler.type_value("4")
    ruler.expect_lines("SetFrequency /odom 4", "SetFrequency /scan 3")
    expect(rates).to_have_count(2)
    _type_below(ruler, "SetFrequency /imu 3")
    ruler.button("New rule").click()
    expect(rates).to_have_count(4)
    ruler.expect_lines("SetFrequency /imu 3", "SetFrequency /scan 3", "CheckValue /odom pose_x > 0")
    ruler.save()
    assert "CheckValue /odom pose_x > 0" in (project / "plain.adirf").read_text()
    # The last refusal may be told of once the page is online again.
    ruler.forgive("ERR_INTERNET_DISCONNECTED")


def test_a_save_holds_what_was_typed_just_before(ruler: RulerPage, project: Path) -> None:
    # On a busy machine the blocks tell long afterwards what changed.
    ruler.page.add_init_script(LATE_TIMERS)
    _open_rules(ruler, project)
    ruler.field("Edit rate: 10").click()
    ruler.type_value("7")
    _save_by_keys(ruler)
    assert (project / "plain.adirf").read_text() == RULES.replace("10", "7")


def _save_by_keys(ruler: RulerPage) -> None:
    ruler.page.keyboard.press("Control+s")
    expect(ruler.page.get_by_text("Saved plain.adirf", exact=True)).to_be_visible()


def _open_rules(ruler: RulerPage, project: Path) -> Locator:
    """Open a file with one rate; the rates among its blocks."""
    (project / "plain.adirf").write_text(RULES)
    ruler.home()
    ruler.open("plain.adirf")
    rates = ruler.blocks.get_by_role("button", name="Edit topic to send")
    expect(rates).to_have_count(1)
    return rates


def _type_below(ruler: RulerPage, line: str) -> None:
    ruler.text.get_by_text("SetFrequency", exact=False).first.click()
    ruler.page.keyboard.press("End")
    ruler.page.keyboard.type(f"\n{line}")
