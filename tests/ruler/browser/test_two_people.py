# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""Two people with a browser each, and a server that goes and comes back: every key stroke is somewhere."""

from __future__ import annotations

from collections.abc import Iterator
from contextlib import suppress
from pathlib import Path
from typing import TYPE_CHECKING

import pytest
from playwright.sync_api import Error, Locator, expect

from ruler.browser.ruler_page import RulerPage, served

if TYPE_CHECKING:
    from playwright.sync_api import Browser

RULES = "begin\n    SetFrequency /odom 10\nend\n"
TABLE = '[topics."/odom"]\nmessage_kb = 0.7\n'
ADA, BOB = "SetFrequency /scan 3", "SetFrequency /imu 2"


@pytest.fixture
def project(tmp_path: Path) -> Path:
    """One rule file and one table."""
    (tmp_path / "project").mkdir()
    (tmp_path / "project" / "plain.adirf").write_text(RULES)
    (tmp_path / "project" / "wlan.toml").write_text(TABLE)
    return tmp_path / "project"


@pytest.fixture
def bob(browser: Browser, ruler: RulerPage) -> Iterator[RulerPage]:
    """Somebody else at another machine; ``ruler`` is Ada's."""
    with browser.new_context() as context:
        page = RulerPage(context.new_page(), ruler.url)
        page.home()
        yield page
        assert page.complaints == []


@pytest.mark.journey
def test_of_two_people_who_save_the_second_is_asked_and_both_texts_stay(
    ruler: RulerPage, bob: RulerPage, project: Path
) -> None:
    for each in (ruler, bob):
        each.open("plain.adirf")
    _type_line(ruler, ADA)
    _type_line(bob, BOB)
    ruler.save()
    bob.tool("Save").click()
    dialog = bob.page.get_by_role("dialog", name="Somebody else changed plain.adirf")
    expect(dialog.get_by_role("figure", name="Theirs")).to_contain_text(ADA)
    expect(dialog.get_by_role("figure", name="Yours")).to_contain_text(BOB)
    expect(_header_note(bob)).to_have_text("not saved")
    assert (project / "plain.adirf").read_text() == _with(ADA)
    dialog.get_by_role("textbox").fill("bob")
    dialog.get_by_role("button", name="Save as").click()
    expect(bob.page.get_by_role("heading", name="bob.adirf", level=1)).to_be_visible()
    assert (project / "plain.adirf").read_text() == _with(ADA)
    assert (project / "bob.adirf").read_text() == _with(BOB)
    bob.forgive("409")


def test_two_people_with_one_table_lose_no_cell(ruler: RulerPage, bob: RulerPage, project: Path) -> None:
    sizes = [_open_table(each) for each in (ruler, bob)]
    sizes[0].fill("0.8")
    sizes[1].fill("0.9")
    ruler.save()
    bob.tool("Save").click()
    dialog = bob.page.get_by_role("dialog", name="Somebody else changed wlan.toml")
    dialog.get_by_role("button", name="Cancel").click()
    expect(sizes[1]).to_have_value("0.9")
    expect(bob.page.get_by_text("wlan.toml, not saved")).to_be_visible()
    assert (project / "wlan.toml").read_text() == TABLE.replace("0.7", "0.8")
    bob.tool("Save").click()
    dialog.get_by_role("button", name="Save anyway").click()
    expect(bob.page.get_by_text("wlan.toml, saved")).to_be_visible()
    assert (project / "wlan.toml").read_text() == TABLE.replace("0.7", "0.9")
    bob.forgive("409")


def test_two_tabs_with_one_table_keep_a_draft_each(ruler: RulerPage) -> None:
    other = RulerPage(ruler.page.context.new_page(), ruler.url)
    other.home()
    for page, typed in ((ruler, "0.8"), (other, "0.9")):
        _open_table(page).fill(typed)
    for page, typed in ((ruler, "0.8"), (other, "0.9")):
        page.page.reload()
        expect(_size(page)).to_have_value(typed)
        expect(page.page.get_by_text("wlan.toml, not saved")).to_be_visible()


def test_a_table_in_a_tab_that_crashed_is_taken_over(ruler: RulerPage, project: Path) -> None:
    _open_table(ruler).fill("0,9")
    crashed = ruler.page
    crashed.wait_for_function("() => Object.values(localStorage).some(each => each.includes('0,9'))")
    with crashed.expect_event("crash"), suppress(Error):
        crashed.goto("chrome://crash")
    after = RulerPage(crashed.context.new_page(), ruler.url)
    after.home()
    expect(_open_table(after)).to_have_value("0,9")
    assert (project / "wlan.toml").read_text() == TABLE


def test_a_server_that_is_back_is_saved_to_without_a_reload(
    browser: Browser, project: Path, ruler_port: int
) -> None:
    with browser.new_context() as context:
        with served(project, ruler_port) as url:
            rules = RulerPage(context.new_page(), url)
            rules.home()
            rules.open("plain.adirf")
            rules.expect_lines("SetFrequency /odom 10")
            table = RulerPage(context.new_page(), url)
            table.home()
            _open_table(table)
        _type_line(rules, ADA)
        _size(table).fill("0.9")
        for page, note in ((rules, "not saved"), (table, "profile wlan.toml, not saved")):
            with page.page.expect_event("requestfailed"):
                page.page.keyboard.press("Control+s")
            expect(_header_note(page)).to_have_text(note)
        assert (project / "plain.adirf").read_text() == RULES
        _type_line(rules, BOB)
        with served(project, ruler_port):
            for page in (rules, table):
                page.tool("Save").click()
            expect(_header_note(rules)).to_have_text("saved")
            expect(_header_note(table)).to_have_text("profile wlan.toml, saved")
        assert {ADA, BOB} <= {line.strip() for line in (project / "plain.adirf").read_text().splitlines()}
        assert (project / "wlan.toml").read_text() == TABLE.replace("0.7", "0.9")


def test_a_save_whose_answer_never_comes_is_not_called_saved(ruler: RulerPage, project: Path) -> None:
    ruler.open("plain.adirf")
    _type_line(ruler, ADA)
    ruler.page.route("**/api/file", lambda route: route.abort(), times=1)
    ruler.tool("Save").click()
    expect(ruler.page.get_by_text("The Ruler's server does not answer")).to_be_visible()
    expect(_header_note(ruler)).to_have_text("not saved")
    ruler.page.reload()
    ruler.expect_lines(ADA)
    ruler.save()
    assert (project / "plain.adirf").read_text() == _with(ADA)
    ruler.forgive("ERR_FAILED")


def _with(line: str) -> str:
    return RULES.replace("10\n", f"10\n    {line}\n")


def _type_line(ruler: RulerPage, line: str) -> None:
    ruler.expect_lines("SetFrequency /odom 10")
    ruler.text.get_by_text("SetFrequency", exact=False).first.click()
    ruler.page.keyboard.press("End")
    ruler.page.keyboard.type(f"\n{line}")


def _open_table(ruler: RulerPage) -> Locator:
    ruler.page.get_by_role("link", name="wlan.toml", exact=True).click()
    _size(ruler).wait_for()
    return _size(ruler)


def _size(ruler: RulerPage) -> Locator:
    return ruler.page.get_by_label("Message size (KB) of /odom")


def _header_note(ruler: RulerPage) -> Locator:
    """What the top of the page says of the file."""
    return ruler.page.get_by_role("banner").locator(".quiet").first
