# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""Text and blocks stay in step, and a file is never rewritten behind its author's back."""

from __future__ import annotations

import threading
from collections.abc import Callable
from pathlib import Path

import pytest
from playwright.sync_api import Route, expect

from ruler.browser.ruler_page import EXAMPLES, RulerPage

RULE_FILES = sorted(path.relative_to(EXAMPLES).as_posix() for path in EXAMPLES.rglob("*.adirf"))
STATEMENT_STARTS = ("SetFrequency", "KeepAtLeast", "If", "Rule")
HOSTILE_LINES = (
    "// <img src=x onerror=alert(1)>",
    "begin",
    '  Rule "<script>alert(2)</script>"',
    "  If (CheckValue",
    "/odom  pose_x>1) Then",
    "  SetFrequency /odom 2 //ä 🤖",
    "end",
)

SPEED = """\
begin
    SetFrequency /scan 3

    Rule "Backwards"
    If CheckValue /odom speed < -1
    Then
        SetFrequency /scan 4
    EndIf
end
"""


def test_every_example_opens_as_blocks_and_saves_the_same_bytes(ruler: RulerPage, project: Path) -> None:
    for name in RULE_FILES:
        before = (project / name).read_bytes()
        ruler.home()
        ruler.open(name)
        ruler.blocks.get_by_role("button", name="Remove this").first.wait_for()
        expect(ruler.blocks.get_by_text("as text", exact=True)).to_have_count(0)
        ruler.button("New rate").click()
        ruler.tool("Undo").click()
        expect(ruler.tool("Undo")).to_be_disabled()
        ruler.page.keyboard.press("Control+s")
        expect(ruler.page.get_by_text(f"Saved {name}")).to_be_visible()
        assert (project / name).read_bytes() == before


def test_two_errors_give_two_marks_and_the_last_good_blocks_stay(ruler: RulerPage, project: Path) -> None:
    ruler.open("warehouse.adirf")
    blocks = ruler.blocks.get_by_role("button", name="topic to send")
    expect(blocks).to_have_count((project / "warehouse.adirf").read_text().count("SetFrequency"))
    before = blocks.count()
    _replace_in_text(ruler, "SetFrequency /odom 10", "SetFrequenzy /odom 10")
    _replace_in_text(ruler, "SetFrequency /scan 3", "SetFrequency /scan often")
    errors = ruler.page.get_by_role("list", name="Findings").get_by_text("Error", exact=True)
    expect(errors).to_have_count(2)
    expect(ruler.page.get_by_text("the blocks show how it was before")).to_be_visible()
    expect(blocks).to_have_count(before)
    ruler.page.get_by_role("list", name="Findings").get_by_role("button", name="SetFrequency").first.click()
    expect(errors).to_have_count(1)
    ruler.expect_lines("begin", "SetFrequency /odom 10")


def test_a_change_on_a_block_changes_one_word_of_the_text(ruler: RulerPage, project: Path) -> None:
    before = (project / "warehouse.adirf").read_text()
    ruler.open("warehouse.adirf")
    ruler.blocks.get_by_role("button", name="Edit rate: 7", exact=True).click()
    ruler.type_value("Full")
    ruler.expect_lines("SetFrequency /cmd_vel Full")
    ruler.save()
    after = (project / "warehouse.adirf").read_text()
    assert after == before.replace("/cmd_vel 7", "/cmd_vel Full")
    ruler.tool("Undo").click()
    ruler.save()
    assert (project / "warehouse.adirf").read_text() == before


@pytest.mark.parametrize("line_end", ["\n", "\r\n"])
def test_line_ends_and_hostile_words_stay_what_they_are(
    ruler: RulerPage, project: Path, line_end: str
) -> None:
    text = line_end.join(HOSTILE_LINES)
    (project / "odd.adirf").write_bytes(text.encode())
    ruler.home()
    ruler.open("odd.adirf")
    ruler.field("Edit value: 1").click()
    ruler.type_value("3")
    ruler.expect_lines("pose_x>3")
    ruler.save()
    assert (project / "odd.adirf").read_bytes() == text.replace("pose_x>1", "pose_x>3").encode()


def _replace_in_text(ruler: RulerPage, old: str, new: str) -> None:
    """Click into the line, select it and put other text there at once: no part of it is checked."""
    ruler.text.get_by_text(old, exact=True).first.click()
    for key in ("End", "Shift+Home"):
        ruler.page.keyboard.press(key)
    ruler.page.keyboard.insert_text(new)


def test_blocks_that_go_together_are_one_request_and_one_step_back(ruler: RulerPage, project: Path) -> None:
    rules = "begin\n    SetFrequency /a 1\n    SetFrequency /b 2\n    SetFrequency /c 3\nend\n"
    (project / "stack.adirf").write_text(rules)
    ruler.home()
    ruler.open("stack.adirf")
    ruler.field("Edit topic to send: /b").hover()
    bin_box = ruler.page.get_by_role("treeitem", name="Rates").bounding_box()
    assert bin_box is not None
    ruler.page.mouse.down()
    ruler.page.mouse.move(bin_box["x"] + 10, bin_box["y"] + 10, steps=12)
    ruler.page.mouse.up()
    expect(ruler.text).not_to_contain_text("/c")
    assert len([url for url in ruler.requests if url.endswith("/api/edit")]) == 1
    ruler.save()
    assert (project / "stack.adirf").read_text() == "begin\n    SetFrequency /a 1\nend\n"
    ruler.tool("Undo").click()
    expect(ruler.text).to_contain_text("SetFrequency /c 3")
    ruler.save()
    assert (project / "stack.adirf").read_text() == rules


