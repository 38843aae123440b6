# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""A live run's decisions are on disk as soon as they are made."""

from __future__ import annotations

import json
import math
from dataclasses import replace
from pathlib import Path

import pytest
from hypothesis import given
from hypothesis import strategies as st

from smarttestudo.domain.decision import Decision, PlannedRate, Reason
from smarttestudo.domain.json_text import json_text
from smarttestudo.domain.rate import Rate
from smarttestudo.files.whole_file import OutputFileError
from smarttestudo.loop.decision_log import (
    DecisionLogError,
    decision_log,
    growing_decision_log,
    read_decisions,
)

DECISION = Decision(
    t_s=0.5,
    stamp_ns=500_000_000,
    topic="/odom",
    from_rate=Rate(10.0),
    planned=PlannedRate(rate=Rate(4.0), reason=Reason.DEFAULT),
    values={},
)


ODD_SIGN = json.dumps({**DECISION.to_json(), "infinite": {"/scan distance": "far"}})


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


@pytest.mark.parametrize("reached_bytes", range(1, len(json_text(DECISION.to_json())) + 1, 5))
@pytest.mark.parametrize("lost_bytes", [0, 4096])
def test_half_a_decision_of_a_former_run_is_cut_off_by_the_next(
    tmp_path: Path, reached_bytes: int, lost_bytes: int
) -> None:
    path = tmp_path / "decisions.jsonl"
    line = json_text(DECISION.to_json()).encode()
    path.write_bytes(line + b"\n" + line[:reached_bytes] + bytes(lost_bytes))
    with growing_decision_log(path) as append:
        append([DECISION])
    assert read_decisions(path) == [DECISION] * 2


@pytest.mark.parametrize(
    "content",
    [b"notes", b'{"a": 1}', b"begin\nend", b"\xff\xd8\xff\xe0", b'{"t": 0.5, "x": 1}\n', b"\n", b"\0\0\1"],
)
def test_a_file_that_is_no_log_is_refused_and_stays_as_it_is(tmp_path: Path, content: bytes) -> None:
    path = tmp_path / "other.txt"
    path.write_bytes(content)
    refused = rf"^{path}: error: .* the file there holds something else; name another output, or remove it$"
    for log in (growing_decision_log, decision_log):
        with pytest.raises(OutputFileError, match=refused), log(path):
            pass
        assert path.read_bytes() == content


@pytest.mark.parametrize("content", [b"", b"\0" * 4096, b'{"', b'{"t": 0.5, "st'])
def test_a_file_with_nothing_or_half_a_decision_is_a_log(tmp_path: Path, content: bytes) -> None:
    path = tmp_path / "decisions.jsonl"
    path.write_bytes(content)
    with growing_decision_log(path) as append:
        append([DECISION])
    assert read_decisions(path) == [DECISION]


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


rates = st.one_of(st.just(Rate.full()), st.floats(0, 1e6).map(Rate))
decisions = st.builds(
    Decision,
    t_s=st.integers(0, 10**12).map(lambda us: us / 1e6),
    stamp_ns=st.integers(0, 2**62),
    topic=st.just("/odom"),
    from_rate=st.none() | rates,
    planned=st.builds(
        PlannedRate,
        rate=rates,
        reason=st.sampled_from(Reason),
        rule=st.none() | st.text(),
        line=st.none() | st.integers(1),
    ),
    values=st.dictionaries(st.text(), st.none() | st.floats(allow_nan=False)),
)


@given(st.lists(decisions))
def test_what_is_written_is_read_again(tmp_path_factory: pytest.TempPathFactory, log: list[Decision]) -> None:
    path = tmp_path_factory.mktemp("log") / "decisions.jsonl"
    with growing_decision_log(path) as append:
        append(log)
    assert read_decisions(path) == log


def test_an_infinite_value_is_told_from_an_unknown_one_and_null_to_who_does_not_know_that(
    tmp_path: Path,
) -> None:
    path = tmp_path / "decisions.jsonl"
    values = {"/scan distance": math.inf, "/odom speed": -math.inf, "/odom yaw": None, "/odom pose_x": 1.0}
    with growing_decision_log(path) as append:
        append([replace(DECISION, values=values)])
    (line,) = path.read_text().splitlines()
    record = json.loads(line, parse_constant=pytest.fail)
    assert record["infinite"] == {"/scan distance": "inf", "/odom speed": "-inf"}
    known_by_all = {name: value if name == "/odom pose_x" else None for name, value in values.items()}
    assert record["values"] == known_by_all
    assert read_decisions(path)[0].values == values
    del record["infinite"]
    path.write_text(f"{json.dumps(record)}\n")
    assert read_decisions(path)[0].values == known_by_all


def test_a_last_line_that_was_cut_off_costs_that_line(tmp_path: Path) -> None:
    path = tmp_path / "decisions.jsonl"
    with growing_decision_log(path) as append:
        append([DECISION, DECISION])
    path.write_bytes(path.read_bytes()[:-5])
    assert read_decisions(path) == [DECISION]


@pytest.mark.parametrize("line", ["", "[]", "{}", '{"t": "soon"}', "[" * 100_000, ODD_SIGN])
def test_a_line_that_is_no_decision_is_named(tmp_path: Path, line: str) -> None:
    path = tmp_path / "decisions.jsonl"
    path.write_text(f"{json.dumps(DECISION.to_json())}\n{line}\n", encoding="utf-8")
    with pytest.raises(DecisionLogError, match=r"decisions\.jsonl:2: error: not a decision"):
        read_decisions(path)


@pytest.mark.parametrize("text", ["notes", f"{json.dumps(DECISION.to_json())}\nnotes"])
def test_a_last_line_that_is_no_part_of_a_decision_is_named(tmp_path: Path, text: str) -> None:
    path = tmp_path / "decisions.jsonl"
    path.write_text(text, encoding="utf-8")
    with pytest.raises(DecisionLogError, match=rf"{text.count(chr(10)) + 1}: error: not a decision"):
        read_decisions(path, pytest.fail)
