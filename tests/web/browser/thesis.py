# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""The figures of the thesis that sessions are repeated from."""

from __future__ import annotations

from pathlib import Path

from playwright.sync_api import expect

from optimizer import golden
from web.browser.ruler_page import RulerPage

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
    ruler.button("Configure Topic Parameters").click()
    ruler.page.get_by_label("Total bandwidth (KB/s)").fill(budget)
    for number, (topic, (message_kb, tiers)) in enumerate(golden.TOPICS.items(), start=1):
        if number > 1:
            ruler.button("Add topic").click()
        ruler.page.get_by_label(f"Topic of row {number}", exact=True).fill(topic)
        ruler.page.get_by_label(f"Message size (KB) of {topic}", exact=True).fill(f"{message_kb:g}")
        for level, tier_hz in zip(LEVELS, tiers, strict=True):
            ruler.page.get_by_label(f"{level} (Hz) of {topic}", exact=True).fill(str(tier_hz))
    ruler.button("Save").click()
    expect(ruler.page.get_by_text("Saved profile.toml")).to_be_visible()
