# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""Times of checks are given and taken away by menus."""

from __future__ import annotations

from pathlib import Path

import pytest
from playwright.sync_api import expect

from ruler.browser.ruler_page import GRIP_PX, RulerPage

ALL_TIMES = """\
begin
    // keep this
    Rule "Slow"  // and this
    If (CheckValue /odom speed < 0.10 // m/s
        AND (CheckValue /scan distance > 1 OR CheckValue /scan distance < 0.2))
    Then
        Record "stuck" /odom Before 30 s After 500 ms // all of it
        SetFrequency /scan 5.0
    EndIf
end
"""


@pytest.mark.journey
def test_times_are_given_by_menus_and_taken_away_with_everything_else_untouched(
    ruler: RulerPage, project: Path
) -> None:
    (project / "slow.adirf").write_text(ALL_TIMES)
    ruler.home()
    ruler.open("slow.adirf")
    check = ruler.blocks.get_by_role("figure", name="/odom, speed")
    check.click(button="right", position={"x": GRIP_PX, "y": GRIP_PX})
    _choose(ruler, "until…")
    ruler.change("Edit value of the end: 0.1", "0.3")
    ruler.expect_lines("speed < 0.10 Until > 0.3 // m/s")
    group = ruler.blocks.get_by_role("figure", name="any of").first
    group.click(button="right", position={"x": GRIP_PX, "y": GRIP_PX})
    _choose(ruler, "within the last…")
    ruler.change("Edit duration: 10", "2")
    ruler.field("unit of time: s").click()
    ruler.page.get_by_role("option", name="min", exact=True).click()
    ruler.expect_lines("CheckValue /scan distance < 0.2) Within 2 min)")
    ruler.save()
    changed = ALL_TIMES.replace("0.10 //", "0.10 Until > 0.3 //").replace("0.2))", "0.2) Within 2 min)")
    assert (project / "slow.adirf").read_text() == changed

    ruler.field("Remove this time").click()
    ruler.field("Remove this end").click()
    expect(ruler.text).not_to_contain_text("Until")
    ruler.save()
    assert (project / "slow.adirf").read_text() == ALL_TIMES


def _choose(ruler: RulerPage, choice: str) -> None:
    ruler.page.get_by_role("menuitem", name=choice, exact=True).click()
    # It opens by itself to type into.
    ruler.page.locator("input:focus").wait_for()
