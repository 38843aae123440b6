# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""What was not saved comes back after a reload, a crash of the tab, and a server that was gone."""

from __future__ import annotations

from contextlib import suppress
from pathlib import Path
from typing import TYPE_CHECKING

import pytest
from playwright.sync_api import Error, Locator, expect

from ruler.browser.ruler_page import RulerPage, served

if TYPE_CHECKING:
    from playwright.sync_api import Browser

RULES = "begin\n    SetFrequency /odom 10\nend\n"
TYPED = "SetFrequency /scan 3"
MINE = RULES.replace("10\n", f"10\n    {TYPED}\n")
THEIRS = RULES.replace("10", "7")
PROFILE = '# Our radio.\n[topics."/odom"]\nmessage_kb = 0.7\n'


@pytest.mark.journey
def test_every_key_stroke_is_there_after_a_reload(ruler: RulerPage, project: Path) -> None:
    _type(ruler, project)
    ruler.page.reload()
    _expect_restored(ruler)
    ruler.save()
    expect(_notice(ruler)).to_have_count(0)
    assert (project / "plain.adirf").read_text() == MINE
    ruler.page.reload()
    ruler.expect_lines(TYPED)
    expect(ruler.tool("Save")).to_be_disabled()
    expect(_notice(ruler)).to_have_count(0)


def test_a_tab_that_crashed_loses_nothing(ruler: RulerPage, project: Path) -> None:
    _type(ruler, project)
    crashed = ruler.page
    _await_draft(ruler)
    with crashed.expect_event("crash"), suppress(Error):
        crashed.goto("chrome://crash")
    next_page = RulerPage(crashed.context.new_page(), ruler.url)
    next_page.home()
    expect(next_page.page.get_by_role("listitem").filter(has_text="plain.adirf")).to_contain_text("not saved")
    next_page.open("plain.adirf")
    _expect_restored(next_page)


def test_a_server_that_was_gone_costs_nothing(browser: Browser, project: Path, ruler_port: int) -> None:
    context = browser.new_context()
    with served(project, ruler_port) as url:
        ruler = RulerPage(context.new_page(), url)
        ruler.home()
        _open(ruler, project)
        expect(ruler.button("New rate")).to_be_enabled()
    _type_line(ruler)
    # A save that is still under way would reach the server that comes next.
    with ruler.page.expect_event("requestfailed", lambda request: request.method == "PUT"):
        ruler.page.keyboard.press("Control+s")
    expect(ruler.page.get_by_text("not saved", exact=True)).to_be_visible()
    with served(project, ruler_port):
        ruler.page.reload()
        _expect_restored(ruler)
        ruler.save()
    assert (project / "plain.adirf").read_text() == MINE
    context.close()


def test_restored_changes_are_dropped_and_undo_brings_them_back(ruler: RulerPage, project: Path) -> None:
    _type(ruler, project)
    ruler.page.reload()
    _expect_restored(ruler)
    ruler.button("Drop them").click()
    expect(ruler.text).not_to_contain_text(TYPED)
    expect(ruler.tool("Save")).to_be_disabled()
    expect(_notice(ruler)).to_have_count(0)
    ruler.tool("Undo").click()
    ruler.expect_lines(TYPED)


def test_a_restored_file_that_somebody_else_changed_is_compared_first(
    ruler: RulerPage, project: Path
) -> None:
    _type(ruler, project)
    (project / "plain.adirf").write_text(THEIRS)
    ruler.page.reload()
    _expect_restored(ruler)
    expect(_notice(ruler)).to_contain_text("Somebody else changed the file")
    ruler.button("Compare").click()
    dialog = ruler.page.get_by_role("dialog", name="Somebody else changed plain.adirf")
    expect(dialog.get_by_role("figure", name="Theirs")).to_contain_text("SetFrequency /odom 7")
    dialog.get_by_role("button", name="Cancel").click()
    ruler.tool("Save").click()
    dialog.get_by_role("button", name="Save anyway").click()
    expect(ruler.tool("Save")).to_be_disabled()
    assert (project / "plain.adirf").read_text() == MINE
    ruler.forgive("409")


