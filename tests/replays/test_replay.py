# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
from __future__ import annotations

import json
from pathlib import Path

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from rosbags.rosbag2 import CompressionMode, StoragePlugin

from bags.bag_factory import (
    IMAGE,
    ODOM,
    SCAN,
    START_NS,
    BagContent,
    BagMessage,
    BagTopic,
    cdr,
    message_of,
    odometry,
    small_mission,
    write_bag,
    write_split_bag,
)
from bags.bag_reading import read_with_mcap, read_with_rosbags
from replays.replay_runs import of_robot, replay_bag, replay_content
from smarttestudo.bags.reader import open_recording
from smarttestudo.domain.decision import Reason
from smarttestudo.domain.errors import UsageError
from smarttestudo.domain.names import DECISIONS_TOPIC
from smarttestudo.domain.profile import Profile, TopicProfile
from smarttestudo.domain.recording import Storage
from smarttestudo.pacing.sample import WhenSlow
from smarttestudo.replays.replay import ReplayRequest, replay
from smarttestudo.rules.rule_sets import load_rules

SECOND_NS = 1_000_000_000
MISSION = small_mission()


def steady(
    topic: BagTopic, rate_hz: float, seconds: float, payload: bytes = b"\x00\x01\x00\x00x"
) -> BagContent:
    period_ns = round(SECOND_NS / rate_hz)
    stamps = range(START_NS, START_NS + round(seconds * SECOND_NS), period_ns)
    return BagContent((topic,), tuple(BagMessage(topic.name, stamp_ns, payload) for stamp_ns in stamps))


def both(first: BagContent, second: BagContent) -> BagContent:
    messages = sorted((*first.messages, *second.messages), key=lambda message: message.stamp_ns)
    return BagContent(first.topics + second.topics, tuple(messages))


def test_full_passes_every_message_byte_for_byte_at_its_time(tmp_path: Path) -> None:
    rules = "\n".join(f"SetFrequency {topic.name} Full" for topic in MISSION.topics)
    run = replay_content(MISSION, rules, tmp_path)
    assert run.messages == list(MISSION.messages)
    assert run.outcome.notices == ()


@pytest.mark.parametrize("source", ["sqlite3", "mcap", "zstd files", "zstd messages", "split"])
@pytest.mark.parametrize("storage", Storage)
def test_other_readers_read_the_same_messages_whatever_went_in(
    tmp_path: Path, source: str, storage: Storage
) -> None:
    bag = {
        "sqlite3": lambda path: write_bag(path, MISSION),
        "mcap": lambda path: write_bag(path, MISSION, storage=StoragePlugin.MCAP),
        "zstd files": lambda path: write_bag(path, MISSION, compression=CompressionMode.FILE),
        "zstd messages": lambda path: write_bag(path, MISSION, compression=CompressionMode.MESSAGE),
        "split": lambda path: write_split_bag(path, [MISSION.between(0, 60), MISSION.between(60, 999)]),
    }[source](tmp_path / "bag")
    run = replay_bag(bag, "SetFrequency /odom 10\nSetFrequency /image Full", tmp_path, storage=storage)
    assert 40 <= len(run.on("/odom")) <= 42
    came = {(message.topic, message.payload) for message in MISSION.messages}
    assert {(message.topic, message.payload) for message in run.messages} <= came
    assert run.on("/image") == [message for message in MISSION.messages if message.topic == "/image"]
    assert of_robot(read_with_rosbags(run.output)) == run.messages
    assert [one for one in read_with_rosbags(run.output) if one in run.recorded] == run.recorded
    if storage is Storage.MCAP:
        assert of_robot(read_with_mcap(run.output / "monitored.mcap")) == run.messages


def test_only_topics_with_a_rate_are_written_and_those_that_checks_read_are_not(tmp_path: Path) -> None:
    rules = "SetFrequency /scan 1\nIf (CheckValue /odom pose_y > 2) Then SetFrequency /scan 5"
    run = replay_content(MISSION, rules, tmp_path)
    assert {message.topic for message in run.messages} == {"/scan"}
    with open_recording(run.output) as recording:
        assert {channel.topic for channel in recording.channels} == {"/scan", DECISIONS_TOPIC}


