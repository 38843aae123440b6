# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""The page never calls saved what is not, and loses nothing that somebody typed."""

from __future__ import annotations

import shutil
from pathlib import Path

from playwright.sync_api import Locator, Route, expect

from ruler.browser.ruler_page import RulerPage

RULES = "begin\n    SetFrequency /odom 10\nend\n"
LATE_TIMERS = (
    "const soon = setTimeout; window.setTimeout = (work, ms, ...more) => soon(work, ms || 700, ...more)"
)
PROFILE = '# Our radio.\n[topics."/odom"]\nmessage_kb = 0.7\n'


def test_the_table_is_still_there_after_a_look_at_the_first_screen(ruler: RulerPage, project: Path) -> None:
    size = _open_table(ruler, project)
    size.fill("0.9")
    ruler.page.get_by_role("link", name="Home").click()
    expect(ruler.page.get_by_role("listitem").filter(has_text="wlan.toml")).to_contain_text("not saved")
    ruler.page.get_by_role("link", name="wlan.toml", exact=True).click()
    expect(size).to_have_value("0.9")
    ruler.save()
    assert (project / "wlan.toml").read_text() == PROFILE.replace("0.7", "0.9")


def test_a_new_table_is_listed_before_it_is_a_file(ruler: RulerPage, project: Path) -> None:
    shutil.rmtree(project / "quality")
    ruler.home()
    ruler.button("Configure Topic Parameters").click()
    topic = ruler.page.get_by_label("Topic of row 1")
    topic.fill("/odom")
    ruler.page.get_by_role("link", name="Home").click()
    ruler.page.get_by_role("link", name="profile.toml", exact=True).click()
    expect(topic).to_have_value("/odom")


def _open_table(ruler: RulerPage, project: Path) -> Locator:
    (project / "wlan.toml").write_text(PROFILE)
    ruler.home()
    ruler.page.get_by_role("link", name="wlan.toml", exact=True).click()
    return ruler.page.get_by_label("Message size (KB) of /odom")


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


def test_no_block_is_added_to_a_text_that_cannot_be_read(ruler: RulerPage, project: Path) -> None:
    _open_rules(ruler, project)
    _type_below(ruler, "SetFrequenzy")
    expect(ruler.page.get_by_text("The text has an error")).to_be_visible()
    for name in ("New rate", "New rule"):
        expect(ruler.button(name)).to_be_disabled()


def test_a_save_names_the_blocks_that_it_leaves_out(ruler: RulerPage, project: Path) -> None:
    _open_rules(ruler, project)
    ruler.page.get_by_role("treeitem", name="Checks").click()
    listed = ruler.page.get_by_role("listbox", name="Checks blocks")
    ruler.drag(listed.get_by_role("option").first, ruler.page.get_by_role("treeitem", name="Rates"), 400, 200)
    ruler.button("New rate").click()
    ruler.expect_lines("SetFrequency /odom 10", "SetFrequency /")
    ruler.save()
    expect(
        ruler.page.get_by_text("Saved plain.adirf without 1 block that is not in the text")
    ).to_be_visible()


def test_the_text_is_called_saved_only_where_it_is(ruler: RulerPage, project: Path) -> None:
    _open_rules(ruler, project)
    side = ruler.page.get_by_text("the text is saved")
    expect(side).to_be_visible()
    ruler.button("New rate").click()
    expect(ruler.page.get_by_text("the text is not saved yet")).to_be_visible()
    expect(side).to_have_count(0)
    ruler.save()
    expect(side).to_be_visible()


def test_a_change_of_the_blocks_is_not_called_saved_before_it_is_in_the_text(
    ruler: RulerPage, project: Path
) -> None:
    held: list[Route] = []
    _open_rules(ruler, project)
    expect(_header_note(ruler)).to_have_text("saved")
    ruler.page.route("**/api/edit", lambda route: held.append(route), times=1)  # noqa: PLW0108 - no builtin
    with ruler.page.expect_request("**/api/edit"):
        ruler.change("Edit rate: 10", "7")
    expect(_header_note(ruler)).to_have_text("not saved")
    ruler.tool("Save").click()
    expect(_header_note(ruler)).to_have_text("not saved")
    assert (project / "plain.adirf").read_text() == RULES
    held[0].continue_()
    expect(_header_note(ruler)).to_have_text("saved")
    assert (project / "plain.adirf").read_text() == RULES.replace("10", "7")


def test_a_save_holds_what_was_typed_just_before(ruler: RulerPage, project: Path) -> None:
    # On a busy machine the blocks tell long afterwards what changed.
    ruler.page.add_init_script(LATE_TIMERS)
    _open_rules(ruler, project)
    ruler.field("Edit rate: 10").click()
    ruler.type_value("7")
    _save_by_keys(ruler)
    assert (project / "plain.adirf").read_text() == RULES.replace("10", "7")


def test_a_save_holds_what_stands_in_an_open_field(ruler: RulerPage, project: Path) -> None:
    _open_rules(ruler, project)
    ruler.field("Edit rate: 10").click()
    ruler.page.keyboard.press("Control+a")
    ruler.page.keyboard.type("7")
    expect(_header_note(ruler)).to_have_text("not saved")
    _save_by_keys(ruler)
    assert (project / "plain.adirf").read_text() == RULES.replace("10", "7")
    ruler.field("Edit rate: 7").click()
    ruler.page.keyboard.press("Control+a")
    ruler.page.keyboard.type("often")
    ruler.page.keyboard.press("Control+s")
    expect(ruler.page.get_by_text("Saved plain.adirf without what is being typed")).to_be_visible()
    expect(_header_note(ruler)).to_have_text("not saved")
    expect(ruler.page.get_by_role("combobox", name="rate", exact=True)).to_have_value("often")


def _save_by_keys(ruler: RulerPage) -> None:
    ruler.page.keyboard.press("Control+s")
    expect(ruler.page.get_by_text("Saved plain.adirf", exact=True)).to_be_visible()


def _header_note(ruler: RulerPage) -> Locator:
    return ruler.page.get_by_role("banner").get_by_text("saved")


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
