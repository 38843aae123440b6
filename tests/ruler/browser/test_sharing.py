# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""Rules go out of one file and come into another."""

from __future__ import annotations

import base64
from pathlib import Path

from playwright.sync_api import Locator, expect

from ruler.browser.ruler_page import RulerPage

MINE = """\
begin
    SetFrequency /odom 10  // mine

    Rule "Bay"
    If CheckValue /odom pose_x > 1
    Then
        SetFrequency /odom 4
    EndIf
end
"""
THEIRS = """\
begin
    SetFrequency /odom 20
    SetFrequency /imu 5
    KeepAtLeast /scan often

    // fast there
    Rule "Bay"
    If CheckValue /odom pose_x > 2
    Then
        SetFrequency /odom 8
    EndIf

    Rule "Aisle"
    If CheckValue /odom pose_y > 1
    Then
        SetFrequency /odom 2
    EndIf
end
"""


def test_the_selected_rules_are_exported_with_their_comments(
    ruler: RulerPage, project: Path, tmp_path: Path
) -> None:
    (project / "theirs.adirf").write_text(THEIRS)
    ruler.home()
    ruler.open("theirs.adirf")
    ruler.tool("Export").click()
    dialog = ruler.page.get_by_role("dialog", name="Export rules")
    expect(dialog.get_by_role("checkbox", name="KeepAtLeast /scan often")).to_be_disabled()
    dialog.get_by_role("checkbox", name="Rule Bay").check()
    dialog.get_by_role("checkbox", name="/imu at 5 Hz").check()
    with ruler.page.expect_download() as waiting:
        dialog.get_by_role("button", name="Export selected rules").click()
    waiting.value.save_as(tmp_path / "part.adirf")
    imu, bay = (
        THEIRS[THEIRS.index("    SetFrequency /imu") :].splitlines()[0],
        THEIRS[THEIRS.index("    //") :],
    )
    rule = bay[: bay.index("EndIf") + len("EndIf")]
    assert (tmp_path / "part.adirf").read_text() == f"begin\n{imu}\n\n{rule}\nend\n"
    expect(dialog).to_be_hidden()


def test_rules_of_another_file_come_with_a_word_about_whom_they_meet(ruler: RulerPage, project: Path) -> None:
    (project / "mine.adirf").write_text(MINE)
    (project / "theirs.adirf").write_text(THEIRS)
    ruler.home()
    ruler.open("mine.adirf")
    ruler.tool("Import").click()
    dialog = ruler.page.get_by_role("dialog", name="Import rules")
    dialog.get_by_label("From this project").select_option("theirs.adirf")
    expect(dialog.get_by_text("another rule has this name here, in line 4")).to_be_visible()
    expect(dialog.get_by_text("the topic has another default here, in line 2")).to_be_visible()
    expect(dialog.get_by_text("has an error and stays there")).to_be_visible()
    dialog.get_by_role("checkbox", name="/odom at 20 Hz").uncheck()
    _item(dialog, "Rule Bay").get_by_role("checkbox", name="replace it").check()
    found = dialog.get_by_role("list", name="Findings of the import")
    expect(found).to_contain_text("sets /odom to 2")
    dialog.get_by_role("button", name="Import", exact=True).click()
    ruler.expect_lines(
        "SetFrequency /odom 10  // mine", "SetFrequency /imu 5", "// fast there", "pose_x > 2", "Aisle"
    )
    expect(ruler.text).not_to_contain_text("pose_x > 1")
    ruler.tool("Undo").click()
    expect(ruler.text).not_to_contain_text("Aisle")
    expect(ruler.tool("Undo")).to_be_disabled()


def test_a_file_dropped_on_the_editor_is_imported_where_it_was_not_there_before(
    ruler: RulerPage, project: Path
) -> None:
    (project / "mine.adirf").write_text(MINE)
    ruler.home()
    ruler.open("mine.adirf")
    same = MINE.replace("SetFrequency /odom 10  // mine", "SetFrequency /imu 7")
    _drop(ruler, "other.adirf", same.encode())
    dialog = ruler.page.get_by_role("dialog", name="Import rules")
    expect(dialog.get_by_text("is here already, in line 4")).to_be_visible()
    expect(dialog.get_by_role("checkbox", name="Rule Bay")).not_to_be_checked()
    dialog.get_by_role("button", name="Import", exact=True).click()
    ruler.expect_lines("SetFrequency /odom 10  // mine", "SetFrequency /imu 7", "Bay")
    ruler.save()
    assert (project / "mine.adirf").read_text() == MINE.replace(
        "// mine\n", "// mine\n    SetFrequency /imu 7\n"
    )


def test_an_import_with_many_findings_keeps_its_button_in_view(ruler: RulerPage) -> None:
    ruler.open("zone.adirf")
    rules = "".join(
        f'Rule "R{number}" If CheckValue /odom pose_x > {number} Then SetFrequency /odom 5 EndIf\n'
        for number in range(40)
    )
    _drop(ruler, "many.adirf", f"begin\n{rules}end\n".encode())
    dialog = ruler.page.get_by_role("dialog", name="Import rules")
    found = dialog.get_by_role("list", name="Findings of the import").get_by_role("listitem")
    expect(found.nth(30)).to_be_attached()
    expect(dialog.get_by_role("button", name="Import", exact=True)).to_be_in_viewport()


def test_a_dropped_file_that_is_no_text_is_refused_with_a_sentence(ruler: RulerPage) -> None:
    ruler.open("warehouse.adirf")
    _drop(ruler, "image.png", b"\x89PNG\xff")
    expect(ruler.page.get_by_role("alert")).to_contain_text("image.png is not UTF-8 text")


def test_a_rule_file_dropped_on_the_first_screen_becomes_a_file_of_the_project(
    ruler: RulerPage, project: Path
) -> None:
    _drop(ruler, "mine.adirf", MINE.encode())
    ruler.expect_lines("SetFrequency /odom 10  // mine")
    assert (project / "mine.adirf").read_text() == MINE
    ruler.home()
    _drop(ruler, "mine.adirf", b"begin end")
    expect(ruler.page.get_by_role("alert")).to_contain_text("has a mine.adirf already")
    assert (project / "mine.adirf").read_text() == MINE


def _item(dialog: Locator, name: str) -> Locator:
    return dialog.get_by_role("listitem").filter(has=dialog.page.get_by_role("checkbox", name=name))


def _drop(ruler: RulerPage, name: str, data: bytes) -> None:
    """Drop a file of the user's disk on the middle of the page."""
    carried = ruler.page.evaluate_handle(
        """([name, base64]) => {
            const bytes = Uint8Array.from(atob(base64), (letter) => letter.codePointAt(0));
            const carried = new DataTransfer();
            carried.items.add(new File([bytes], name));
            return carried;
        }""",
        [name, base64.b64encode(data).decode()],
    )
    ruler.page.get_by_role("main").dispatch_event("drop", {"dataTransfer": carried})