def test_a_block_decides_from_the_message_on_that_makes_it_hold(tmp_path: Path) -> None:
    rules = 'SetFrequency /scan 1\nRule "Far" If (CheckValue /odom pose_y >= 2) Then SetFrequency /scan Full'
    run = replay_content(MISSION, rules, tmp_path)
    far = next(decision for decision in run.decisions if decision.planned.reason is Reason.BLOCK)
    assert (far.t_s, far.planned.rule, far.values) == (2.0, "Far", {"/odom pose_y": 2.0})
    late = [
        message
        for message in MISSION.messages
        if message.topic == "/scan" and message.stamp_ns > far.stamp_ns
    ]
    assert [message for message in run.on("/scan") if message.stamp_ns > far.stamp_ns] == late
    assert run.outcome.decisions == len(run.decisions)


def test_silence_alone_makes_values_unknown_at_its_own_time(tmp_path: Path) -> None:
    odom = small_mission(2.0)
    odom = BagContent((ODOM,), tuple(message for message in odom.messages if message.topic == "/odom"))
    content = both(odom, steady(IMAGE, 0.2, 20))
    rules = "SetFrequency /image 1\nIf (CheckValue /odom pose_y > 99) Then SetFrequency /image 7"
    run = replay_content(content, rules, tmp_path)
    unknown = [decision.t_s for decision in run.decisions if decision.planned.reason is Reason.UNKNOWN]
    last_odom_s = (odom.messages[-1].stamp_ns - START_NS) / SECOND_NS
    assert unknown == [0.0, pytest.approx(last_odom_s + 2.0, abs=1e-6)]


def test_the_last_word_comes_when_its_time_has_come_even_after_the_end(tmp_path: Path) -> None:
    content = steady(IMAGE, 10, 1.05)
    run = replay_content(content, "SetFrequency /image 2", tmp_path)
    last = run.messages[-1]
    assert last.payload == content.messages[-1].payload
    assert last.stamp_ns >= content.messages[-1].stamp_ns
    assert run.outcome.topics["/image"].messages_out == len(run.messages)


def test_declared_sizes_count_instead_of_those_in_the_bag(tmp_path: Path) -> None:
    noted = {"smarttestudo.declared_bytes": json.dumps({"/image": 6_000_000}), "operator": "Ada"}
    rules = "SetFrequency /image Full\nIf (CheckValue /image bandwidth > 20000) Then SetFrequency /image 1"
    run = replay_content(
        MISSION, rules, tmp_path, custom_data=noted, output_topic="/testudo{topic}", storage=Storage.MCAP
    )
    image = run.outcome.topics["/image"]
    assert image.declared
    assert image.in_kb == 6000.0 * image.messages_in
    assert image.out_kb == 6000.0 * image.messages_out
    assert any(decision.planned.reason is Reason.BLOCK for decision in run.decisions)
    with open_recording(run.output) as recording:
        assert recording.declared_bytes == {"/testudo/image": 6_000_000}
        assert recording.custom_data["operator"] == "Ada"


def test_the_numbers_of_a_topic_are_those_of_its_messages(tmp_path: Path) -> None:
    content = steady(IMAGE, 20, 10, payload=bytes(500))
    run = replay_content(content, "SetFrequency /image 8", tmp_path)
    image = run.outcome.topics["/image"]
    stamps = [message.stamp_ns for message in run.messages]
    assert image.messages_in == 200
    assert image.messages_out == len(stamps)
    assert image.source_hz == pytest.approx(20.0, rel=1e-9)
    assert image.target_hz == pytest.approx(8.0, rel=1e-9)
    assert image.mean_hz == pytest.approx((len(stamps) - 1) * SECOND_NS / (stamps[-1] - stamps[0]), rel=1e-9)
    assert image.mean_hz is not None
    assert image.error_percent == pytest.approx(100 * (image.mean_hz / 8 - 1), rel=1e-9)
    assert (image.in_kb, image.out_kb) == (100.0, 0.5 * len(stamps))


def test_a_target_above_the_source_counts_as_the_source_in_the_error(tmp_path: Path) -> None:
    content = both(small_mission(4.0), steady(BagTopic("/slow", "std_msgs/msg/String"), 5, 4))
    rules = "SetFrequency /slow 100\nSetFrequency /odom Full"
    run = replay_content(content, rules, tmp_path)
    slow, odom = run.outcome.topics["/slow"], run.outcome.topics["/odom"]
    assert slow.target_hz == pytest.approx(100.0)
    assert odom.target_hz == odom.source_hz
    assert slow.error_percent == odom.error_percent == 0.0


