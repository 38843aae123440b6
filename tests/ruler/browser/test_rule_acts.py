# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""A rule is switched off, and comes back."""

from __future__ import annotations

from pathlib import Path

import pytest
from playwright.sync_api import expect

from ruler.browser.ruler_page import RulerPage

THREE = """\
begin
    SetFrequency /odom 10

    // Why there is A.
    Rule "A"
    If CheckValue /odom pose_x > 1
    Then
        SetFrequency /odom 4  // enough
    EndIf

    Rule "B"
    If CheckValue /odom pose_x > 2
    Then
        SetFrequency /odom 5
    EndIf
end
"""


@pytest.fixture
def three(ruler: RulerPage, project: Path) -> RulerPage:
    (project / "three.adirf").write_text(THREE)
    ruler.home()
    ruler.open("three.adirf")
    ruler.field("Edit name of the rule: B")
    return ruler


@pytest.mark.journey
def test_one_undo_brings_a_rule_back(three: RulerPage, project: Path) -> None:
    three.blocks.get_by_role("button", name="Switch this rule off").first.click()
    expect(three.blocks.get_by_text("⊘ switched off")).to_have_count(1)
    three.tool("Undo").click()
    expect(three.blocks.get_by_text("⊘ switched off")).to_have_count(0)
    expect(three.tool("Save")).to_be_disabled()
