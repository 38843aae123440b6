# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""A loop given what another one was given decides the same."""

from __future__ import annotations

import json
from collections.abc import Callable
from pathlib import Path

import pytest

from bags.bag_factory import ODOM, odometry
from smarttestudo.adapters.files.input_log import input_log
from smarttestudo.adapters.rosbag import RosbagDecoder
from smarttestudo.cli.main import main
from smarttestudo.composition.rule_sets import check_texts
from smarttestudo.domain.decision import Decision
from smarttestudo.domain.observation import LinkBudget, SourceChanged, Undecodable
from smarttestudo.domain.profile import Profile
from smarttestudo.domain.recording import Channel
from smarttestudo.runtime.inputs import LoopInput, RulesInput
from smarttestudo.runtime.recording_loop import RecordingLoop

MS = 1_000_000
RULES = """\
begin
  SetFrequency odom 10
  SetFrequency /scan 1
  Rule "Far" If (CheckValue odom pose_y > 2) Then SetFrequency /scan 5
  Rule "Silent" If (CheckValue odom age > 0.5) Then SetFrequency /scan 9
end
"""
OTHER_RULES = "begin SetFrequency /scan 3 end"
NAMES = {"odom": "/tb3/odom"}


def resolved(topic: str) -> str:
    return NAMES.get(topic, topic)


def drive(note: Callable[[LoopInput], None]) -> list[Decision]:
    """Ten seconds with a walk across a threshold, silence, a bad message, a budget and other rules."""
    texts = {"rules.adirf": RULES}
    note(RulesInput(stamp_ns=0, rule_texts=texts, names=NAMES))
    loop = RecordingLoop(check_texts(texts, resolve=resolved).rule_set, Profile(), 0, note=note)
    source = SourceChanged(topic="/tb3/odom", publishers=1, transient_local=False, type_name=ODOM.type_name)
    loop.on_source(source, 0)
    decode, channel = RosbagDecoder().decode, Channel(topic="/tb3/odom", type_name=ODOM.type_name)
    for now_ns in range(0, 10_000 * MS, 40 * MS):
        while (wake_ns := loop.next_wake_ns) is not None and wake_ns <= now_ns:
            loop.on_wake(max(wake_ns, now_ns - 40 * MS))
        loop.on_message("/scan", now_ns, b"scan", 3000, publisher=b"gid")
        if not 6000 * MS < now_ns < 8000 * MS:
            payload = odometry(0.0, now_ns / (1000 * MS))
            message = Undecodable() if now_ns == 4000 * MS else decode(channel, payload)
            loop.on_message("/tb3/odom", now_ns, payload, len(payload), message=message)
        if now_ns == 5000 * MS:
            loop.on_budget(LinkBudget(link_kb_per_s=20.0), now_ns)
        if now_ns == 9000 * MS:
            other = {"rules.adirf": OTHER_RULES}
            note(RulesInput(stamp_ns=now_ns, rule_texts=other, names=NAMES))
            loop.reload(check_texts(other, resolve=resolved).rule_set, Profile(), now_ns)
    return loop.take_decisions()


def test_the_decisions_are_the_same_line_for_line(tmp_path: Path) -> None:
    with input_log(tmp_path / "inputs") as note:
        decisions = drive(note)
    again = tmp_path / "again.jsonl"
    assert main(["replay", str(tmp_path / "inputs"), "--decisions", str(again)]) == 0
    lines = [json.loads(line) for line in again.read_text(encoding="utf-8").splitlines()]
    assert lines == [json.loads(json.dumps(decision.to_json())) for decision in decisions]
    assert {line["reason"] for line in lines} >= {"unknown", "default", "block", "budget", "reload"}


def test_options_that_recorded_inputs_bring_along_are_refused(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    with input_log(tmp_path) as note:
        drive(note)
    assert main(["replay", str(tmp_path), "--rules", "rules.adirf"]) == 2
    assert capsys.readouterr().err.startswith("--rules: error: ")


def test_a_recording_still_needs_rules_and_an_output(capsys: pytest.CaptureFixture[str]) -> None:
    assert main(["replay", "bag"]) == 2
    assert capsys.readouterr().err == "--rules: error: needed to replay a recording; see --help\n"
