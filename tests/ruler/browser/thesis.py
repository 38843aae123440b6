# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""The figures of the thesis that sessions are repeated from."""

from __future__ import annotations

from pathlib import Path

from playwright.sync_api import expect

from optimizer import golden
from ruler.browser.counted_page import CountedPage
from ruler.browser.ruler_page import RulerPage

LEVELS = ("Unacceptable", "Marginal", "Acceptable", "Desirable", "Competitive", "Excessive")
DEFAULT_RATES = golden.DEFAULTS_HZ
FIGURE_6_6 = """\
begin
    If (
        CheckValue /odom pose_x > 11
        AND CheckValue /odom pose_x < 15
        AND CheckValue /odom pose_y > 7
        AND CheckValue /odom pose_y < 11
    )
    Then
        SetFrequency /imu Competitive
        SetFrequency /camera/image_raw Excessive
    EndIf
end
"""


def enter_table(ruler: RulerPage, budget: str, project: Path) -> None:
    """Type the table of Figure A.2 with another budget in KB/s into a new profile, the only one."""
    for old in project.glob("quality/*.toml"):
        old.unlink()
    ruler.home()
    ruler.page.get_by_role("link", name="Topics", exact=True).click()
    ruler.page.get_by_label("Total bandwidth (KB/s)").fill(budget)
    for number, (topic, (message_kb, tiers)) in enumerate(golden.TOPICS.items(), start=1):
        if number > 1:
            ruler.button("Add topic").click()
        ruler.page.get_by_label(f"Topic of row {number}", exact=True).fill(topic)
        ruler.page.get_by_label(f"Message size (KB) of {topic}", exact=True).fill(f"{message_kb:g}")
        for level, tier_hz in zip(LEVELS, tiers, strict=True):
            ruler.page.get_by_label(f"{level} (Hz) of {topic}", exact=True).fill(str(tier_hz))
    ruler.tool("Save").click()
    expect(ruler.page.get_by_text("Saved profile.toml")).to_be_visible()


def build_rule(somebody: CountedPage) -> None:
    """Build the rule of Figure 6.6 in an empty file, with as few clicks as the page allows."""
    somebody.click("button", "New rule")
    _fill(somebody, "value", "11")
    for value in ("15", "7", "11"):
        somebody.click("button", "Add check")
        type_into(somebody, "value", value)
    somebody.press("Tab")
    _pick(somebody, "topic to send", "imu")
    _pick(somebody, "rate", "comp")
    somebody.click("button", "Add rate")
    _pick(somebody, "topic to send", "image_raw")
    type_into(somebody, "rate", "exc")
    somebody.press("Enter")


def build_rule_without_a_mouse(somebody: CountedPage) -> None:
    """The same with the keyboard alone."""
    somebody.walk("Tab", "New rule")
    somebody.press("Enter")
    _fill(somebody, "value", "11")
    for value in ("15", "7", "11"):
        somebody.press("Shift+Enter")
        type_into(somebody, "value", value)
    somebody.press("Tab")
    _pick(somebody, "topic to send", "imu")
    type_into(somebody, "rate", "comp")
    somebody.press("Shift+Enter")
    _pick(somebody, "topic to send", "image_raw")
    type_into(somebody, "rate", "exc")
    somebody.press("Enter")


def type_into(somebody: CountedPage, label: str, text: str) -> None:
    """Type into the field that gets the focus by itself."""
    somebody.await_focus(label)
    somebody.type(text)


def _fill(somebody: CountedPage, label: str, text: str) -> None:
    """Go on from field to field until one, and type there."""
    somebody.await_focus("topic to check")
    somebody.walk("Tab", label, most=4)
    somebody.type(text)


def _pick(somebody: CountedPage, label: str, text: str) -> None:
    """Type a part of what is wanted, and go on to the next field."""
    type_into(somebody, label, text)
    somebody.press("Tab")