def test_two_tabs_keep_what_was_typed_in_each(ruler: RulerPage, project: Path) -> None:
    _type(ruler, project)
    _await_draft(ruler)
    other = RulerPage(ruler.page.context.new_page(), ruler.url)
    other.home()
    other.open("plain.adirf")
    expect(other.page.get_by_text("Another tab has unsaved changes of plain.adirf")).to_be_visible()
    expect(other.text).not_to_contain_text(TYPED)
    _type_line(other, "SetFrequency /imu 2")
    for each, line in ((other, "SetFrequency /imu 2"), (ruler, TYPED)):
        each.page.reload()
        each.expect_lines(line)


def test_the_table_is_there_after_a_reload(ruler: RulerPage, project: Path) -> None:
    (project / "wlan.toml").write_text(PROFILE)
    ruler.home()
    ruler.page.get_by_role("link", name="wlan.toml", exact=True).click()
    size = ruler.page.get_by_label("Message size (KB) of /odom")
    size.fill("0,")
    ruler.page.reload()
    expect(size).to_have_value("0,")
    expect(_notice(ruler)).to_be_visible()
    size.fill("0,9")
    ruler.save()
    assert (project / "wlan.toml").read_text() == PROFILE.replace("0.7", "0.9")


def test_a_table_for_rules_is_theirs_though_it_is_opened_from_the_list(
    ruler: RulerPage, project: Path
) -> None:
    (project / "aisle.adirf").write_text("begin\n    SetFrequency /lift 5\nend\n")
    (project / "wlan.toml").write_text(PROFILE)
    ruler.page.goto(f"{ruler.url}#/topics/lift.toml?rules=aisle.adirf")
    ruler.page.get_by_label("Message size (KB) of /lift").fill("0.5")
    ruler.page.get_by_role("link", name="Rules", exact=True).click()
    ruler.page.reload()
    ruler.page.get_by_role("link", name="lift.toml", exact=True).click()
    expect(_notice(ruler)).to_be_visible()
    with ruler.page.expect_response("**/api/profile/for"):
        ruler.save()
    ruler.page.get_by_role("link", name="Back to aisle.adirf").click()
    expect(ruler.page.get_by_label("Topic parameters")).to_have_value("lift.toml")


def test_a_browser_without_room_says_so_and_asks_before_a_reload(ruler: RulerPage, project: Path) -> None:
    ruler.page.evaluate("() => { Storage.prototype.setItem = () => { throw new Error('full') } }")
    _open(ruler, project)
    _type_line(ruler)
    expect(ruler.page.get_by_text("This browser has no room for drafts")).to_be_visible()
    with ruler.page.expect_event("dialog") as asked:
        ruler.page.evaluate("setTimeout(() => location.reload())")
    assert asked.value.type == "beforeunload"
    asked.value.dismiss()
    ruler.expect_lines(TYPED)


def _open(ruler: RulerPage, project: Path) -> None:
    (project / "plain.adirf").write_text(RULES)
    ruler.page.evaluate("location.hash = '#/rules/plain.adirf'")
    ruler.expect_lines("SetFrequency /odom 10")


def _type(ruler: RulerPage, project: Path) -> None:
    """Open a file with one rate, and type another."""
    _open(ruler, project)
    _type_line(ruler)


def _type_line(ruler: RulerPage, line: str = TYPED) -> None:
    ruler.text.get_by_text("SetFrequency", exact=False).first.click()
    ruler.page.keyboard.press("End")
    ruler.page.keyboard.type(f"\n{line}")


def _await_draft(ruler: RulerPage) -> None:
    """Wait until the browser keeps what was typed, which it does a moment later."""
    ruler.page.wait_for_function(
        "word => Object.values(localStorage).some(each => each.includes(word))", arg=TYPED
    )


def _notice(ruler: RulerPage) -> Locator:
    return ruler.page.get_by_role("status").filter(has_text="Your unsaved changes")


def _expect_restored(ruler: RulerPage) -> None:
    ruler.expect_lines("SetFrequency /odom 10", TYPED)
    expect(_notice(ruler)).to_be_visible()
    expect(ruler.tool("Save")).to_be_enabled()
