# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""What ``testudo check --profile`` says about the budget."""

from __future__ import annotations

import json
from pathlib import Path

import pytest

from optimizer import golden
from optimizer.rule_files import write_inspection, write_profile
from smarttestudo.cli.main import main

ZONES = """\
begin
    SetFrequency /imu 50
    SetFrequency /camera/image_raw 2
    Rule "near"
    If (CheckValue /odom pose_x > 1) Then SetFrequency /camera/image_raw 2.2 EndIf
    Rule "far"
    If (CheckValue /odom pose_y < 3) Then SetFrequency /imu {imu} EndIf
end
"""


def findings(rules: Path, profile: Path, capsys: pytest.CaptureFixture[str]) -> dict[str, list[str]]:
    """Messages by code, without those that have nothing to do with the budget."""
    main(["check", str(rules), "--profile", str(profile), "--format", "json"])
    found: dict[str, list[str]] = {}
    for finding in json.loads(capsys.readouterr().out):
        if "budget" in finding["message"]:
            found.setdefault(f"{finding['severity']} {finding['code']}", []).append(finding["message"])
    return found


def write_zones(folder: Path, *, imu: str = "200") -> Path:
    path = folder / "zones.adirf"
    path.write_text(ZONES.format(imu=imu))
    return path


def test_blocks_that_break_the_budget_together_are_named_with_a_state(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    rules, profile = write_zones(tmp_path), write_profile(tmp_path, 13_700.0)
    assert findings(rules, profile, capsys) == {
        "warning situation-over-budget": [
            'where "near" (line 4) and "far" (line 6) hold, as at /odom pose_x = 2, pose_y = 2, '
            "the topics take 13 748 KB/s, 48 more than the budget of 13 700"
        ],
        "warning start-up-over-budget": [
            "at start-up, while nothing is known and every block may hold, the topics take 13 748 KB/s, "
            "48 more than the budget of 13 700"
        ],
    }


def test_the_worst_case_is_named_where_everything_fits(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    rules, profile = write_zones(tmp_path), write_profile(tmp_path, 13_748.0)
    assert findings(rules, profile, capsys) == {
        "info budget-fits": [
            'fits the budget in every situation: where "near" (line 4) and "far" (line 6) hold, as at '
            "/odom pose_x = 2, pose_y = 2, the topics take at most 13 748 of 13 748 KB/s"
        ]
    }


def test_an_unknown_source_rate_of_a_full_topic_proves_nothing(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    rules, profile = write_zones(tmp_path, imu="Full"), write_profile(tmp_path, 1e9)
    assert findings(rules, profile, capsys) == {
        "warning budget-not-proven": ["not proven to fit the budget: the profile lacks source_hz of /imu"]
    }


def test_too_many_cells_are_never_said_to_fit(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    properties = ("pose_x", "pose_y", "pose_z")
    values = " AND ".join(
        f"CheckValue /odom {name} != {value}.5" for name in properties for value in range(24)
    )
    rules = tmp_path / "rules.adirf"
    rules.write_text(f"begin SetFrequency /imu 1 If ({values}) Then SetFrequency /imu 2 EndIf end")
    assert findings(rules, write_profile(tmp_path, 1e9), capsys) == {
        "warning budget-not-proven": [
            "not proven to fit the budget: the conditions of this block make 117649 cells, more than 100 000"
        ]
    }


def test_levels_that_do_not_fit_are_an_error(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    rules, profile = write_inspection(tmp_path), write_profile(tmp_path, golden.SCARCE_KB_PER_S)
    assert main(["check", str(rules), "--profile", str(profile)]) == 1
    printed = capsys.readouterr().out
    assert 'error[infeasible]: "Inspection" needs at least 157 665.72 KB/s' in printed
    assert "/camera/image_raw Marginal fits with 14 605.72 KB/s" in printed


def test_without_a_budget_nothing_is_said(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    rules, profile = write_zones(tmp_path), tmp_path / "profile.toml"
    profile.write_text('[topics."/odom"]\ntype = "nav_msgs/msg/Odometry"\n')
    assert findings(rules, profile, capsys) == {}


def test_levels_without_what_they_need_of_the_profile_are_an_error(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    rules, profile = write_inspection(tmp_path), tmp_path / "profile.toml"
    profile.write_text("settle_s = 0.5\n")
    assert main(["check", str(rules), "--profile", str(profile)]) == 1
    assert "error[profile-incomplete]: /imu is in the rules but not in the profile" in capsys.readouterr().out
