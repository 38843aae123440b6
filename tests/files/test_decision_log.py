# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""A live run's decisions are on disk as soon as they are made."""

from __future__ import annotations

import json
from pathlib import Path

import pytest

from smarttestudo.adapters.files.decision_log import growing_decision_log
from smarttestudo.adapters.files.whole_file import OutputFileError
from smarttestudo.domain.decision import Decision, PlannedRate, Reason
from smarttestudo.domain.rate import Rate

DECISION = Decision(
    t_s=0.5,
    stamp_ns=500_000_000,
    topic="/odom",
    from_rate=Rate(10.0),
    planned=PlannedRate(rate=Rate(4.0), reason=Reason.DEFAULT),
    values={},
)


def lines(path: Path) -> list[object]:
    return [json.loads(line) for line in path.read_text(encoding="utf-8").splitlines()]


def test_each_decision_is_there_at_once_and_a_second_run_adds_to_it(tmp_path: Path) -> None:
    path = tmp_path / "decisions.jsonl"
    with growing_decision_log(path) as append:
        append([DECISION])
        assert lines(path) == [DECISION.to_json()]
    with growing_decision_log(path) as append:
        append([DECISION])
    assert lines(path) == [DECISION.to_json()] * 2


def test_a_full_disk_is_said_with_the_files_name() -> None:
    full = Path("/dev/full")
    with (
        growing_decision_log(full) as append,
        pytest.raises(OutputFileError, match=r"/dev/full: error: .*No space"),
    ):
        append([DECISION])


def test_a_folder_that_does_not_exist_is_said_before_the_run(tmp_path: Path) -> None:
    with (
        pytest.raises(OutputFileError, match="cannot be written"),
        growing_decision_log(tmp_path / "no" / "d.jsonl"),
    ):
        pass
