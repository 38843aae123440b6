# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""What was not saved is in the project and opens in any browser; the file has it once somebody saves."""

from __future__ import annotations

from contextlib import suppress
from pathlib import Path
from typing import TYPE_CHECKING

import pytest
from playwright.sync_api import Error, Locator, expect

from link.zenoh.ends import until
from ruler.browser.ruler_page import RulerPage, served

if TYPE_CHECKING:
    from playwright.sync_api import Browser

RULES = "begin\n    SetFrequency /odom 10\nend\n"
TYPED = "SetFrequency /scan 3"
MINE = RULES.replace("10\n", f"10\n    {TYPED}\n")
THEIRS = RULES.replace("10", "7")
PROFILE = '# Our radio.\n[topics."/odom"]\nmessage_kb = 0.7\n'


@pytest.mark.journey
def test_what_is_typed_opens_in_another_browser_and_reaches_the_file_by_a_save(
    ruler: RulerPage, project: Path, browser: Browser
) -> None:
    _type(ruler, project)
    _await_draft(project)
    assert (project / "plain.adirf").read_text() == RULES
    with browser.new_context() as context:
        other = RulerPage(context.new_page(), ruler.url)
        other.home()
        row = other.page.get_by_role("listitem").filter(has_text="plain.adirf")
        expect(row).to_contain_text("draft, not saved")
        other.open("plain.adirf")
        _expect_restored(other)
        other.save()
        expect(_notice(other)).to_have_count(0)
    assert (project / "plain.adirf").read_text() == MINE
    assert not _draft_file(project).exists()
    ruler.page.reload()
    ruler.expect_lines(TYPED)
    expect(ruler.tool("Save")).to_be_disabled()
    expect(_notice(ruler)).to_have_count(0)


def test_every_key_stroke_is_there_after_a_reload(ruler: RulerPage, project: Path) -> None:
    _type(ruler, project)
    ruler.page.reload()
    _expect_restored(ruler)


def test_a_tab_that_crashed_loses_nothing(ruler: RulerPage, project: Path) -> None:
    _type(ruler, project)
    crashed = ruler.page
    _await_draft(project)
    with crashed.expect_event("crash"), suppress(Error):
        crashed.goto("chrome://crash")
    next_page = RulerPage(crashed.context.new_page(), ruler.url)
    next_page.home()
    next_page.open("plain.adirf")
    _expect_restored(next_page)


def test_a_server_that_is_killed_while_somebody_types_costs_nothing(
    browser: Browser, project: Path, ruler_port: int
) -> None:
    with browser.new_context() as context:
        with served(project, ruler_port) as url:
            ruler = RulerPage(context.new_page(), url)
            ruler.home()
            _open(ruler, project)
            expect(ruler.button("New rate")).to_be_enabled()
            _type_line(ruler, TYPED[:8])
        ruler.page.keyboard.type(TYPED[8:])
        with served(project, ruler_port):
            # Nobody does anything.
            _await_draft(project)
            assert (project / "plain.adirf").read_text() == RULES
        ruler.page.keyboard.type("3")
        with served(project, ruler_port):
            ruler.page.reload()
            ruler.expect_lines(f"{TYPED}3")
            ruler.save()
        assert (project / "plain.adirf").read_text() == MINE.replace(TYPED, f"{TYPED}3")


def test_a_draft_is_discarded_and_a_version_has_it(ruler: RulerPage, project: Path) -> None:
    _type(ruler, project)
    ruler.page.reload()
    _expect_restored(ruler)
    ruler.button("Discard").click()
    expect(ruler.text).not_to_contain_text(TYPED)
    expect(ruler.tool("Save")).to_be_disabled()
    expect(_notice(ruler)).to_have_count(0)
    until(lambda: not _draft_file(project).exists())
    (kept,) = (project / ".testudo" / "versions" / "plain.adirf").glob("*.adirf")
    assert kept.read_text() == MINE
    ruler.tool("Undo").click()
    ruler.expect_lines(TYPED)


def test_a_draft_is_discarded_from_the_list(ruler: RulerPage, project: Path) -> None:
    _type(ruler, project)
    _await_draft(project)
    ruler.home()
    ruler.button("More for plain.adirf").click()
    ruler.page.get_by_role("menuitem", name="Discard the draft").click()
    row = ruler.page.get_by_role("listitem").filter(has_text="plain.adirf")
    expect(row).not_to_contain_text("not saved")
    assert not _draft_file(project).exists()
    ruler.open("plain.adirf")
    ruler.expect_lines("SetFrequency /odom 10")
    expect(ruler.text).not_to_contain_text(TYPED)


