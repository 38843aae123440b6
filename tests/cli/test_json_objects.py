# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""The objects of ``--json`` and the columns of ``--csv``, which scripts read: no key may change unseen."""

from __future__ import annotations

import json
import shutil
from pathlib import Path
from typing import Any

import pytest

from report.bag_desk import mission_bags
from report.golden_files import assert_reads_as
from smarttestudo.cli.main import main

GOLDEN = Path(__file__).parent / "golden"
RULES = """begin
    SetFrequency /odom 5
    SetFrequency /scan Desirable
    KeepAtLeast /odom 0.5
    KeepWithin /odom position 0.3
    Rule "Fast" If (CheckValue /odom pose_y > 2.5) Then
        SetFrequency /odom 10
        KeepWithin /odom position 0.05
        Record "fast"
            Before 1 s
            After 1 s
    EndIf
    If (CheckValue /scan rate < 1 OR CheckValue /odom pose_x > 1000) Then SetFrequency /odom Full
end
"""
DOUBTFUL = """begin
    SetFrequncy /odom 5
    Rule "a" If (CheckValue /odom pose_y > 1) Then SetFrequency /odom 5 EndIf
end
"""
PROFILE = """budget_kb_per_s = 100.0
[topics."/odom"]
type = "nav_msgs/msg/Odometry"
message_kb = 0.7
source_hz = 25.0
tiers_hz = [1.0, 2.0, 5.0, 10.0, 20.0, 25.0]
tiers_m = [0.5, 0.2, 0.1, 0.05, 0.02, 0.01]
tiers_m_need_hz = [0.5, 1.0, 2.0, 4.0, 8.0, 16.0]
[topics."/scan"]
message_kb = 3.0
source_hz = 5.0
tiers_hz = [0.5, 1.0, 2.0, 3.0, 4.0, 5.0]
"""
PAIR = ("sent", "seen")
DECIDED = ("--rules", "rules.adirf", "--profile", "profile.toml")
COMMANDS = {
    "info": ("bag", "info", "bag", "--topics", "/image"),
    "rates": ("bag", "rates", "sent", "--latency", "--topics", "/odom", "/scan"),
    "several": ("bag", "bandwidth", "sent", "seen", "--topics", "/odom"),
    "compare": ("bag", "compare", *PAIR),
    "loss": ("bag", "loss", *PAIR, *DECIDED, "--predict", "/odom"),
    "curve": ("bag", "loss", "sent", "--topics", "/odom"),
    "accuracy": ("bag", "accuracy", "sent", *DECIDED),
    "report": ("bag", "report", "one", "other", *DECIDED, "-o", "report.html"),
    "replay": ("replay", "sent", *DECIDED, "--output", "out", "--incidents", "incidents"),
    "incident": ("bag", "info", "incidents"),
}
WITHOUT_CSV = {"replay"}


def rounded(value: Any) -> Any:
    """``value`` without sentences, and without what another processor, library or second makes different."""
    if isinstance(value, dict):
        return {key: rounded(one) for key, one in value.items() if key != "wall_seconds"}
    if isinstance(value, list):
        return [rounded(one) for one in value[:3]]
    if isinstance(value, str):
        return value if len(value.split()) < 4 else "a sentence"
    return float(f"{value:.6g}") if isinstance(value, float) else value


def shown(texts: list[str]) -> str:
    """Each object by itself, its keys in order, for whom reads the file."""
    return "".join(f"{json.dumps(rounded(json.loads(text)), indent=1, sort_keys=True)}\n" for text in texts)


@pytest.fixture
def desk(tmp_path: Path, tmp_path_factory: pytest.TempPathFactory, monkeypatch: pytest.MonkeyPatch) -> Path:
    shutil.copytree(mission_bags(tmp_path_factory), tmp_path, dirs_exist_ok=True)
    monkeypatch.chdir(tmp_path)
    for run in ("one", "other"):
        for robot in ("ada", "bo"):
            shutil.copytree(PAIR[run == "other"], f"{run}/{robot}/tour")
    for name, text in {"rules.adirf": RULES, "doubtful.adirf": DOUBTFUL, "profile.toml": PROFILE}.items():
        Path(name).write_text(text, encoding="utf-8")
    return tmp_path


@pytest.mark.contract
def test_the_objects_and_columns_of_recordings_are_those_of_the_golden_files(
    desk: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    capsys.readouterr()
    objects, columns = [], []
    for name, command in COMMANDS.items():
        assert main([*command, "--json"]) == 0, name
        objects.append(f"# {name}\n{shown(capsys.readouterr().out.splitlines())}")
        if name not in WITHOUT_CSV:
            assert main([*command, "--csv"]) == 0, name
            columns.append(f"{name}: {capsys.readouterr().out.splitlines()[0]}\n")
    assert_reads_as(GOLDEN / "objects.txt", "".join(objects))
    assert_reads_as(GOLDEN / "columns.txt", "".join(columns))


def test_the_objects_of_rules_are_those_of_the_golden_file(
    desk: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    capsys.readouterr()
    texts = []
    for command in (
        ("check", "doubtful.adirf", "--format", "json"),
        ("check", "rules.adirf", "--profile", "profile.toml", "--format", "json"),
        ("optimize", "rules.adirf", "--profile", "profile.toml", "--explain", "--json"),
        ("optimize", "rules.adirf", "--profile", "profile.toml", "--budget", "4", "--json"),
    ):
        main(list(command))
        texts.append(capsys.readouterr().out)
    assert_reads_as(GOLDEN / "rule-objects.txt", shown(texts))


def test_the_lines_of_decisions_are_those_of_the_golden_file(
    desk: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    assert main(["replay", "sent", *DECIDED, "--output", "out", "--decisions", "decisions.jsonl"]) == 0
    assert_reads_as(GOLDEN / "decisions.txt", shown(Path("decisions.jsonl").read_text("utf-8").splitlines()))
