# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""A loop given what another one was given decides the same."""

from __future__ import annotations

import json
from pathlib import Path

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from bags.bag_factory import ODOM, cdr, message_of, odometry
from robot.status.virtual_robot import VirtualRobot
from smarttestudo.bags.definitions import RosbagDecoder
from smarttestudo.cli.main import main
from smarttestudo.domain.decision import AnyDecision, Decision
from smarttestudo.domain.observation import (
    Change,
    LinkBudget,
    ListenersChanged,
    SourceChanged,
    Undecodable,
    VitalsMeasured,
)
from smarttestudo.domain.recording import Channel
from smarttestudo.loop.input_log import input_log
from smarttestudo.loop.inputs import (
    ChangeInput,
    LoopInput,
    MessageInput,
    RecordedInput,
    RulesInput,
    WakeInput,
)
from smarttestudo.replays.inputs import replay_inputs
from smarttestudo.robot.input_recorder import InputRecorder, Note
from smarttestudo.robot.live_rules import LiveRules
from smarttestudo.robot.option import Settings
from smarttestudo.rules.rule_sets import check_texts

MS = 1_000_000
RULES = """\
begin
  SetFrequency odom 10
  SetFrequency /scan 1
  Rule "Far" If (CheckValue odom pose_y > 2) Then SetFrequency /scan 5
  Rule "Stays" If (CheckValue odom pose_y > 2) For 700 ms Then SetFrequency /scan 6
  Rule "Was near" If (CheckValue odom pose_y < 3 Within 1.5 s AND CheckValue odom pose_y > 2 Until < 1)
  Then SetFrequency /scan 7
  Rule "Silent" If (CheckValue odom age > 0.5) Then SetFrequency /scan 9
  Rule "Docking" If (CheckValue /mode data = "docking" Within 200 ms) Then SetFrequency /imu 8
  Rule "Other" If (CheckValue /mode data != "docking" AND CheckValue /mode data != "idle")
  Then SetFrequency /imu 4
end
"""
OTHER_RULES = "begin SetFrequency /scan 3 end"
NAMES = {"odom": "/tb3/odom"}
MODE = Channel(topic="/mode", type_name="std_msgs/msg/String")
SOURCES = [
    ChangeInput(
        stamp_ns=0,
        change=SourceChanged(topic=topic, publishers=1, transient_local=False, type_name=type_name),
    )
    for topic, type_name in (("/tb3/odom", ODOM.type_name), (MODE.topic, MODE.type_name))
]
MODES = {
    80 * MS: "idle",
    2000 * MS: "docking",
    2400 * MS: "idle",
    3000 * MS: "\x1b[2J\u2028$(reboot)" * 200_000,
}
CHANGES: dict[int, Change] = {
    5000 * MS: LinkBudget(link_kb_per_s=20.0),
    5600 * MS: LinkBudget(link_kb_per_s=5.6, is_measured=True),
    6200 * MS: ListenersChanged(topic="/scan", are_there=False),
    6600 * MS: LinkBudget(link_kb_per_s=6.6, is_measured=True),
    8400 * MS: ListenersChanged(topic="/scan", are_there=True),
}


def resolved(topic: str) -> str:
    return NAMES.get(topic, topic)


def live_rules(text: str) -> LiveRules:
    texts = {"rules.adirf": text}
    rule_set = check_texts(texts, resolve=resolved).rule_set
    return LiveRules(rule_set=rule_set, output_topics={}, texts=texts, names=NAMES)


def drive(note: Note) -> list[Decision]:
    """Ten seconds with a walk across a threshold, silence, a bad message, budgets and other rules."""
    recorder, rules = InputRecorder(VirtualRobot(), Settings(), note), live_rules(RULES)
    loop = recorder.loop(rules, 0)

    def take(given: LoopInput) -> None:
        recorder.record(given, rules)
        loop.handle(given)

    for source in SOURCES:
        take(source)
    decode, channel = RosbagDecoder().decode, Channel(topic="/tb3/odom", type_name=ODOM.type_name)
    for now_ns in range(0, 10_000 * MS, 40 * MS):
        while (wake_ns := loop.next_wake_ns) is not None and wake_ns <= now_ns:
            take(WakeInput(stamp_ns=max(wake_ns, now_ns - 40 * MS)))
        take(MessageInput(now_ns, "/scan", b"scan", 3000, publisher=b"gid"))
        if not 6000 * MS < now_ns < 8000 * MS:
            payload = odometry(0.0, now_ns / (1000 * MS))
            message = Undecodable() if now_ns == 4000 * MS else decode(channel, payload)
            take(MessageInput(now_ns, "/tb3/odom", payload, len(payload), message))
        if now_ns in MODES:
            payload = cdr(MODE.type_name, message_of(MODE.type_name, data=MODES[now_ns]))
            take(MessageInput(now_ns, MODE.topic, payload, len(payload), decode(MODE, payload)))
        if now_ns in CHANGES:
            take(ChangeInput(stamp_ns=now_ns, change=CHANGES[now_ns]))
        if now_ns == 9000 * MS:
            rules = live_rules(OTHER_RULES)
            take(RulesInput(stamp_ns=now_ns, rule_set=rules.rule_set, profile=rules.profile))
    return loop.take_decisions()


