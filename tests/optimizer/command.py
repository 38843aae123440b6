# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""``testudo`` on files in a folder."""

from __future__ import annotations

import argparse
import sys
from pathlib import Path

from optimizer import golden
from smarttestudo.cli import optimize
from smarttestudo.domain.errors import TestudoError

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


def main(*argv: str) -> int:
    """The exit code of the command; its output goes where it always goes."""
    parser = argparse.ArgumentParser()
    optimize.add_parser(parser.add_subparsers())
    arguments = parser.parse_args(argv)
    try:
        code: int = arguments.run(arguments)
    except TestudoError as error:
        sys.stderr.write(f"{error}\n")
        return 1
    return code


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
