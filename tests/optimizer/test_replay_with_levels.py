# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""Replays of files with levels, and replays within a budget, from the command line."""

from __future__ import annotations

import json
from pathlib import Path

import pytest

from smarttestudo.bags.writer import create_recording
from smarttestudo.cli.main import main
from smarttestudo.domain.recording import Channel, Storage

S = 1_000_000_000
SECONDS = 10
RULES = """\
begin
    SetFrequency /scan Marginal
    SetFrequency /image Acceptable
end
"""
PROFILE = """\
budget_kb_per_s = {budget}
[topics."/scan"]
message_kb = 1.0
tiers_hz = [2, 5, 10, 20, 30, 40]
[topics."/image"]
message_kb = 20.0
tiers_hz = [1, 5, 10, 15, 20, 25]
priority = 0.5
"""


@pytest.fixture
def bag(tmp_path: Path) -> Path:
    """Ten seconds of scans of 1 KB and images of 20 KB, 40 a second each."""
    path = tmp_path / "bag"
    scan = Channel(topic="/scan", type_name="sensor_msgs/msg/LaserScan")
    image = Channel(topic="/image", type_name="sensor_msgs/msg/Image")
    with create_recording(path, storage=Storage.SQLITE3, declared_bytes={}) as writer:
        for number in range(40 * SECONDS + 1):
            writer.write(scan, S + number * S // 40, bytes(1000))
            writer.write(image, S + number * S // 40, bytes(20_000))
    return path


def replayed(
    bag: Path, capsys: pytest.CaptureFixture[str], *options: str, budget: float = 1000.0
) -> dict[str, dict[str, float]]:
    folder = bag.parent
    rules, profile = folder / "rules.adirf", folder / "profile.toml"
    rules.write_text(RULES)
    profile.write_text(PROFILE.format(budget=budget))
    files = ["--rules", str(rules), "--profile", str(profile), "--output", str(folder / "out")]
    code = main(["replay", str(bag), *files, "--json", *options])
    assert code == 0, capsys.readouterr().err
    topics: dict[str, dict[str, float]] = json.loads(capsys.readouterr().out)["topics"]
    return topics


def test_a_file_with_levels_is_replayed_at_the_rates_that_optimize_writes(
    bag: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    topics = replayed(bag, capsys)
    assert topics["/scan"]["target_hz"] == pytest.approx(5)
    assert topics["/image"]["target_hz"] == pytest.approx(10)


def test_levels_that_do_not_fit_are_refused_before_anything_is_written(
    bag: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    with pytest.raises(
        AssertionError, match=r"the defaults need at least 102 KB/s, 2 more than the budget of 100"
    ):
        replayed(bag, capsys, budget=100.0)
    assert not (bag.parent / "out").exists()


def test_a_replay_within_a_budget_takes_no_more_and_says_why(
    bag: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    decisions = bag.parent / "decisions.jsonl"
    topics = replayed(bag, capsys, "--budget", "100", "--decisions", str(decisions))
    three_of_each_kb = 3 * 21.0
    assert topics["/scan"]["out_kb"] + topics["/image"]["out_kb"] <= 100 * SECONDS + three_of_each_kb
    assert topics["/scan"]["mean_hz"] == pytest.approx(5, rel=0.02)
    assert topics["/image"]["mean_hz"] == pytest.approx(4.75, rel=0.02)
    last = json.loads(decisions.read_text().splitlines()[-1])
    assert (last["topic"], last["reason"]) == ("/image", "budget")


@pytest.mark.parametrize("budget", ["-1", "nan", "inf", "much"])
def test_a_budget_that_is_no_number_of_kb_is_wrong_usage(
    budget: str, bag: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    assert main(["replay", str(bag), f"--budget={budget}"]) == 2
    assert f"a budget is a number of KB/s from 0 to 1e+09, not '{budget}'" in capsys.readouterr().err
