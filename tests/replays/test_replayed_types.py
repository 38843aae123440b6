# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""Topics with two types, two definitions of one, or one that nobody can read."""

from __future__ import annotations

import struct
from pathlib import Path

import pytest
from rosbags.rosbag2 import StoragePlugin

from bags.bag_factory import (
    MAP_NAME,
    ODOM,
    START_NS,
    BagContent,
    BagMessage,
    BagTopic,
    odometry,
    small_mission,
    write_pairs,
    write_split_bag,
)
from replays.replay_runs import replay_bag
from smarttestudo.bags.definition_text import SEPARATOR
from smarttestudo.bags.definitions import RosbagDecoder
from smarttestudo.bags.reader import open_recording
from smarttestudo.bags.writer import create_recording
from smarttestudo.domain.decision import Reason
from smarttestudo.domain.errors import RecordingError
from smarttestudo.domain.recording import Channel, Storage

SECOND_NS = 1_000_000_000
MISSION = small_mission()


def test_of_a_topic_with_two_types_the_second_is_left_out_and_counted(tmp_path: Path) -> None:
    text = BagTopic("/odom", MAP_NAME.type_name)
    parts = [
        BagContent((ODOM,), (BagMessage("/odom", START_NS, odometry(0, 0)),)),
        BagContent((text,), (BagMessage("/odom", START_NS + 1, b"\x00\x01\x00\x00"),)),
    ]
    bag = write_split_bag(tmp_path / "bag", parts)
    (bag / "metadata.yaml").unlink()
    run = replay_bag(bag, "SetFrequency /odom Full", tmp_path)
    assert len(run.messages) == 1
    notice = "/odom: recorded with two types; left out of the second: 1 message"
    assert notice in run.outcome.notices


@pytest.mark.parametrize("storage", Storage)
def test_of_a_type_that_was_redefined_each_message_is_read_and_written_by_its_own_definition(
    tmp_path: Path, storage: Storage
) -> None:
    definitions = ("float64 a\nfloat64 b\n", "float64 b\nfloat64 a\n")
    bag = write_pairs(tmp_path / "redefined.mcap", [*definitions, definitions[0]])
    rules = "SetFrequency /pair Off\nIf (CheckValue /pair msg.a = 1) Then SetFrequency /pair Full"
    with open_recording(bag) as recording:
        written = {(channel.definition, stamp, data) for channel, stamp, data in recording.messages()}
    replay_bag(bag, rules, tmp_path, storage=storage)
    with open_recording(tmp_path / "monitored") as recording:
        messages = recording.messages({"/pair"})
        read = {(channel.definition, stamp, data) for channel, stamp, data in messages}
        assert read == written
        assert recording.notices() == []
        decoder = RosbagDecoder()
        decoded = [decoder.decode(channel, data) for channel, _, data in recording.messages({"/pair"})]
        assert [getattr(one, "a") for one in decoded] == [1.0] * 3  # noqa: B009


@pytest.mark.parametrize("storage", StoragePlugin)
def test_a_type_that_is_only_announced_does_not_displace_the_one_that_is_there(
    tmp_path: Path, storage: StoragePlugin
) -> None:
    announced = BagContent((BagTopic("/odom", "geometry_msgs/msg/PoseStamped"),))
    few = BagContent((MAP_NAME,), (BagMessage("/map_name", START_NS, b"\0\1\0\0"),))
    bag = write_split_bag(tmp_path / "bag", [announced, MISSION, few], storage=storage)
    run = replay_bag(bag, "SetFrequency /odom Full", tmp_path)
    sent = [one for one in MISSION.messages if one.topic == "/odom"]
    assert len(run.on("/odom")) == len(sent)
    assert "/odom: announced as geometry_msgs/msg/PoseStamped, too, without messages" in run.outcome.notices


def test_of_two_types_the_one_with_the_most_messages_counts(tmp_path: Path) -> None:
    text = BagContent((BagTopic("/odom", MAP_NAME.type_name),), (BagMessage("/odom", START_NS, b"\0\1\0\0"),))
    bag = write_split_bag(tmp_path / "bag", [text, MISSION])
    run = replay_bag(bag, "SetFrequency /odom Full", tmp_path)
    assert len(run.on("/odom")) == len([one for one in MISSION.messages if one.topic == "/odom"])
    assert "/odom: recorded with two types; left out of the second: 1 message" in run.outcome.notices


def test_a_type_that_nobody_defines_is_refused_where_a_check_reads_it_and_passed_elsewhere(
    tmp_path: Path,
) -> None:
    odd = BagTopic("/odd", "nobody_msgs/msg/Odd")
    bag = tmp_path / "bag"
    with create_recording(bag) as writer:
        for i in range(5):
            writer.write(Channel(topic=odd.name, type_name=odd.type_name), START_NS + i, b"\x00\x01\x00\x00?")
    rules = "SetFrequency /odd Full\nIf (CheckValue /odd {} > 2) Then SetFrequency /odd Full"
    with pytest.raises(RecordingError) as refused:
        replay_bag(bag, rules.format("msg.value"), tmp_path)
    assert str(refused.value) == (
        "/odd: error: a check reads it, and it cannot be decoded: "
        "neither the recording nor ROS 2 defines nobody_msgs/msg/Odd; leave out the check"
    )
    assert not (tmp_path / "monitored").exists()
    assert len(replay_bag(bag, rules.format("rate"), tmp_path).messages) == 5


def test_a_field_that_python_has_no_type_for_is_named_and_the_others_are_read(tmp_path: Path) -> None:
    fields = "double level; long double exact; sequence<long double> more;"
    definition = f"{SEPARATOR}IDL: p/msg/M\nmodule p {{ module msg {{ struct M {{ {fields} }}; }}; }};\n"
    channel = Channel(topic="/m", type_name="p/msg/M", definition=definition)
    with create_recording(tmp_path / "bag", storage=Storage.MCAP) as writer:
        for i in range(5):
            payload = b"\0\1\0\0" + struct.pack("<d", i) + bytes(20)
            writer.write(channel, START_NS + i * SECOND_NS, payload)
    rules = "SetFrequency /m 1\nIf (CheckValue /m {} > 2) Then SetFrequency /m Full"
    run = replay_bag(tmp_path / "bag", rules.format("level"), tmp_path)
    assert run.outcome.notices == ()
    assert run.decisions[-1].planned.reason is Reason.BLOCK
    (tmp_path / "again").mkdir()
    run = replay_bag(tmp_path / "bag", rules.format("more[0]"), tmp_path / "again")
    notice = "/m more[0]: unknown in 5 messages (a long double, which ROS 2 lacks in Python)"
    assert run.outcome.notices == (notice,)
