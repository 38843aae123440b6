# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""What a recording says of the rates in force, and that nothing counts it among the robot's topics."""

from __future__ import annotations

import json
from pathlib import Path
from typing import Any

import pytest
from rosbags.highlevel import AnyReader

from bags.bag_factory import START_NS, BagContent, BagMessage, BagTopic, small_mission, write_bag
from bags.bag_reading import read_bag
from replays.replay_runs import ReplayRun, replay_bag, replay_content
from report.golden_files import assert_reads_as
from report.listed_decisions import listed_decisions
from smarttestudo.api import measure_loss, read_rules
from smarttestudo.bags.reader import open_recording
from smarttestudo.bags.recording_sink import RecordingSink
from smarttestudo.cli.main import main
from smarttestudo.domain.decision import Decision
from smarttestudo.domain.errors import RecordingError, UsageError
from smarttestudo.domain.link import ReceivedMessage, StreamInfo
from smarttestudo.domain.names import DECISIONS_TOPIC, OWN_TOPICS, STATUS_TOPIC, TEXT_TYPE, is_own_topic
from smarttestudo.domain.recording import Storage
from smarttestudo.loop.decision_log import decision_text
from smarttestudo.pacing.cdr import string_message
from smarttestudo.replays.decisions import kept_decisions
from smarttestudo.replays.moment import recorded_decisions
from smarttestudo.report.fleet.measure import RecordingQuestion, measure_recording
from smarttestudo.robot.decisions import DECISIONS_QOS

GOLDEN = Path(__file__).parent / "golden" / "recorded-decisions.txt"
MISSION = small_mission()
RULES = """\
  SetFrequency /odom 10
  SetFrequency /scan 1
  Rule "Far" If (CheckValue /odom pose_y > 2) Then
    SetFrequency /scan 5
    KeepWithin /odom position 0.5
  EndIf
"""
SAID = BagTopic(STATUS_TOPIC, TEXT_TYPE)
DECIDED = BagTopic(DECISIONS_TOPIC, TEXT_TYPE)


def text_of(message: BagMessage) -> str:
    assert message.payload[:4] == b"\x00\x01\x00\x00"
    return message.payload[8:-1].decode()


def also(content: BagContent, *messages: BagMessage, topics: tuple[BagTopic, ...] = (DECIDED,)) -> BagContent:
    """``content`` with what a SmartTestudo node said."""
    in_order = sorted((*content.messages, *messages), key=lambda one: one.stamp_ns)
    return BagContent((*content.topics, *topics), tuple(in_order))


@pytest.mark.parametrize("storage", Storage)
def test_a_replay_records_the_lines_of_its_decisions_at_their_times(tmp_path: Path, storage: Storage) -> None:
    run = replay_content(MISSION, RULES, tmp_path, storage=storage)
    assert [text_of(one) for one in run.recorded] == [decision_text(one) for one in run.decisions]
    assert [one.stamp_ns for one in run.recorded] == [one.stamp_ns for one in run.decisions]
    assert_reads_as(GOLDEN, "".join(f"{text_of(one)}\n" for one in run.recorded))
    with AnyReader([run.output]) as reader:
        (topic,) = (one for one in reader.connections if one.topic == DECISIONS_TOPIC)
        read: list[Any] = [reader.deserialize(data, of.msgtype) for of, _, data in reader.messages([topic])]
    assert (topic.msgtype, [one.data for one in read]) == (TEXT_TYPE, [text_of(one) for one in run.recorded])
    with open_recording(run.output) as recording:
        (channel,) = (one for one in recording.channels if one.topic == DECISIONS_TOPIC)
        assert channel.transient_local is DECISIONS_QOS.transient_local
        assert [one for _, one in recorded_decisions(recording)] == run.decisions
        assert [one.topic for one in recording.channels][-1] == DECISIONS_TOPIC


@pytest.mark.parametrize("storage", Storage)
def test_a_decision_stands_before_every_message_that_passes_by_it(tmp_path: Path, storage: Storage) -> None:
    run = replay_content(MISSION, RULES, tmp_path, storage=storage)
    written = read_bag(run.output).messages
    stamps_ns = [one.stamp_ns for one in written]
    assert stamps_ns == sorted(stamps_ns)
    far = next(place for place, one in enumerate(written) if '"rule": "Far"' in one.payload.decode("latin-1"))
    assert all(one.stamp_ns >= written[far].stamp_ns for one in written[far:])


