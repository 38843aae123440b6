# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""Two people with a browser each, and a server that goes and comes back: every key stroke is somewhere."""

from __future__ import annotations

import re
from collections.abc import Iterator
from contextlib import contextmanager, suppress
from pathlib import Path
from typing import TYPE_CHECKING

import pytest
from playwright.sync_api import Error, Locator, expect

from link.zenoh.ends import until
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
def test_of_two_people_who_type_at_once_the_second_is_told_and_both_texts_stay(
    ruler: RulerPage, bob: RulerPage, project: Path
) -> None:
    for each in (ruler, bob):
        each.open("plain.adirf")
        each.expect_lines("SetFrequency /odom 10")
    with _at_once(ruler, bob):
        _type_line(ruler, ADA)
        _type_line(bob, BOB)
    told, calm = _who_is_told(ruler, bob)
    calm.save()
    expect(_header_note(told)).to_have_text("not saved")
    first, second = (ADA, BOB) if calm is ruler else (BOB, ADA)
    assert (project / "plain.adirf").read_text() == _with(first)
    told.tool("Save").click()
    dialog = told.page.get_by_role("dialog", name="plain.adirf was changed elsewhere")
    dialog.get_by_role("button", name="Look at the difference").click()
    expect(dialog.get_by_role("figure", name="Theirs")).to_contain_text(first)
    expect(dialog.get_by_role("figure", name="Yours")).to_contain_text(second)
    dialog.get_by_role("button", name="Keep mine").click()
    expect(_header_note(told)).to_have_text("saved")
    assert (project / "plain.adirf").read_text() == _with(second)
    versions = (project / ".testudo" / "versions" / "plain.adirf").glob("*.adirf")
    assert {_with(first), _with(second)} <= {each.read_text() for each in versions}
    calm.expect_lines(second)
    _forgive(ruler, bob)


def test_two_people_with_one_table_lose_no_cell(ruler: RulerPage, bob: RulerPage, project: Path) -> None:
    sizes = {page: _open_table(page) for page in (ruler, bob)}
    with _at_once(ruler, bob):
        sizes[ruler].fill("0.8")
        sizes[bob].fill("0.9")
    told, calm = _who_is_told(ruler, bob)
    typed = sizes[told].input_value()
    calm.save()
    told.tool("Save").click()
    dialog = told.page.get_by_role("dialog", name="wlan.toml was changed elsewhere")
    dialog.get_by_role("button", name="Cancel").click()
    expect(sizes[told]).to_have_value(typed)
    expect(told.page.get_by_text("wlan.toml, not saved")).to_be_visible()
    told.tool("Save").click()
    dialog.get_by_role("button", name="Keep mine").click()
    expect(told.page.get_by_text("wlan.toml, saved")).to_be_visible()
    assert (project / "wlan.toml").read_text() == TABLE.replace("0.7", typed)
    _forgive(ruler, bob)


def test_a_table_in_a_tab_that_crashed_is_taken_over(ruler: RulerPage, project: Path) -> None:
    _open_table(ruler).fill("0,9")
    crashed = ruler.page
    draft = project / ".testudo" / "drafts" / "wlan.toml.json"
    until(lambda: draft.exists() and "0,9" in draft.read_text())
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


@contextmanager
def _at_once(*pages: RulerPage) -> Iterator[None]:
    """Nobody hears of what the other one does meanwhile."""
    for page in pages:
        page.page.context.set_offline(True)
    yield
    for page in pages:
        page.page.context.set_offline(False)


def _forgive(*pages: RulerPage) -> None:
    """Drop what the browser says of requests that were refused, or that it was offline for."""
    for page in pages:
        page.complaints = [each for each in page.complaints if not re.search("409|DISCONNECTED", each)]


def _who_is_told(one: RulerPage, other: RulerPage) -> tuple[RulerPage, RulerPage]:
    """Of two who typed at once: the one who is told of the other, and the other."""
    notices = [page.page.get_by_text("was changed elsewhere; what you changed here") for page in (one, other)]
    until(lambda: any(notice.is_visible() for notice in notices))
    return (one, other) if notices[0].is_visible() else (other, one)


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