def test_repeating_fills_the_grid_of_a_slow_source(tmp_path: Path) -> None:
    run = replay_content(steady(SCAN, 5, 4), "SetFrequency /scan 10", tmp_path, when_slow=WhenSlow.REPEAT)
    scan = run.outcome.topics["/scan"]
    assert scan.repeated > 15
    assert scan.messages_out == len(run.messages) > 35


def test_latched_topics_pass_and_stay_latched(tmp_path: Path) -> None:
    run = replay_content(MISSION, "SetFrequency /map_name 0.1", tmp_path)
    assert [message.topic for message in run.messages] == ["/map_name"]
    with open_recording(run.output) as recording:
        assert {channel.transient_local for channel in recording.channels} == {True}


def test_topics_paced_with_another_pass_the_same_stamps(tmp_path: Path) -> None:
    def stamped(topic: BagTopic) -> BagContent:
        messages = []
        for i in range(60):
            message = message_of(topic.type_name)
            message.header.stamp.sec, message.header.stamp.nanosec = i // 30, i % 30 * 33_000_000
            late_ns = 2_000_000 if topic is info else 0
            stamp_ns = START_NS + i * 33_000_000 + late_ns
            messages.append(BagMessage(topic.name, stamp_ns, cdr(topic.type_name, message)))
        return BagContent((topic,), tuple(messages))

    info = BagTopic("/info", "sensor_msgs/msg/CameraInfo")
    profile = Profile(topics={"/info": TopicProfile(paced_with="/image")})
    rules = "SetFrequency /image 4\nSetFrequency /info 4"
    run = replay_content(both(stamped(IMAGE), stamped(info)), rules, tmp_path, profile=profile)
    stamps = {topic: [message.payload[4:12] for message in run.on(topic)] for topic in ("/image", "/info")}
    assert len(stamps["/image"]) > 5
    assert stamps["/info"] == stamps["/image"]


def test_messages_that_do_not_decode_and_values_that_are_nan_are_counted_and_named(tmp_path: Path) -> None:
    messages = list(MISSION.messages)
    odometries = [place for place, message in enumerate(messages) if message.topic == "/odom"]
    for place in odometries[10:13]:
        messages[place] = BagMessage("/odom", messages[place].stamp_ns, b"\x00\x01\x00\x00short")
    for place in odometries[20:22]:
        messages[place] = BagMessage("/odom", messages[place].stamp_ns, odometry(0.0, float("nan")))
    rules = "SetFrequency /odom Full\nIf (CheckValue /odom pose_y > 2) Then SetFrequency /odom 5"
    run = replay_content(BagContent(MISSION.topics, tuple(messages)), rules, tmp_path)
    assert run.outcome.notices == (
        "/odom: 3 messages could not be decoded; what checks read was unknown",
        "/odom pose_y: unknown in 2 messages (NaN, said to be unknown, or no such field)",
    )
    passed = set(run.messages)
    assert {messages[place] for place in odometries[10:13]} <= passed


def test_the_machine_and_the_link_are_unknown_in_a_replay_and_that_is_said_once(tmp_path: Path) -> None:
    rules = (
        "SetFrequency /odom 1\n"
        "If (CheckValue @machine cpu > 90 OR CheckValue @machine memory > 90)\n"
        "Then SetFrequency /odom 2\n"
        "If (CheckValue @link connected = false) Then SetFrequency /odom 3"
    )
    run = replay_content(MISSION, rules, tmp_path)
    assert run.outcome.notices == (
        "@link: no recording has it, so checks of it stay unknown",
        "@machine: no recording has it, so checks of it stay unknown",
    )
    assert [(one.planned.rate.hz, one.planned.reason) for one in run.decisions] == [(3, Reason.UNKNOWN)]
    assert run.decisions[0].values == {"@link connected": None}


def test_topics_that_the_recording_does_not_hold_are_named(tmp_path: Path) -> None:
    rules = (
        "SetFrequency /imu 5\nSetFrequency /scan 1\nIf (CheckValue /wheel a > 1) Then SetFrequency /scan 2"
    )
    run = replay_content(MISSION, rules, tmp_path)
    assert run.outcome.notices == (
        "/imu: not in the recording, so nothing of it is relayed",
        "/wheel: not in the recording, so checks of it stay unknown",
    )
    assert run.outcome.topics["/imu"].messages_in == 0