def test_those_of_a_recording_that_is_replayed_are_neither_relayed_nor_mixed_in(tmp_path: Path) -> None:
    first = replay_content(MISSION, RULES, tmp_path)
    other = RULES.replace("/scan 1", "/scan 2")
    relayed = write_bag(tmp_path / "relayed", BagContent(MISSION.topics, tuple(first.messages)))
    alone = replay_bag(relayed, other, _folder(tmp_path, "alone"))
    for rules in (other, f"{other} SetFrequency {DECISIONS_TOPIC} Full"):
        again = replay_bag(first.output, rules, _folder(tmp_path, rules[-4:]))
        assert again.messages == alone.messages
        decided = [one for one in again.decisions if one.topic != DECISIONS_TOPIC]
        assert [one.planned for one in decided] == [one.planned for one in alone.decisions]
        assert [text_of(one) for one in again.recorded] == [decision_text(one) for one in again.decisions]
        assert [line for line in again.outcome.notices if "testudo" in line] == [
            f"{DECISIONS_TOPIC}: left out, as it is of an earlier run; the new recording has decisions of "
            "its own"
        ]


def _folder(folder: Path, name: str) -> Path:
    made = folder / f"of{name.strip()}"
    made.mkdir()
    return made


def test_rules_cannot_read_what_a_run_said_of_itself_as_live(tmp_path: Path) -> None:
    said = [BagMessage(STATUS_TOPIC, START_NS + 10**9, string_message("{}"))]
    run = replay_content(
        also(MISSION, *said, topics=(SAID,)),
        f"SetFrequency /odom 1 If (CheckValue {STATUS_TOPIC} frequency > 0) Then SetFrequency /odom 9",
        tmp_path,
    )
    assert {one.planned.reason.value for one in run.decisions} == {"unknown"}
    assert run.outcome.notices == (
        f"{STATUS_TOPIC}: left out, as SmartTestudo said it of itself; rules neither relay nor read it",
    )


def test_no_relayed_topic_may_have_the_name_of_one_of_smarttestudo(tmp_path: Path) -> None:
    content = BagContent(
        (BagTopic("/status", TEXT_TYPE),), (BagMessage("/status", START_NS, string_message("x")),)
    )
    with pytest.raises(UsageError, match="where SmartTestudo says what it does; choose another pattern"):
        replay_content(content, "SetFrequency /status 1", tmp_path, output_topic="/testudo{topic}")


def received(folder: Path, run: ReplayRun, statuses: int = 3) -> Path:
    """What ``testudo receive --record`` makes of a robot's link, with an outage after which the last
    decisions come again."""
    clock = iter(range(START_NS, START_NS + 10**12))
    sink = RecordingSink(folder, pytest.fail, clock.__next__)
    streams = {
        topic.name: StreamInfo(topic=topic.name, type_name=topic.type_name, qos=DECISIONS_QOS)
        for topic in (*MISSION.topics, SAID, DECIDED)
    }
    for stream in streams.values():
        sink.open("ada", stream)

    def take(topic: str, payload: bytes) -> None:
        sink.write(
            ReceivedMessage(robot="ada", stream=streams[topic], payload=payload, offered_ns=1, age_ns=None)
        )

    for one in (*read_bag(run.output).messages, *run.recorded):
        take(one.topic, one.payload)
    for _ in range(statuses):
        take(STATUS_TOPIC, string_message('{"node": "/smarttestudo"}'))
    sink.close()
    return folder / "ada"


def test_a_recording_of_a_link_has_each_decision_once_for_who_asks(tmp_path: Path) -> None:
    run = replay_content(MISSION, RULES, tmp_path)
    bag = received(tmp_path / "received", run)
    with open_recording(bag) as recording:
        assert [one for _, one in recorded_decisions(recording)] == run.decisions
    assert kept_decisions(None, tmp_path / "bag", bag) == run.decisions