def test_a_draft_of_a_file_that_was_changed_since_is_asked_about(ruler: RulerPage, project: Path) -> None:
    _type(ruler, project)
    _await_draft(project)
    ruler.home()
    (project / "plain.adirf").write_text(THEIRS)
    ruler.open("plain.adirf")
    dialog = ruler.page.get_by_role("dialog", name="plain.adirf was changed elsewhere")
    dialog.get_by_role("button", name="Look at the difference").click()
    expect(dialog.get_by_role("figure", name="Theirs")).to_contain_text("SetFrequency /odom 7")
    dialog.get_by_role("button", name="Keep mine").click()
    expect(dialog).to_have_count(0)
    assert (project / "plain.adirf").read_text() == THEIRS
    ruler.save()
    assert (project / "plain.adirf").read_text() == MINE


def test_two_tabs_go_on_with_one_draft(ruler: RulerPage, project: Path) -> None:
    _type(ruler, project)
    _await_draft(project)
    other = RulerPage(ruler.page.context.new_page(), ruler.url)
    other.home()
    other.open("plain.adirf")
    other.expect_lines("SetFrequency /odom 10", TYPED)
    _type_line(other, "SetFrequency /imu 2")
    ruler.page.bring_to_front()
    ruler.expect_lines("SetFrequency /odom 10", "SetFrequency /imu 2", TYPED)
    expect(ruler.page.get_by_text("was changed elsewhere; what you")).to_have_count(0)


def test_half_a_number_of_a_table_is_there_after_a_reload(ruler: RulerPage, project: Path) -> None:
    (project / "wlan.toml").write_text(PROFILE)
    ruler.home()
    ruler.page.get_by_role("link", name="wlan.toml", exact=True).click()
    size = ruler.page.get_by_label("Message size (KB) of /odom")
    size.fill("0,")
    ruler.page.reload()
    expect(size).to_have_value("0,")
    expect(_notice(ruler)).to_be_visible()
    assert (project / "wlan.toml").read_text() == PROFILE
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
    _await_draft(project, "lift.toml", "0.5")
    ruler.page.get_by_role("link", name="Rules", exact=True).click()
    ruler.page.reload()
    ruler.page.get_by_role("link", name="lift.toml", exact=True).click()
    expect(_notice(ruler)).to_be_visible()
    with ruler.page.expect_response("**/api/profile/for"):
        ruler.save()
    ruler.page.get_by_role("link", name="Back to aisle.adirf").click()
    expect(ruler.page.get_by_label("Topic parameters")).to_have_value("lift.toml")


def test_a_disk_without_room_leaves_what_is_typed_to_the_browser_and_says_so(
    ruler: RulerPage, project: Path
) -> None:
    (project / ".testudo").write_text("in the way")
    _type(ruler, project)
    expect(
        ruler.page.get_by_text("The draft is in this browser only. The draft cannot be written")
    ).to_be_visible()
    ruler.page.reload()
    _expect_restored(ruler)
    (project / ".testudo").unlink()
    _await_draft(project)
    expect(ruler.page.get_by_text("in this browser only")).to_have_count(0)
    ruler.forgive("422")


def test_without_room_anywhere_a_reload_is_asked_about(ruler: RulerPage, project: Path) -> None:
    ruler.page.evaluate("() => { Storage.prototype.setItem = () => { throw new Error('full') } }")
    (project / ".testudo").write_text("in the way")
    _open(ruler, project)
    _type_line(ruler)
    expect(ruler.page.get_by_text("This browser has no room for drafts")).to_be_visible()
    with ruler.page.expect_event("dialog") as asked:
        ruler.page.evaluate("setTimeout(() => location.reload())")
    assert asked.value.type == "beforeunload"
    asked.value.dismiss()
    ruler.expect_lines(TYPED)
    ruler.forgive("422")


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


def _draft_file(project: Path, name: str = "plain.adirf") -> Path:
    return project / ".testudo" / "drafts" / f"{name}.json"


def _await_draft(project: Path, name: str = "plain.adirf", words: str = TYPED) -> None:
    """Wait until the server keeps what was typed, which it does a moment later."""
    draft = _draft_file(project, name)
    until(lambda: draft.exists() and words in draft.read_text())


def _notice(ruler: RulerPage) -> Locator:
    return ruler.page.get_by_role("status").filter(has_text="This is the draft of")


def _expect_restored(ruler: RulerPage) -> None:
    ruler.expect_lines("SetFrequency /odom 10", TYPED)
    expect(_notice(ruler)).to_be_visible()
    expect(ruler.tool("Save")).to_be_enabled()