@pytest.mark.parametrize("pattern", ["/all", "{topic}/", "/my robot{topic}", "x{topic}", "{topic}{name}"])
def test_output_names_that_clash_or_are_none_are_refused_before_any_work(
    tmp_path: Path, pattern: str
) -> None:
    with pytest.raises(UsageError):
        replay_content(MISSION, "SetFrequency /odom 1", tmp_path, output_topic=pattern)
    assert not (tmp_path / "monitored").exists()


def test_relayed_topics_are_renamed_as_asked(tmp_path: Path) -> None:
    run = replay_content(MISSION, "SetFrequency /odom Full", tmp_path, output_topic="/operator{topic}/slow")
    assert {message.topic for message in run.messages} == {"/operator/odom/slow"}
    assert list(run.outcome.topics) == ["/odom"]


def test_a_replay_that_is_interrupted_leaves_nothing(tmp_path: Path) -> None:
    def interrupt(share: float) -> None:
        if share > 0.5:
            raise KeyboardInterrupt

    bag = write_bag(tmp_path / "bag", MISSION)
    (tmp_path / "rules.adirf").write_text("begin SetFrequency /odom 1 end")
    before = sorted(tmp_path.rglob("*"))
    rule_set = load_rules([tmp_path / "rules.adirf"]).rule_set
    with open_recording(bag) as recording, pytest.raises(KeyboardInterrupt):
        replay(
            ReplayRequest(
                recording=recording, rule_set=rule_set, output=tmp_path / "monitored", report=interrupt
            )
        )
    assert sorted(tmp_path.rglob("*")) == before


def test_progress_rises_from_none_to_all(tmp_path: Path) -> None:
    run = replay_content(MISSION, "SetFrequency /odom 1", tmp_path)
    assert run.progress == sorted(run.progress)
    assert run.progress[-1] == 1.0
    assert len(run.progress) <= 205


@pytest.mark.parametrize("messages", [0, 1])
def test_a_recording_of_no_or_one_message_is_replayed(tmp_path: Path, messages: int) -> None:
    run = replay_content(MISSION.between(0, messages), "SetFrequency /odom 3", tmp_path)
    assert len(run.messages) == messages
    assert run.outcome.topics["/odom"].mean_hz is None


@settings(max_examples=25)
@given(
    gaps_ns=st.lists(st.integers(0, 3 * SECOND_NS), min_size=1, max_size=60),
    rate_hz=st.sampled_from([0.0, 0.5, 3.0, 25.0]),
    floor_hz=st.sampled_from([None, 2.0]),
)
def test_what_comes_out_went_in_and_never_before_its_time(
    gaps_ns: list[int], rate_hz: float, floor_hz: float | None, tmp_path_factory: pytest.TempPathFactory
) -> None:
    stamps, now_ns = [], START_NS
    for gap_ns in gaps_ns:
        now_ns += gap_ns
        stamps.append(now_ns)
    content = BagContent(
        (IMAGE,),
        tuple(
            BagMessage("/image", stamp, b"\x00\x01\x00\x00" + str(i).encode())
            for i, stamp in enumerate(stamps)
        ),
    )
    rules = f"SetFrequency /image {rate_hz}" + (f"\nKeepAtLeast /image {floor_hz}" if floor_hz else "")
    run = replay_content(content, rules, tmp_path_factory.mktemp("any"))
    arrived_ns = {message.payload: message.stamp_ns for message in content.messages}
    payloads = [message.payload for message in run.messages]
    assert len(set(payloads)) == len(payloads)
    assert all(message.stamp_ns >= arrived_ns[message.payload] for message in run.messages)
    if rate_hz or floor_hz:
        assert payloads[-1] == content.messages[-1].payload
    else:
        assert payloads == []


def test_a_rule_that_was_in_doubt_decides_once_it_is_known_to_hold(tmp_path: Path) -> None:
    """The rate stays, but from then on the rule has decided it."""
    rules = (
        'SetFrequency /odom 10 Rule "Far" If CheckValue /odom pose_y > 0.2 Then SetFrequency /odom 20 EndIf'
    )
    decisions = replay_content(small_mission(), rules, tmp_path).decisions
    assert [(one.t_s, one.planned.reason, one.planned.rule, one.planned.rate.hz) for one in decisions] == [
        (0.0, Reason.UNKNOWN, "Far", 20.0),
        (0.24, Reason.BLOCK, "Far", 20.0),
    ]
