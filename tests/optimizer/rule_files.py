# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""Files for ``testudo optimize``."""

from __future__ import annotations

from pathlib import Path

from optimizer import golden

INSPECTION = """\
begin
    // The shelf that broke last year.
    Rule "Inspection"
    If (CheckValue /odom pose_x > 11 AND CheckValue /odom pose_x < 15)
    Then
        SetFrequency /imu Competitive // it shakes
        SetFrequency /camera/image_raw {camera}
end
"""


def write_inspection(folder: Path, *, camera: str = "Excessive") -> Path:
    path = folder / "inspection.adirf"
    path.write_text(INSPECTION.format(camera=camera), encoding="utf-8")
    return path


def write_profile(folder: Path, budget_kb_per_s: float, *, extra: str = "") -> Path:
    """The golden profile as TOML."""
    path = folder / "profile.toml"
    lines = [f"budget_kb_per_s = {budget_kb_per_s!r}"]
    for name, entry in golden.profile().topics.items():
        lines += [
            f'[topics."{name}"]',
            f"message_kb = {entry.message_kb}",
            f"tiers_hz = {list(entry.tiers_hz or ())}",
        ]
    path.write_text("\n".join([*lines, extra, ""]), encoding="utf-8")
    return path