def test_the_decisions_are_the_same_line_for_line(tmp_path: Path) -> None:
    with input_log(tmp_path / "inputs") as note:
        decisions = drive(note)
    again = tmp_path / "again.jsonl"
    assert main(["replay", str(tmp_path / "inputs"), "--decisions", str(again)]) == 0
    lines = [json.loads(line) for line in again.read_text(encoding="utf-8").split("\n")[:-1]]
    assert lines == [json.loads(json.dumps(decision.to_json())) for decision in decisions]
    assert {line["reason"] for line in lines} >= {"unknown", "default", "block", "budget", "link", "reload"}
    assert {line["rule"] for line in lines} >= {"Stays", "Was near", "Silent", "Docking", "Other"}
    (hostile,) = {
        line["values"]["/mode data"]
        for line in lines
        if line["rule"] == "Other" and line["reason"] == "block"
    }
    assert (len(hostile), hostile[-1]) == (1001, "…")


SOURCE_RULES = """\
begin
  SetFrequency /scan 1
  Rule "Hot" If (CheckValue @machine temperature > 70 Until < 60) Then SetFrequency /scan 5
  Rule "Seen" Priority 1 If (CheckValue @link connected = true AND Not CheckValue @link used > 90 For 2 s)
  Then SetFrequency /scan 9 Else SetFrequency /scan 2
  Rule "Silent" Priority 2 If (CheckValue @link age > 5) Then SetFrequency /scan 3
end
"""
measured = st.one_of(
    st.builds(
        VitalsMeasured,
        source=st.just("@machine"),
        values=st.fixed_dictionaries({"temperature": st.none() | st.floats(50, 80)}),
    ),
    st.builds(
        VitalsMeasured,
        source=st.just("@link"),
        values=st.fixed_dictionaries(
            {
                "connected": st.sampled_from([0.0, 1.0]),
                "used": st.none() | st.floats(0, 100),
                "age": st.floats(0, 10),
            }
        ),
    ),
)


@settings(max_examples=50)
@given(st.lists(st.tuples(st.integers(0, 7000), measured), max_size=12))
def test_what_was_measured_of_machine_and_link_decides_the_same(
    tmp_path_factory: pytest.TempPathFactory, course: list[tuple[int, VitalsMeasured]]
) -> None:
    folder = tmp_path_factory.mktemp("measured")
    rules, now_ns = live_rules(SOURCE_RULES), 0
    with input_log(folder / "inputs") as note:
        recorder = InputRecorder(VirtualRobot(), Settings(), note)
        loop = recorder.loop(rules, 0)
        for gap_ms, change in course:
            then_ns = now_ns + gap_ms * MS
            while (wake_ns := loop.next_wake_ns) is not None and wake_ns <= then_ns:
                recorder.record(woken := WakeInput(stamp_ns=wake_ns), rules)
                loop.handle(woken)
            now_ns = then_ns
            recorder.record(given_change := ChangeInput(stamp_ns=now_ns, change=change), rules)
            loop.handle(given_change)
    again: list[AnyDecision] = []
    replay_inputs(folder / "inputs", again.extend)
    assert [one.to_json() for one in again] == [one.to_json() for one in loop.take_decisions()]


def test_how_long_the_run_was_is_not_said_as_the_time_of_the_replay(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    with input_log(tmp_path / "inputs") as note:
        drive(note)
    assert main(["replay", str(tmp_path / "inputs"), "--json"]) == 0
    told = json.loads(capsys.readouterr().out)
    assert main(["replay", str(tmp_path / "inputs")]) == 0
    assert capsys.readouterr().out.endswith(f" inputs of {told['duration_s']:.1f} s\n")


def test_of_a_message_only_what_decides_is_recorded() -> None:
    recorded: list[RecordedInput] = []
    drive(recorded.append)
    messages = [one for one in recorded if isinstance(one, MessageInput)]
    by_topic = {topic: [one for one in messages if one.topic == topic] for topic in ("/scan", "/tb3/odom")}
    assert {(one.payload, one.size_bytes, one.publisher) for one in by_topic["/scan"]} == {(b"", 3000, 0)}
    assert {len(one.payload) for one in by_topic["/tb3/odom"]} == {0, by_topic["/tb3/odom"][0].size_bytes}
    undecodable = [one for one in messages if one.message is not None]
    assert [(one.stamp_ns, one.payload, one.message) for one in undecodable] == [
        (4000 * MS, b"", Undecodable())
    ]


def test_options_that_recorded_inputs_bring_along_are_refused(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    with input_log(tmp_path) as note:
        drive(note)
    assert main(["replay", str(tmp_path), "--rules", "rules.adirf"]) == 2
    assert capsys.readouterr().err.startswith("--rules: error: ")


def test_inputs_that_were_cut_off_are_replayed_as_far_as_they_go_and_said(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    with input_log(tmp_path) as note:
        drive(note)
    log = tmp_path / "inputs.jsonl"
    log.write_bytes(log.read_bytes()[:-5])
    last = log.read_bytes().count(b"\n") + 1
    assert main(["replay", str(tmp_path)]) == 0
    assert capsys.readouterr().err.splitlines()[-1] == (
        f"note: {log}:{last}: cut off, as where the run was killed or its disk was full; "
        "later decisions are not repeated"
    )


def test_a_recording_still_needs_rules_and_an_output(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    (tmp_path / "bag.mcap").write_bytes(b"\x89MCAP0\r\n")
    assert main(["replay", str(tmp_path / "bag.mcap")]) == 2
    assert capsys.readouterr().err == "--rules: error: a replay of a recording needs it; add --rules\n"


def test_a_folder_that_is_not_there_is_said_before_the_rules_that_are_missing(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    assert main(["replay", str(tmp_path / "inptus"), "--decisions", str(tmp_path / "again.jsonl")]) == 1
    assert capsys.readouterr().err.startswith(f"{tmp_path / 'inptus'}: error: ")
    (tmp_path / "empty").mkdir()
    assert main(["replay", str(tmp_path / "empty")]) == 1
    assert capsys.readouterr().err.startswith(f"{tmp_path / 'empty'}: error: the folder holds no ")
