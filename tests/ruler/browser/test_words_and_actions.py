# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""Rules that read words, name topics of a kind, and act, put together by clicks and read back."""

from __future__ import annotations

import re
from pathlib import Path

import pytest
from playwright.sync_api import Locator, expect

from ruler.browser.ruler_page import RulerPage
from ruler.page_projects import PROJECTS

BEGIN = """\
begin
    SetFrequency /mode Full
    SetFrequency /diagnostics Full
    SetFrequency /gripper Full
"""
WORDS = """
    Rule "Dock"
    If (
        CheckValue /mode data = "docking"
        AND CheckValue /diagnostics status["lidar front"].level > 1
        AND CheckValue /diagnostics status[*].level < 1
        AND CheckValue /gripper holds = true
    )
    Then
        SetFrequency /camera/** 10
    EndIf
end
"""
ACTS = """
    Rule "Dock"
    If CheckValue /odom pose_x > 0
    Then
        SetFrequency /odom 2 .. 20 By /odom speed 3 .. 0.5
        Notify "at the dock"
        Call /light true
        SetParameter /controller max_speed 0.50
    EndIf
end
"""


@pytest.fixture
def project(tmp_path: Path) -> Path:
    folder = tmp_path / "project"
    folder.mkdir()
    PROJECTS["modes"](folder)
    (folder / "dock.adirf").write_text(f"{BEGIN}end\n")
    return folder


@pytest.mark.journey
def test_words_of_a_recording_and_topics_of_a_kind_are_picked_by_clicks(
    ruler: RulerPage, project: Path
) -> None:
    _new_rule(ruler)
    _pick(ruler, "Edit topic to check", "/mode")
    _pick(ruler, "Edit property", "data")
    _pick(ruler, "Edit value", '"docking"')
    ruler.expect_lines('If CheckValue /mode data = "docking"')
    for name in ('status["lidar front"].level', "status[*].level"):
        _add_check(ruler)
        _pick(ruler, "Edit topic to check", "/diagnostics")
        _pick(ruler, "Edit property", name)
        _change(ruler, "Edit value", "1")
    _add_check(ruler)
    _pick(ruler, "Edit topic to check", "/gripper")
    _pick(ruler, "Edit property", "holds")
    _pick(ruler, "Edit value", "true")
    _pick(ruler, "Edit topic to send", "/camera/**")
    ruler.expect_lines("CheckValue /gripper holds = true", "SetFrequency /camera/** 10")
    ruler.save()
    assert (project / "dock.adirf").read_text() == BEGIN + WORDS
    _see_again(
        ruler, ('Edit value: "docking"', 'Edit property: status["lidar front"].level', "Edit value: true")
    )

    # The words of the check stand as a lane over the recording.
    ruler.open_pane("Try on a recording")
    ruler.button("Run the rules on it").click()
    ruler.page.get_by_label("Value and threshold of").select_option(label='/mode data = "docking" (Dock)')
    lane = ruler.page.get_by_role("img", name=re.compile("docking for 4 s"))
    expect(lane).to_contain_text("driving")


@pytest.mark.journey
def test_a_rate_by_a_value_and_actions_are_put_together_by_clicks(ruler: RulerPage, project: Path) -> None:
    _new_rule(ruler)
    _pick(ruler, "Edit topic to check", "/odom")
    ruler.field("Let a value set the rate").click()
    _change(ruler, "Edit rate at the other end", "20")
    _pick(ruler, "Edit topic that sets the rate", "/odom")
    _pick(ruler, "Edit property: distance", "speed")
    ruler.change("Edit rate: 10", "2")
    ruler.expect_lines("SetFrequency /odom 2 .. 20 By /odom speed 3 .. 0.5")
    _act(ruler, "Notify…")
    _change(ruler, "Edit text of the note", "at the dock")
    _act(ruler, "Call a service…")
    _change(ruler, "Edit service to call", "/light")
    ruler.field("value for the service").click()
    ruler.page.get_by_role("option", name="true", exact=True).click()
    _act(ruler, "Set a parameter…")
    _change(ruler, "Edit node of the parameter", "/controller")
    ruler.change("Edit name of the parameter", "max_speed")
    ruler.change("Edit value of the parameter", "0.50")
    ruler.expect_lines("SetParameter /controller max_speed 0.50")
    ruler.save()
    assert (project / "dock.adirf").read_text() == BEGIN + ACTS
    _see_again(ruler, ("Edit text of the note: at the dock", "Edit value at the other rate: 0.5"))

    ruler.field("Set one rate again").click()
    expect(ruler.text).not_to_contain_text("2 .. 20")
    ruler.field("Remove this action").click()
    expect(ruler.text).not_to_contain_text("SetParameter")


def _new_rule(ruler: RulerPage) -> None:
    ruler.open("dock.adirf")
    ruler.button("New rule").click()
    ruler.page.locator("input:focus").wait_for()
    ruler.page.keyboard.press("Escape")
    ruler.change("Edit name of the rule", "Dock")


def _add_check(ruler: RulerPage) -> None:
    ruler.field("Add check").click()
    ruler.page.locator("input:focus").wait_for()
    ruler.page.keyboard.press("Escape")


def _change(ruler: RulerPage, kind: str, value: str) -> None:
    """Type into the lowest field of a kind, whatever it says now."""
    ruler.change(kind, value)


def _pick(ruler: RulerPage, kind: str, word: str) -> None:
    """Click the lowest field of a kind, and what its list offers."""
    if not ruler.is_open(kind):
        ruler.field(kind).click()
    _option(ruler, word).click()
    ruler.field(f"{kind.partition(':')[0]}: {word}").wait_for()


def _option(ruler: RulerPage, word: str) -> Locator:
    exact = ruler.page.locator(".word", has_text=re.compile(f"^{re.escape(word)}$"))
    return ruler.page.get_by_role("option").filter(has=exact)


def _act(ruler: RulerPage, choice: str) -> None:
    ruler.field("Add action").click()
    ruler.page.get_by_role("menuitem", name=choice, exact=True).click()
    ruler.page.locator("input:focus").wait_for()


def _see_again(ruler: RulerPage, labels: tuple[str, ...]) -> None:
    """Open the file anew: the blocks say what they said."""
    ruler.home()
    ruler.open("dock.adirf")
    for label in labels:
        ruler.field(label).wait_for()
