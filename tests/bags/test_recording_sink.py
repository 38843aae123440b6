# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""What arrives over a link, read back from its recording."""

from __future__ import annotations

import itertools
import json
import resource
import signal
import struct
import tracemalloc
from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import replace
from pathlib import Path
from typing import Any

import pytest
from rosbags.highlevel import AnyReader

from bags.bag_factory import (
    CUSTOM_DEFINITION,
    CUSTOM_TYPE,
    START_NS,
    BagMessage,
    cdr,
    message_of,
    odometry,
)
from bags.bag_reading import read_bag, read_with_mcap, read_with_rosbags
from smarttestudo.bags.qos import qos_in_words
from smarttestudo.bags.reader import open_recording
from smarttestudo.bags.recording_sink import RecordingSink
from smarttestudo.cli.main import main
from smarttestudo.domain.errors import RecordingError, UsageError
from smarttestudo.domain.link import ReceivedMessage, StreamInfo
from smarttestudo.domain.robot import Qos

BEST_EFFORT = Qos(reliable=False, transient_local=False, depth=5)
LATCHED = Qos(reliable=True, transient_local=True, depth=1)
ODOM = StreamInfo(topic="/odom", type_name="nav_msgs/msg/Odometry", qos=BEST_EFFORT)
GRIPPER = StreamInfo(topic="/gripper", type_name=CUSTOM_TYPE, qos=LATCHED, definition=CUSTOM_DEFINITION)
ODD = StreamInfo(topic="/odd", type_name="acme_msgs/msg/Odd", qos=BEST_EFFORT)
HELD = cdr(CUSTOM_TYPE, message_of(CUSTOM_TYPE, opening=0.5, holds=True))


def sink_into(folder: Path, pattern: str = "{topic}") -> RecordingSink:
    """One that says nothing, by a clock that goes on by a nanosecond a message."""
    return RecordingSink(folder, pytest.fail, itertools.count(START_NS).__next__, pattern=pattern)


def take(sink: RecordingSink, stream: StreamInfo, payload: bytes, robot: str = "ada") -> None:
    sink.write(ReceivedMessage(robot=robot, stream=stream, payload=payload, offered_ns=1, age_ns=None))


def test_a_recording_holds_what_arrived_when_it_arrived_for_our_reader_and_for_others(tmp_path: Path) -> None:
    sink = sink_into(tmp_path / "drive")
    sent = [
        (ODOM, odometry(1.0, 2.0)),
        (GRIPPER, HELD),
        (ODD, b"\x00\x01\x00\x00\x07"),
        (ODOM, odometry(3, 4)),
    ]
    for stream in (ODOM, GRIPPER, ODD):
        sink.open("ada", stream)
    for stream, payload in sent:
        take(sink, stream, payload)
    assert [path.name for path in (tmp_path / "drive").iterdir()] == [".ada.partial"]
    sink.close()
    bag = tmp_path / "drive" / "ada"
    expected = [BagMessage(of.topic, START_NS + number, data) for number, (of, data) in enumerate(sent)]
    assert read_bag(bag).messages == expected
    assert read_with_rosbags(bag) == expected
    assert read_with_mcap(bag / "ada.mcap") == expected


def test_each_message_can_be_read_as_soon_as_it_was_taken(tmp_path: Path) -> None:
    sink = sink_into(tmp_path / "drive")
    for stream in (ODOM, GRIPPER):
        sink.open("ada", stream)
    expected = []
    for number in range(30):
        stream, payload = (GRIPPER, HELD) if number % 3 else (ODOM, odometry(float(number), 0.0))
        take(sink, stream, payload)
        expected.append(BagMessage(stream.topic, START_NS + number, payload))
        assert read_bag(tmp_path / "drive" / ".ada.partial").messages == expected
    sink.close()
    assert read_bag(tmp_path / "drive" / "ada").notices == []


@pytest.mark.full
def test_memory_does_not_grow_with_the_length_of_a_recording(tmp_path: Path) -> None:
    sink = sink_into(tmp_path / "drive")
    sink.open("ada", ODD)
    held_bytes = []
    tracemalloc.start()
    for number in range(40_000):
        take(sink, ODD, bytes(100))
        if number % 10_000 == 9_999:
            held_bytes.append(tracemalloc.get_traced_memory()[0])
    tracemalloc.stop()
    sink.close()
    # Of the chunk that is open, a megabyte of the file, the place of each message is known.
    assert held_bytes[-1] < held_bytes[0] + 1_500_000


