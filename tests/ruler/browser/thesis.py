# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""The figures of the thesis that sessions are repeated from."""

from __future__ import annotations

from pathlib import Path

from playwright.sync_api import expect

from ruler.browser.ruler_page import RulerPage

LEVELS = ("Unacceptable", "Marginal", "Acceptable", "Desirable", "Competitive", "Excessive")
FIGURE_A_2 = {
    "/cmd_vel": (0.052, (5, 10, 15, 18, 20, 25)),
    "/odom": (0.72, (10, 15, 20, 25, 30, 35)),
    "/camera/camera_info": (0.38, (10, 15, 20, 25, 30, 35)),
    "/camera/image_raw/compressed": (420, (5, 10, 15, 20, 30, 35)),
    "/camera/image_raw": (6220, (2, 5, 10, 15, 20, 25)),
    "/imu": (0.32, (50, 75, 100, 150, 200, 250)),
    "/joint_state": (0.12, (2, 4, 6, 8, 10, 15)),
    "/scan": (2.94, (2, 4, 6, 8, 10, 15)),
    "/tf": (0.17, (2, 10, 20, 30, 40, 45)),
}
DEFAULT_RATES = {topic: tiers[0] for topic, (_, tiers) in FIGURE_A_2.items()}
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
    for number, (topic, (message_kb, tiers)) in enumerate(FIGURE_A_2.items(), start=1):
        if number > 1:
            ruler.button("Add topic").click()
        ruler.page.get_by_label(f"Topic of row {number}", exact=True).fill(topic)
        ruler.page.get_by_label(f"Message size (KB) of {topic}", exact=True).fill(str(message_kb))
        for level, tier_hz in zip(LEVELS, tiers, strict=True):
            ruler.page.get_by_label(f"{level} (Hz) of {topic}", exact=True).fill(str(tier_hz))
    ruler.button("Save").click()
    expect(ruler.page.get_by_text("Saved profile.toml")).to_be_visible()
