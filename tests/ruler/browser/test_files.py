# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""The files of a project: found, renamed, copied, deleted and brought back, without a terminal."""

from __future__ import annotations

import re
from pathlib import Path

import pytest
from playwright.sync_api import expect

from axe import violations
from ruler.browser.ruler_page import RulerPage

ROS1_MAGIC = b"#ROSBAG V2.0\n"
GOES_ON_AT_ONCE = """addEventListener("DOMContentLoaded", () => {
    const change = () => history.state ?? (history.replaceState(1, ""), location.hash = "#/rules/zone.adirf");
    new MutationObserver(change).observe(document.getElementById("app"), {childList: true, subtree: true});
    if (document.getElementById("app").childElementCount > 0) change();
})"""
"""An address that changes while the first page is drawn."""
DROPS_FILE = """() => {
    const dataTransfer = new DataTransfer();
    dataTransfer.items.add(new File(["begin\\nend\\n"], "hall.adirf"));
    const drop = new DragEvent("drop", { dataTransfer, bubbles: true, cancelable: true });
    return !document.body.dispatchEvent(drop);
}"""
"""Drops a file on the page; whether the browser is kept from leaving the page for it."""


def test_files_are_counted_found_and_put_into_folders(ruler: RulerPage, project: Path) -> None:
    rules = ruler.page.get_by_role("region", name="Rules")
    every = len(list(project.rglob("*.adirf")))
    expect(rules.get_by_role("heading")).to_have_text(f"Rules {every}")
    ruler.page.get_by_role("searchbox", name="Find a file").fill("low bat")
    expect(rules.get_by_role("heading")).to_have_text(f"Rules 1 of {every}")

    ruler.button("More for low_battery.adirf").click()
    ruler.button("Rename low_battery.adirf").click()
    dialog = ruler.page.get_by_role("dialog", name="Rename low_battery.adirf")
    dialog.get_by_role("textbox", name="Name").fill("zone.adirf")
    dialog.get_by_role("button", name="Rename").click()
    expect(dialog.get_by_role("alert")).to_contain_text("a file of this name")
    ruler.forgive("409")
    assert violations(ruler.page) == []
    text = (project / "low_battery.adirf").read_bytes()
    dialog.get_by_role("textbox", name="Name").fill("power/low_battery")
    dialog.get_by_role("button", name="Rename").click()
    expect(rules.get_by_role("link", name="power/low_battery.adirf")).to_be_visible()
    assert (project / "power/low_battery.adirf").read_bytes() == text
    assert not (project / "low_battery.adirf").exists()


def test_a_copy_and_a_deletion_that_is_undone(ruler: RulerPage, project: Path) -> None:
    rules = ruler.page.get_by_role("region", name="Rules")
    ruler.button("More for zone.adirf").click()
    ruler.button("Duplicate zone.adirf").click()
    ruler.page.get_by_role("dialog").get_by_role("button", name="Duplicate").click()
    expect(rules.get_by_role("link", name="zone_copy.adirf")).to_be_visible()
    text = (project / "zone_copy.adirf").read_bytes()
    assert text == (project / "zone.adirf").read_bytes()
    ruler.button("More for zone_copy.adirf").click()
    ruler.button("Delete zone_copy.adirf").click()
    expect(rules.get_by_role("link", name="zone_copy.adirf")).to_have_count(0)
    assert not (project / "zone_copy.adirf").exists()
    ruler.button("Undo").click()
    expect(rules.get_by_role("link", name="zone_copy.adirf")).to_be_visible()
    assert (project / "zone_copy.adirf").read_bytes() == text


def test_all_that_was_deleted_can_be_brought_back_later(ruler: RulerPage, project: Path) -> None:
    texts = {name: (project / name).read_bytes() for name in ("zone.adirf", "quality/radio.toml")}
    for name in texts:
        ruler.button(f"More for {name}").click()
        ruler.button(f"Delete {name}").click()
        expect(ruler.page.get_by_role("link", name=name, exact=True)).to_have_count(0)
    ruler.open("warehouse.adirf")
    ruler.page.get_by_role("link", name="Home").click()
    expect(ruler.page.get_by_text("quality/radio.toml is deleted, and before it 1 file")).to_be_visible()
    (project / "quality/radio.toml").write_text("# theirs\n")
    ruler.button("Undo").click()
    expect(ruler.page.get_by_role("alert")).to_contain_text("The project has a file of this name")
    ruler.forgive("409")
    (project / "quality/radio.toml").unlink()
    for name in reversed(texts):
        ruler.button("Undo").click()
        expect(ruler.page.get_by_role("link", name=name, exact=True)).to_be_visible()
    expect(ruler.button("Undo")).to_have_count(0)
    assert {name: (project / name).read_bytes() for name in texts} == texts


@pytest.mark.parametrize("page", ["topics/quality/radio.toml", "robots/", "incidents/", "help/"])
def test_a_file_that_is_dropped_where_nothing_takes_it_leaves_the_page_open(
    ruler: RulerPage, page: str
) -> None:
    ruler.page.goto(f"{ruler.url}#/{page}")
    ruler.page.get_by_role("heading", level=1).wait_for()
    assert ruler.page.evaluate(DROPS_FILE)
    expect(ruler.page.get_by_text("hall.adirf was not taken: drop it on the first screen")).to_be_visible()


def test_the_address_of_a_file_that_is_not_there_leads_home(ruler: RulerPage, project: Path) -> None:
    before = set(project.rglob("*"))
    ruler.page.goto(f"{ruler.url}#/rules/gone.adirf")
    expect(ruler.page.get_by_text("project has no gone.adirf")).to_be_visible()
    expect(ruler.page).to_have_url(re.compile("#/$"))
    expect(ruler.page.get_by_role("link", name="gone.adirf")).to_have_count(0)
    assert set(project.rglob("*")) == before


def test_a_ros_1_bag_is_called_that(ruler: RulerPage, project: Path) -> None:
    (project / "old.bag").write_bytes(ROS1_MAGIC)
    ruler.home()
    ruler.page.reload()
    ruler.button("old.bag (ROS 1)").click()
    dialog = ruler.page.get_by_role("dialog", name="Start from old.bag")
    expect(dialog.get_by_role("alert")).to_contain_text("rosbags-convert --src old.bag --dst old")
    ruler.forgive("422")


def test_the_first_tab_leads_past_the_header(ruler: RulerPage) -> None:
    ruler.page.keyboard.press("Tab")
    expect(ruler.button("Skip to the content")).to_be_focused()
    ruler.page.keyboard.press("Enter")
    expect(ruler.page.get_by_role("heading", level=1)).to_be_focused()


def test_an_address_that_changes_while_the_page_starts_is_followed(ruler: RulerPage) -> None:
    ruler.page.add_init_script(GOES_ON_AT_ONCE)
    ruler.page.goto(ruler.url)
    expect(ruler.text).to_contain_text("CheckValue /odom pose_x")


def test_the_list_tells_what_was_saved_and_what_others_added(ruler: RulerPage, project: Path) -> None:
    first = ruler.page.get_by_role("region", name="Rules").get_by_role("listitem").first
    ruler.open("zone.adirf")
    ruler.text.click()
    ruler.page.keyboard.type("// Seen again.\n")
    ruler.save()
    ruler.page.get_by_role("link", name="Home").click()
    expect(first).to_contain_text(re.compile("zone.adirf.*just now"))
    (project / "of_somebody_else.adirf").write_text("begin\nend\n")
    ruler.page.evaluate("dispatchEvent(new Event('focus'))")
    expect(ruler.page.get_by_role("link", name="of_somebody_else.adirf")).to_be_visible()