def test_types_are_defined_by_the_robot_or_known_and_the_qos_is_the_robots(tmp_path: Path) -> None:
    sink = sink_into(tmp_path / "drive")
    for stream, payload in ((ODOM, odometry(1.0, 2.0)), (GRIPPER, HELD)):
        sink.open("ada", stream)
        take(sink, stream, payload)
    sink.close()
    with AnyReader([tmp_path / "drive" / "ada"]) as reader:
        by_topic: dict[str, Any] = {
            connection.topic: reader.deserialize(data, connection.msgtype)
            for connection, _, data in reader.messages()
        }
    assert by_topic["/odom"].pose.pose.position.x == 1.0
    assert (by_topic["/gripper"].opening, by_topic["/gripper"].holds) == (0.5, True)
    with open_recording(tmp_path / "drive" / "ada") as recording:
        assert {one.topic: qos_in_words(one.qos) for one in recording.channels} == {
            "/odom": "best effort, volatile, keep last 5",
            "/gripper": "reliable, transient local, keep last 1",
        }


def test_bag_info_shows_it(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    sink = sink_into(tmp_path / "drive")
    sink.open("ada", ODOM)
    take(sink, ODOM, odometry(1.0, 2.0))
    sink.close()
    assert main(["bag", "info", "--json", str(tmp_path / "drive" / "ada")]) == 0
    assert '"/odom"' in json.dumps(json.loads(capsys.readouterr().out))


def test_each_robot_has_a_recording_of_its_own_and_its_name_may_be_in_the_topics(tmp_path: Path) -> None:
    sink = sink_into(tmp_path / "drive", pattern="/{robot}{topic}")
    for robot, x in (("ada", 1.0), ("bob", 2.0)):
        sink.open(robot, ODOM)
        take(sink, ODOM, odometry(x, 0.0), robot)
    sink.close()
    assert read_bag(tmp_path / "drive" / "ada").messages == [
        BagMessage("/ada/odom", START_NS, odometry(1.0, 0.0))
    ]
    assert read_bag(tmp_path / "drive" / "bob").messages == [
        BagMessage("/bob/odom", START_NS + 1, odometry(2.0, 0.0))
    ]


def test_a_topic_that_changes_its_type_is_recorded_with_both(tmp_path: Path) -> None:
    sink = sink_into(tmp_path / "drive")
    changed = StreamInfo(topic="/odom", type_name=CUSTOM_TYPE, qos=LATCHED, definition=CUSTOM_DEFINITION)
    for stream, payload in ((ODOM, odometry(1.0, 2.0)), (changed, HELD), (ODOM, odometry(3.0, 4.0))):
        sink.open("ada", stream)
        take(sink, stream, payload)
    sink.close()
    with open_recording(tmp_path / "drive" / "ada") as recording:
        assert [(channel.type_name, payload) for channel, _, payload in recording.messages()] == [
            (ODOM.type_name, odometry(1.0, 2.0)),
            (CUSTOM_TYPE, HELD),
            (ODOM.type_name, odometry(3.0, 4.0)),
        ]


def test_where_nothing_arrived_nothing_is_left(tmp_path: Path) -> None:
    sink_into(tmp_path / "drive").close()
    assert list(tmp_path.iterdir()) == []


def test_a_folder_that_exists_and_a_pattern_without_names_are_refused_at_once(tmp_path: Path) -> None:
    with pytest.raises(RecordingError, match="exists already"):
        sink_into(tmp_path)
    with pytest.raises(UsageError, match="same name"):
        sink_into(tmp_path / "drive", pattern="/all")
    (tmp_path / "file").write_text("")
    with pytest.raises(RecordingError, match="cannot be written"):
        sink_into(tmp_path / "file" / "drive")


@pytest.mark.parametrize("robot", ["..", "", "../elsewhere", "a/b", ".hidden", "x" * 101])
def test_a_robot_whose_name_makes_no_folder_is_named_once_and_costs_no_other(
    tmp_path: Path, robot: str
) -> None:
    said: list[str] = []
    sink = RecordingSink(tmp_path / "drive", said.append, lambda: START_NS)
    for name in (robot, robot, "ada"):
        sink.open(name, ODOM)
        take(sink, ODOM, odometry(1.0, 2.0), name)
    sink.close()
    assert len(said) == 1
    assert f"the robot {robot!r} is not recorded" in said[0]
    assert [path.name for path in tmp_path.iterdir()] == ["drive"]
    assert len(read_bag(tmp_path / "drive" / "ada").messages) == 1


@contextmanager
def files_at_most(size_bytes: int) -> Iterator[None]:
    """As a full disk: no file may grow beyond it."""
    before = resource.getrlimit(resource.RLIMIT_FSIZE)
    handler = signal.signal(signal.SIGXFSZ, signal.SIG_IGN)
    resource.setrlimit(resource.RLIMIT_FSIZE, (size_bytes, before[1]))
    try:
        yield
    finally:
        resource.setrlimit(resource.RLIMIT_FSIZE, before)
        signal.signal(signal.SIGXFSZ, handler)


def test_a_recording_that_cannot_go_on_keeps_what_was_written_and_is_said_once(tmp_path: Path) -> None:
    said: list[str] = []
    sink = RecordingSink(tmp_path / "drive", said.append, itertools.count(START_NS).__next__)
    sink.open("ada", GRIPPER)
    with files_at_most(3_000_000):
        for _ in range(5):
            take(sink, GRIPPER, HELD + bytes(1_100_000))
    sink.close()
    assert len(said) == 1
    assert "cannot be written" in said[0]
    kept = read_bag(tmp_path / "drive" / "ada")
    assert 1 <= len(kept.messages) < 5
    assert len(list(tmp_path.iterdir())) == 1


BATTERY = StreamInfo(
    topic="/battery",
    type_name="acme_msgs/msg/Battery",
    qos=BEST_EFFORT,
    definition="float64 level\nfloat64 volts\n",
)
UPDATED = replace(BATTERY, definition="float64 volts\nfloat64 level\n")


def battery(first: float, second: float) -> bytes:
    return b"\x00\x01\x00\x00" + struct.pack("<dd", first, second)


def levels(bag: Path) -> list[float]:
    with AnyReader([bag]) as reader:
        batteries = [one for one in reader.connections if one.topic == BATTERY.topic]
        read: list[Any] = [
            reader.deserialize(data, BATTERY.type_name) for _, _, data in reader.messages(batteries)
        ]
        return [message.level for message in read]


def test_with_another_definition_of_a_type_the_recording_goes_on_in_another(tmp_path: Path) -> None:
    said: list[str] = []
    sink = RecordingSink(tmp_path / "drive", said.append, itertools.count(START_NS).__next__)
    for robot in ("ada", "ada-2"):
        for stream in (ODOM, BATTERY):
            sink.open(robot, stream)
        take(sink, BATTERY, battery(80, 24.5), robot)
    # A comment makes no other type, nor does a robot that does not know the definition.
    for same in (
        replace(BATTERY, definition="# V\nfloat64 level\nfloat64 volts\n"),
        replace(BATTERY, definition=""),
    ):
        sink.open("ada", same)
    take(sink, BATTERY, battery(79, 24.5))
    sink.open("ada", UPDATED)
    take(sink, UPDATED, battery(24.5, 78))
    take(sink, ODOM, odometry(1.0, 2.0))
    sink.close()
    drive = tmp_path / "drive"
    assert said == [
        f"ada: the definition of {BATTERY.type_name} changed; the recording goes on in {drive / 'ada-3'}"
    ]
    assert {path.name: levels(path) for path in drive.iterdir()} == {
        "ada": [80, 79],
        "ada-2": [80],
        "ada-3": [78],
    }
    assert [one.topic for one in read_bag(drive / "ada-3").messages] == ["/battery", "/odom"]


def test_a_recording_whose_end_cannot_be_written_appears_with_what_was_and_is_said_once(
    tmp_path: Path,
) -> None:
    said: list[str] = []
    sink = RecordingSink(tmp_path / "drive", said.append, itertools.count(START_NS).__next__)
    sink.open("ada", GRIPPER)
    take(sink, GRIPPER, HELD)
    with files_at_most((tmp_path / "drive" / ".ada.partial" / "ada.mcap").stat().st_size):
        sink.close()
    assert len(said) == 1
    assert "cannot be written" in said[0]
    assert [path.name for path in (tmp_path / "drive").iterdir()] == ["ada"]
    assert len(read_bag(tmp_path / "drive" / "ada").messages) == 1


def test_a_recording_whose_metadata_cannot_be_written_has_none_of_half(tmp_path: Path) -> None:
    said: list[str] = []
    sink = RecordingSink(tmp_path / "drive", said.append, itertools.count(START_NS).__next__)
    sink.open("ada", GRIPPER)
    take(sink, GRIPPER, HELD)
    (tmp_path / "drive" / ".ada.partial" / "metadata.yaml").mkdir()
    sink.close()
    assert len(said) == 1
    assert said[0].startswith(f"{tmp_path / 'drive' / 'ada'}: error: metadata.yaml cannot be written")
    assert len(read_with_mcap(tmp_path / "drive" / "ada" / "ada.mcap")) == 1