def test_decisions_of_two_robots_are_not_mixed(tmp_path: Path) -> None:
    run = replay_content(MISSION, RULES, tmp_path)
    both = [
        BagMessage(f"/{robot}{DECISIONS_TOPIC}", one.stamp_ns, one.payload)
        for one in run.recorded
        for robot in ("ada", "bob")
    ]
    topics = tuple(BagTopic(f"/{robot}{DECISIONS_TOPIC}", TEXT_TYPE) for robot in ("ada", "bob"))
    bag = write_bag(tmp_path / "both", also(MISSION, *both, topics=topics))
    with open_recording(bag) as recording, pytest.raises(RecordingError, match="decisions of several robots"):
        recorded_decisions(recording)
    assert kept_decisions(bag) == []


@pytest.mark.parametrize(
    ("topic", "type_name", "is_own"),
    [
        *((name, TEXT_TYPE, True) for name in sorted(OWN_TOPICS)),
        (f"/ada{STATUS_TOPIC}", TEXT_TYPE, True),
        (STATUS_TOPIC, "diagnostic_msgs/msg/DiagnosticStatus", False),
        ("/testudo/odom", "nav_msgs/msg/Odometry", False),
        ("/mytestudo/status", TEXT_TYPE, False),
        ("/testudo/status/more", TEXT_TYPE, False),
    ],
)
def test_a_topic_of_smarttestudo_is_known_by_name_and_type(topic: str, type_name: str, is_own: bool) -> None:
    assert is_own_topic(topic, type_name) is is_own


class Told:
    """What commands print about a recording as it is, and about one with decisions and statuses beside it."""

    def __init__(self, folder: Path, capsys: pytest.CaptureFixture[str]) -> None:
        self._capsys = capsys
        self.folder = folder
        (folder / "rules.adirf").write_text(f"begin\n{RULES}end\n", encoding="utf-8")
        run = replay_content(MISSION, RULES, _folder(folder, "run"))
        said = [
            BagMessage(STATUS_TOPIC, START_NS + second * 10**9, string_message("{}")) for second in range(3)
        ]
        seen = BagContent(MISSION.topics, tuple(run.messages))
        write_bag(folder / "sent", MISSION)
        for name, messages in {"plain": (), "seen": (*run.recorded, *said)}.items():
            write_bag(folder / name, also(seen, *messages, topics=(DECIDED, SAID) if messages else ()))
        self.run = run

    def json(self, *command: str) -> Any:
        self._capsys.readouterr()
        assert main([*command, "--json"]) == 0
        captured = self._capsys.readouterr()
        assert "/testudo" not in captured.err
        return json.loads(captured.out)

    def text(self, *command: str) -> str:
        self._capsys.readouterr()
        assert main([*command]) == 0
        return self._capsys.readouterr().out


@pytest.fixture
def told(tmp_path: Path, capsys: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch) -> Told:
    monkeypatch.chdir(tmp_path)
    return Told(tmp_path, capsys)


@pytest.mark.parametrize(
    "command",
    [
        ("bag", "rates", "BAG"),
        ("bag", "bandwidth", "BAG"),
        ("bag", "info", "BAG"),
        ("bag", "compare", "sent", "BAG"),
        ("bag", "loss", "sent", "BAG"),
        ("bag", "loss", "BAG"),
        ("bag", "accuracy", "BAG", "--rules", "rules.adirf"),
        ("bag", "rates", "BAG", "--topics", "*"),
    ],
)
def test_lists_and_sums_are_those_of_the_robots_topics(told: Told, command: tuple[str, ...]) -> None:
    plain, seen = (
        told.json(*(name if word == "BAG" else word for word in command)) for name in ("plain", "seen")
    )
    assert "testudo_topics" not in plain
    # The decisions begin with the replay, and so the recording lasts a little longer.
    assert _named(plain) == _named(seen)
    if "total" in plain and command[1] != "compare":
        assert plain["total"]["messages"] == seen["total"]["messages"]
        assert plain["total"]["bytes"] == seen["total"]["bytes"]


def _named(told: Any) -> object:
    """The topics of an answer and their counts."""
    topics = told.get("topics", {})
    return {
        name: one.get("messages") if isinstance(one, dict) else None for name, one in dict(topics).items()
    }


