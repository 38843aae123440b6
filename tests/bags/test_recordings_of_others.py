# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""One table of recordings that others made, and the right values of each in every command.

Their messages are those that a plain reader finds, and what cannot be decoded is said with its reason. A
reader that changes keeps to it; a recording that was read wrongly gets a row.
"""

from __future__ import annotations

import json
from collections.abc import Sequence
from pathlib import Path
from typing import Any

import pytest

from bags.cases_of_others import CASES
from bags.odd_recordings import grown_between_files
from bags.recorded_by_others import plain_counts
from bags.recording_case import Case, far
from smarttestudo.cli.main import main
from smarttestudo.domain.names import DECISIONS_TOPIC

EVERY_CASE = pytest.mark.parametrize("case", CASES, ids=lambda case: case.name)


@pytest.fixture(scope="module")
def made(tmp_path_factory: pytest.TempPathFactory) -> dict[str, Path]:
    """The recordings that a test of this worker has asked for, by the names of their cases."""
    return {}


@pytest.fixture
def bag(case: Case, made: dict[str, Path], tmp_path_factory: pytest.TempPathFactory) -> Path:
    if case.name not in made:
        made[case.name] = case.make(tmp_path_factory.mktemp("of_others"))
    return made[case.name]


@pytest.fixture
def rules(case: Case, tmp_path: Path) -> Path:
    path = tmp_path / "rules.adirf"
    path.write_text(case.rules)
    return path


def answer(capsys: pytest.CaptureFixture[str], *arguments: object) -> Any:
    """The JSON that a command prints; it may fail for no recording of the table."""
    assert main([*map(str, arguments), "--json"]) == 0, capsys.readouterr().err
    return json.loads(capsys.readouterr().out)


def assert_each_said(said: Sequence[Sequence[str]], notices: list[str]) -> None:
    for words in said:
        assert any(all(word in notice for word in words) for notice in notices), (words, notices)


def assert_said(case: Case, notices: list[str]) -> None:
    """All that is to be said is, and nothing else of a recording of which nothing is odd."""
    assert_each_said(case.said, notices)
    if case.is_quiet:
        assert notices == []


@EVERY_CASE
def test_the_table_counts_as_a_plain_reader_does(case: Case, bag: Path) -> None:
    if case.is_readable_by_others:
        assert plain_counts(bag) == {topic: count for topic, count in case.messages.items() if count}


@EVERY_CASE
def test_info(case: Case, bag: Path, capsys: pytest.CaptureFixture[str]) -> None:
    info = answer(capsys, "bag", "info", bag)
    assert {topic: one["messages"] for topic, one in info["topics"].items()} == case.messages
    if case.duration_s is not None:
        assert info["duration_s"] == pytest.approx(case.duration_s)
    assert (info["readable_percent"] == 100) == case.is_whole
    assert_said(case, info["notices"])


@EVERY_CASE
def test_rates(case: Case, bag: Path, capsys: pytest.CaptureFixture[str]) -> None:
    rates = answer(capsys, "bag", "rates", bag, "--latency")
    assert {topic: one["messages"] for topic, one in rates["topics"].items()} == case.messages
    for topic, rate_hz in case.rates_hz.items():
        assert rates["topics"][topic]["mean_hz"] == pytest.approx(rate_hz, rel=0.02)
    for topic in case.left_out:
        assert rates["topics"][topic].get("latency_mean_s") is None
    assert_said(case, rates["notices"])
    assert_each_said(case.also_said.get("rates", ()), rates["notices"])


@EVERY_CASE
def test_loss(case: Case, bag: Path, capsys: pytest.CaptureFixture[str]) -> None:
    loss = answer(capsys, "bag", "loss", bag)
    assert_each_said(case.also_said.get("loss", ()), loss["notices"])
    assert not any(" 0 messages" in notice for notice in loss["notices"])
    fields = {topic: {*one["points"][0]["fields"]} for topic, one in loss["topics"].items()}
    for topic, name in case.curves.items():
        assert name in fields.get(topic, ()), (fields, loss["notices"])
    for topic, word in case.left_out.items():
        assert topic not in fields
        assert any(topic in one and word in one for one in loss["notices"]), loss["notices"]


@EVERY_CASE
def test_replay(
    case: Case, bag: Path, rules: Path, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    replay = answer(capsys, "replay", bag, "--rules", rules, "--output", tmp_path / "out")
    passed = {topic: one["out"] for topic, one in replay["topics"].items()}
    for topic, (least, most) in case.passes.items():
        assert least <= passed[topic] <= most, (passed, replay["notices"])
    assert_each_said(case.also_said.get("replay", ()), replay["notices"])
    written = plain_counts(tmp_path / "out")
    assert written.pop(DECISIONS_TOPIC, 0) >= len(passed)
    assert written == {topic: count for topic, count in passed.items() if count}


@EVERY_CASE
def test_check(case: Case, bag: Path, rules: Path, capsys: pytest.CaptureFixture[str]) -> None:
    code = main(["check", str(rules), "--bag", str(bag), "--format", "json"])
    found = json.loads(capsys.readouterr().out)
    assert [one["severity"] for one in found if one["severity"] == "error"] == []
    assert code == 0
    assert {one["code"] for one in found} >= case.findings
    assert_each_said(case.also_said.get("check", ()), [one["message"] for one in found])


@EVERY_CASE
def test_report(case: Case, bag: Path, tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    page = tmp_path / "report.html"
    assert main(["bag", "report", str(bag), "-o", str(page)]) == 0, capsys.readouterr().err
    text = page.read_text()
    assert all(topic.rpartition("/")[2] in text for topic in case.messages)


def test_check_looks_at_messages_of_each_definition(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    """The field that is checked is there from the second file on."""
    bag = grown_between_files(tmp_path / "bag")
    rules = tmp_path / "rules.adirf"
    rules.write_text(far("/level", "msg.volt"))
    main(["check", str(rules), "--bag", str(bag), "--format", "json"])
    assert "never-a-number" not in {one["code"] for one in json.loads(capsys.readouterr().out)}