@pytest.mark.parametrize(("typed", "value"), [("3,5", "3.5"), ("−2", "-2")])
def test_a_threshold_is_what_was_typed(ruler: RulerPage, project: Path, typed: str, value: str) -> None:
    _type_threshold(ruler, project, typed)
    expect(ruler.blocks.get_by_role("button", name=f"Edit value: {value}", exact=True)).to_be_visible()
    ruler.expect_lines(f"speed < {value}", "Then")


@pytest.mark.parametrize("typed", ["1.000,5", "x"])
def test_what_is_no_number_is_said_and_the_threshold_stays(
    ruler: RulerPage, project: Path, typed: str
) -> None:
    _type_threshold(ruler, project, typed)
    expect(ruler.page.get_by_text(f"“{typed}”")).to_be_visible()
    ruler.page.keyboard.press("Escape")
    expect(ruler.blocks.get_by_role("button", name="Edit value: 1", exact=True)).to_be_visible()
    ruler.expect_lines("speed < 1", "Then")


def _type_threshold(ruler: RulerPage, project: Path, typed: str) -> None:
    (project / "speed.adirf").write_text(SPEED.replace("-1", "1"))
    ruler.home()
    ruler.open("speed.adirf")
    ruler.field("Edit value: 1").click()
    ruler.page.keyboard.press("Control+a")
    ruler.page.keyboard.press("Delete")
    ruler.page.keyboard.insert_text(typed)
    ruler.page.keyboard.press("Enter")


def test_a_mark_stays_on_its_words_when_a_block_is_added_above(ruler: RulerPage, project: Path) -> None:
    (project / "speed.adirf").write_text(SPEED)
    ruler.home()
    ruler.open("speed.adirf")
    marked = ruler.text.locator(".cm-lintRange-warning")
    expect(marked).to_have_text(["CheckValue /odom speed < -1"])
    ruler.button("New rate").click()
    ruler.expect_lines("SetFrequency /odom 10", "If CheckValue")
    expect(marked).to_have_text(["CheckValue /odom speed < -1"])
    ruler.tool("Undo").click()
    expect(marked).to_have_text(["CheckValue /odom speed < -1"])


def test_a_block_drawn_once_its_text_is_right_can_be_edited(ruler: RulerPage, project: Path) -> None:
    (project / "speed.adirf").write_text(SPEED)
    ruler.home()
    ruler.open("speed.adirf")
    ruler.field("Edit topic to send: /scan").wait_for()
    _replace_in_text(ruler, "SetFrequency /scan 3", "SetFrequency /scan")
    expect(ruler.page.get_by_text("the blocks show how it was before")).to_be_visible()
    expect(ruler.blocks.get_by_role("button", name="Edit topic to send")).to_have_count(0)
    ruler.page.keyboard.insert_text(" 3 SetFrequency /imu 4")
    expect(ruler.blocks.get_by_role("button", name="Edit topic to send: /imu")).to_have_count(1)
    expect(ruler.blocks.get_by_role("button", name="Remove this rate")).to_have_count(3)


def test_completions_grow_when_more_topics_are_known_while_they_are_open(
    ruler: RulerPage, project: Path
) -> None:
    answer = _type_while_topics_wait(ruler, project, "SetFrequency /gripper 3\nSetFrequency /gr")
    ruler.page.keyboard.press("Control+Space")
    answer()
    expect(ruler.page.get_by_role("option", name="/gripper")).to_be_visible()


def test_the_list_of_a_field_grows_when_more_topics_are_known_while_it_is_open(
    ruler: RulerPage, project: Path
) -> None:
    answer = _type_while_topics_wait(ruler, project, "SetFrequency /gripper 3")
    ruler.field("Edit topic to send: /scan").click()
    listed = ruler.page.get_by_role("listbox", name="topic to send").get_by_role("option")
    expect(listed).not_to_have_count(0)
    gripper = listed.filter(has_text="/gripper")
    expect(gripper).to_have_count(0)
    answer()
    expect(gripper).to_have_count(1)


def _type_while_topics_wait(ruler: RulerPage, project: Path, typed: str) -> Callable[[], None]:
    """Type instead of a line, and call the result to let the page know the topics of the text."""
    (project / "speed.adirf").write_text(SPEED)
    ruler.home()
    ruler.open("speed.adirf")
    ruler.field("Edit topic to send: /scan")
    waiting: list[Route] = []
    # What is asked once the first answer came waits for nobody.
    is_over = threading.Event()

    def hold(route: Route) -> None:
        if is_over.is_set():
            route.continue_()
        else:
            waiting.append(route)

    def answer() -> None:
        is_over.set()
        for route in waiting:
            route.continue_()

    ruler.page.route("**/api/vocabulary", hold)
    with ruler.page.expect_request("**/api/vocabulary"):
        _replace_in_text(ruler, "SetFrequency /scan 3", typed)
    return answer