def test_info_shows_them_apart_and_a_full_name_asks_for_them(told: Told) -> None:
    lines = told.text("bag", "info", "seen").splitlines()
    count = len(told.run.recorded)
    assert lines[2] == (
        f"beside them, in no sum, what SmartTestudo said of itself: {DECISIONS_TOPIC} ({count} messages), "
        f"{STATUS_TOPIC} (3 messages)"
    )
    assert not any(line.startswith("/testudo") for line in lines[3:])
    asked = told.json("bag", "bandwidth", "seen", "--topics", STATUS_TOPIC)
    assert (list(asked["topics"]), asked["total"]["messages"]) == ([STATUS_TOPIC], 3)
    assert main(["bag", "rates", "seen", "--topics", "/testudo/*"]) == 1


def test_the_report_and_the_fleet_have_the_rates_in_force_without_a_file(told: Told) -> None:
    report = told.text("bag", "report", "sent", "seen", "--rules", "rules.adirf")
    assert ", /odom error " in report
    assert listed_decisions(Path("report.html")) == len(told.run.decisions)
    page = Path("report.html").read_text(encoding="utf-8")
    assert "Far" in page
    assert DECISIONS_TOPIC not in page
    numbers = measure_recording(RecordingQuestion(a=Path("sent"), b=Path("seen")))
    assert [rule.rule for rule in numbers.rules] == ["", "Far", "Far (in doubt)"]
    assert not any(is_own_topic(topic.topic, TEXT_TYPE) for topic in numbers.topics)


def test_the_loss_knows_when_a_block_bounded_by_what_the_recording_says(told: Told) -> None:
    by_recording = told.json("bag", "loss", "sent", "seen", "--rules", "rules.adirf")["bounds"]
    write = "".join(f"{decision_text(one)}\n" for one in told.run.decisions)
    Path("kept.jsonl").write_text(write, encoding="utf-8")
    by_file = told.json("bag", "loss", "sent", "plain", "--rules", "rules.adirf", "--decisions", "kept.jsonl")
    assert by_recording == by_file["bounds"]
    assert [one["bound"] for one in by_recording] == [0.5]
    (bound,) = measure_loss("sent", "seen", rules=read_rules("rules.adirf")).bounds
    assert bound.in_force_s == by_recording[0]["in_force_s"] > 0


def test_what_ended_early_is_said_though_decisions_went_on(told: Told) -> None:
    late = BagMessage(DECISIONS_TOPIC, MISSION.messages[-1].stamp_ns, told.run.recorded[0].payload)
    half = [one for one in MISSION.messages if one.stamp_ns < START_NS + 10**9]
    write_bag(told.folder / "early", also(BagContent(MISSION.topics, tuple(half)), late))
    notices = told.json("bag", "loss", "sent", "early")["notices"]
    assert any(line.startswith("early: ends 3.0 s before sent; nothing came") for line in notices)


@pytest.mark.parametrize("storage", ["sqlite3", "mcap"])
def test_why_reads_what_a_replay_recorded(told: Told, storage: str) -> None:
    command = ("replay", "sent", "--rules", "rules.adirf", "--output", "out", "--storage", storage)
    told.text(*command, "--decisions", "d.jsonl")
    for at in ("1.5", "2.5", "3.9"):
        assert told.text("why", "/scan", "out", "--at", at) == told.text(
            "why", "/scan", "d.jsonl", "--at", at
        )
    assert told.text("why", "/scan", "out", "--at", "3").startswith("/scan: 5 Hz (block: Far, line 4)\n")


def test_a_profile_and_a_first_rule_file_are_of_the_robots_topics(told: Told) -> None:
    told.text("profile", "--bag", "seen", "-o", "seen.toml")
    assert "/testudo" not in Path("seen.toml").read_text(encoding="utf-8")


def test_decisions_can_be_read_again_line_for_line(tmp_path: Path) -> None:
    run = replay_content(MISSION, RULES, tmp_path)
    for one, decision in zip(run.recorded, run.decisions, strict=True):
        assert Decision.from_json(json.loads(text_of(one))) == decision


def test_a_recording_of_decisions_alone_is_of_no_topic(told: Told) -> None:
    content = BagContent((DECIDED,), tuple(told.run.recorded))
    write_bag(told.folder / "alone", content)
    assert told.json("bag", "info", "alone")["total"]["messages"] == 0
