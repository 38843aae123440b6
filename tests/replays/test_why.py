# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""``testudo why`` over decisions, replays, recorded inputs and recordings of decisions."""

from __future__ import annotations

import json
import time
from collections.abc import Callable
from pathlib import Path

import pytest

from bags.bag_factory import BagContent, BagMessage, BagTopic, small_mission, write_bag
from replays.test_recorded_inputs import drive
from smarttestudo.cli.main import main
from smarttestudo.domain.names import DECISIONS_TOPIC
from smarttestudo.loop.input_log import input_log
from smarttestudo.pacing.cdr import string_message

RULES = """\
begin
  SetFrequency /odom 10
  SetFrequency /scan 1
  Rule "Far" If (CheckValue /odom pose_y > 2) Then SetFrequency /scan 5
end
"""
Why = Callable[..., tuple[int, list[str], str]]


@pytest.fixture
def why(tmp_path: Path, capsys: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch) -> Why:
    """Exit code, lines and errors; there are a recording, its rules and their decisions."""
    monkeypatch.chdir(tmp_path)
    monkeypatch.setenv("TZ", "UTC")
    time.tzset()
    write_bag(tmp_path / "bag", small_mission())
    (tmp_path / "rules.adirf").write_text(RULES, encoding="utf-8")
    options = ("--rules", "rules.adirf", "--output", "out", "--decisions", "d.jsonl")
    assert main(["replay", "bag", *options]) == 0
    capsys.readouterr()

    def run(*arguments: str) -> tuple[int, list[str], str]:
        code = main(["why", *arguments])
        captured = capsys.readouterr()
        return code, captured.out.splitlines(), captured.err

    return run


def cells(line: str) -> list[str]:
    return [cell.strip() for cell in line.split("  ") if cell.strip()]


def test_a_replay_says_rule_values_and_what_would_change_the_rate_at_any_time(why: Why) -> None:
    code, lines, err = why("/scan", "bag", "--rules", "rules.adirf", "--at", "2.5")
    assert (code, err) == (0, "")
    assert lines[0] == "/scan: 5 Hz (block: Far, line 4)"
    assert lines[1].endswith("2.040 s after the start")
    assert [cells(line) for line in lines[3:4] + lines[5:]] == [
        ["Value", "Then", "Border", "Beyond it"],
        ["/odom pose_y", "2.48", "<= 2", "1 Hz (default)"],
    ]
    code, lines, _ = why("/scan", "bag", "--rules", "rules.adirf", "--at", "1")
    assert (code, lines[0]) == (0, "/scan: 1 Hz (default)")
    assert cells(lines[-1]) == ["/odom pose_y", "1", "> 2", "5 Hz (block: Far, line 4)"]


def test_decisions_say_what_was_read_and_with_the_rules_where_the_rule_ends(why: Why) -> None:
    code, lines, err = why("/scan", "d.jsonl", "--at", "3")
    assert (code, err, lines[0]) == (0, "", "/scan: 5 Hz (block: Far, line 4)")
    assert cells(lines[-1]) == ["/odom pose_y", "2.04", "–", "–"]
    _, lines, _ = why("/scan", "d.jsonl", "--at", "3", "--rules", "rules.adirf")
    assert cells(lines[-1]) == ["/odom pose_y", "2.04", "<= 2", "the rule no longer holds"]
    assert why("/scan", "d.jsonl", "--at", "1.5")[1][0] == "/scan: 1 Hz (default)"


def test_a_topic_that_other_rules_no_longer_relay_is_said_to_be_none(why: Why, tmp_path: Path) -> None:
    path = tmp_path / "d.jsonl"
    last = json.loads(path.read_text(encoding="utf-8").splitlines()[-1])
    end = {**last, "t": 3.5, "stamp_ns": last["stamp_ns"] + 2_000_000_000, "reason": "reload"}
    end.update({"topic": "/scan", "to_hz": 0.0, "rule": None, "line": None, "values": {}, "end": True})
    with path.open("a", encoding="utf-8") as log:
        log.write(f"{json.dumps(end)}\n")
    assert why("/scan", "d.jsonl")[1][0] == "/scan: no longer relayed (reload)"
    assert why("/scan", "d.jsonl", "--at", "3")[1][0] == "/scan: 5 Hz (block: Far, line 4)"


def test_in_a_file_of_several_runs_seconds_are_of_the_last_and_times_of_any(why: Why, tmp_path: Path) -> None:
    path = tmp_path / "d.jsonl"
    lines = [json.loads(line) for line in path.read_text(encoding="utf-8").splitlines()]
    day_ns = 86_400_000_000_000
    runs = [
        {**line, "stamp_ns": 946_684_800_000_000_000 + run * day_ns + line["stamp_ns"] - lines[0]["stamp_ns"]}
        for run in range(3)
        for line in lines
    ]
    path.write_text("".join(f"{json.dumps(line)}\n" for line in runs), encoding="utf-8")
    assert why("/scan", "d.jsonl", "--at", "1.5")[1][1].startswith("since 2000-01-03 00:00:00")
    assert why("/scan", "d.jsonl", "--at", "2000-01-02 00:00:01.5")[1][1].startswith(
        "since 2000-01-02 00:00:00"
    )
    assert why("/scan", "d.jsonl", "--at", "2000-01-01 13:00")[1][1].startswith("since 2000-01-01 00:00:02")
    code, _, err = why("/scan", "d.jsonl", "--at", "1999-12-31 23:59")
    assert code == 2
    assert "it is from 2000-01-01 00:00:00" in err


def test_a_recording_that_has_the_decisions_is_asked_as_they_are(why: Why, tmp_path: Path) -> None:
    lines = (tmp_path / "d.jsonl").read_text(encoding="utf-8").splitlines()
    topic = BagTopic(DECISIONS_TOPIC, "std_msgs/msg/String")
    messages = (
        BagMessage(topic.name, json.loads(line)["stamp_ns"] + 1000, string_message(line)) for line in lines
    )
    write_bag(tmp_path / "kept", BagContent(topics=(topic,), messages=tuple(messages)))
    for at in (("--at", "1.5"), ()):
        assert why("/scan", "kept", *at) == why("/scan", "d.jsonl", *at)
    code, _, err = why("/scan", "bag")
    assert (code, err.count("\n")) == (1, 1)
    assert err.startswith("bag: error: it has no decisions; give a file of --decisions, ")


def test_recorded_inputs_have_their_own_rules_and_what_limited_the_rate(why: Why, tmp_path: Path) -> None:
    with input_log(tmp_path / "inputs") as note:
        drive(note)
    code, lines, err = why("/scan", "inputs", "--at", "5.9")
    assert (code, err, lines[0]) == (0, "", "/scan: 1.396 Hz (link: Was near, line 6)")
    assert lines[2] == "the rules ask for 6 Hz (block: Stays, line 5)"
    code, lines, _ = why("/scan", "inputs")
    assert (code, lines[0]) == (0, "/scan: 2.2 Hz (link)")
    assert lines[2] == "the rules ask for 3 Hz (default)"


@pytest.mark.parametrize(
    ("at", "rate"),
    [
        ("2000-01-01T00:00:03Z", "/scan: 5 Hz (block: Far, line 4)"),
        ("2000-01-01 00:00:01", "/scan: 1 Hz (default)"),
        ("00:00:03", "/scan: 5 Hz (block: Far, line 4)"),
    ],
)
def test_a_time_may_be_one_of_the_clock(why: Why, tmp_path: Path, at: str, rate: str) -> None:
    text = (tmp_path / "d.jsonl").read_text(encoding="utf-8")
    lines = [json.loads(line) for line in text.splitlines()]
    start_ns = lines[0]["stamp_ns"]
    moved = [{**line, "stamp_ns": line["stamp_ns"] - start_ns + 946_684_800_000_000_000} for line in lines]
    (tmp_path / "d.jsonl").write_text("".join(f"{json.dumps(line)}\n" for line in moved), encoding="utf-8")
    assert why("/scan", "d.jsonl", "--at", at)[1][0] == rate


@pytest.mark.parametrize(
    ("arguments", "code", "said"),
    [
        (("/scn", "d.jsonl"), 2, "/scn: error: no rule relays it; did you mean /scan?\n"),
        (("/scan", "--at", "3"), 2, "--at: error: it goes with what was recorded; name what was recorded"),
        (("/scan", "d.jsonl", "--at", "noon"), 2, "--at: error: a time is written as in 12.5 (seconds)"),
        (("/scan", "bag", "--rules", "rules.adirf", "--at", "99"), 2, "--at: error: "),
        (("/scan", "nowhere"), 1, "nowhere: error: "),
        (("/scan", "bag", "--rules", "bad.adirf"), 1, "bad.adirf:1:7: error"),
        (("/scan", "rules.adirf"), 1, "rules.adirf:1: error: not a decision"),
    ],
)
def test_what_cannot_be_explained_is_said_in_one_line(
    why: Why, tmp_path: Path, arguments: tuple[str, ...], code: int, said: str
) -> None:
    (tmp_path / "bad.adirf").write_text("begin Nonsense end", encoding="utf-8")
    ended, lines, err = why(*arguments)
    assert (ended, lines, err.count("\n")) == (code, [], 1)
    assert err.startswith(said)


def test_json_has_the_rate_as_a_decision_has_it_and_the_borders(why: Why) -> None:
    _, (line,), _ = why("/scan", "bag", "--rules", "rules.adirf", "--at", "2.5", "--json")
    told = json.loads(line)
    assert {name: told[name] for name in ("topic", "to_hz", "reason", "rule", "line")} == {
        "topic": "/scan",
        "to_hz": 5.0,
        "reason": "block",
        "rule": "Far",
        "line": 4,
    }
    assert told["decision"]["t"] == 2.04
    (value,) = told["values"]
    (border,) = value["borders"]
    assert (value["signal"], value["value"]) == ("/odom pose_y", 2.48)
    assert (border["where"], border["to_hz"], border["reason"], border["lasting"]) == (
        "<= 2",
        1.0,
        "default",
        False,
    )
