# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
from __future__ import annotations

import errno
import json
import sqlite3
import subprocess
import sys
from contextlib import closing
from pathlib import Path

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from mcap.reader import make_reader
from ruamel.yaml import YAML

from bags.bag_factory import (
    BEST_EFFORT,
    CUSTOM_DEFINITION,
    LATCHED,
    MAP_NAME,
    ODOM,
    START_NS,
    BagContent,
    BagMessage,
    read_yaml,
    small_mission,
    write_bag,
    write_humble_file,
)
from bags.bag_reading import read_bag, read_with_mcap, read_with_rosbags
from smarttestudo.bags.reader import open_recording
from smarttestudo.bags.stray_stamps import YEAR_NS
from smarttestudo.bags.writer import create_recording
from smarttestudo.domain.errors import RecordingError
from smarttestudo.domain.recording import Channel, Storage
from smarttestudo.files.outputs import write_error

MISSION = small_mission()
ODD = Channel(topic="/odd", type_name="nobody_msgs/msg/Odd")


def copy_bag(source: Path, target: Path, storage: Storage) -> Path:
    with (
        open_recording(source) as recording,
        create_recording(target, storage=storage, custom_data=recording.custom_data) as writer,
    ):
        for channel in recording.channels:
            writer.add(channel)
        for channel, stamp_ns, payload in recording.messages():
            writer.write(channel, stamp_ns, payload)
    return target


@pytest.fixture(scope="module")
def source(tmp_path_factory: pytest.TempPathFactory) -> Path:
    return write_bag(tmp_path_factory.mktemp("source") / "mission", MISSION, custom_data={"operator": "Ada"})


@pytest.mark.parametrize("storage", Storage)
def test_a_copy_holds_the_same_bytes_for_our_reader_and_for_others(
    source: Path, tmp_path: Path, storage: Storage
) -> None:
    copy = copy_bag(source, tmp_path / "copy", storage)
    assert read_bag(copy).messages == list(MISSION.messages)
    assert read_with_rosbags(copy) == list(MISSION.messages)
    if storage is Storage.MCAP:
        assert read_with_mcap(copy / "copy.mcap") == list(MISSION.messages)


@pytest.mark.parametrize("storage", Storage)
def test_a_copy_keeps_types_definitions_hashes_qos_and_notes(
    source: Path, tmp_path: Path, storage: Storage
) -> None:
    copy = copy_bag(source, tmp_path / "copy", storage)
    with open_recording(source) as original, open_recording(copy) as copied:
        assert copied.channels == original.channels
        assert copied.custom_data == {"operator": "Ada"}
        assert [channel.definition for channel in copied.channels if channel.topic == "/gripper"] == [
            CUSTOM_DEFINITION
        ]


@pytest.mark.parametrize("storage", Storage)
def test_the_metadata_are_what_humble_reads(source: Path, tmp_path: Path, storage: Storage) -> None:
    copy = copy_bag(source, tmp_path / "copy", storage)
    information = read_yaml(copy / "metadata.yaml")["rosbag2_bagfile_information"]
    suffix = "db3" if storage is Storage.SQLITE3 else "mcap"
    assert information["version"] == 8
    assert information["storage_identifier"] == storage.value
    assert information["relative_file_paths"] == [f"copy.{suffix}"]
    assert information["message_count"] == len(MISSION.messages)
    assert information["compression_mode"] == information["compression_format"] == ""
    topics = {
        entry["topic_metadata"]["name"]: entry["topic_metadata"]
        for entry in information["topics_with_message_count"]
    }
    text = topics["/map_name"]["offered_qos_profiles"]
    assert isinstance(text, str)
    (profile,) = YAML(typ="safe").load(text)
    # Humble's parser takes rmw's numbers, not names: 1 is transient_local, and reliable, and keep_last.
    assert (profile["durability"], profile["reliability"], profile["history"], profile["depth"]) == (
        1,
        1,
        1,
        10,
    )
    assert profile["deadline"] == {"sec": 9223372036, "nsec": 854775807}
    assert profile["avoid_ros_namespace_conventions"] is False


def test_an_mcap_copy_is_what_foxglove_reads(source: Path, tmp_path: Path) -> None:
    copy = copy_bag(source, tmp_path / "copy", Storage.MCAP)
    with (copy / "copy.mcap").open("rb") as file:
        reader = make_reader(file)
        summary = reader.get_summary()
        assert reader.get_header().profile == "ros2"
    assert summary is not None
    assert {channel.message_encoding for channel in summary.channels.values()} == {"cdr"}
    assert {schema.encoding for schema in summary.schemas.values()} == {"ros2msg"}
    (channel,) = (channel for channel in summary.channels.values() if channel.topic == "/scan")
    (profile,) = YAML(typ="safe").load(channel.metadata["offered_qos_profiles"])
    assert profile["reliability"] == BEST_EFFORT.reliability.value


@pytest.mark.parametrize("storage", Storage)
def test_types_that_the_bag_does_not_define_are_filled_in_where_ros_2_knows_them(
    tmp_path: Path, storage: Storage
) -> None:
    humble = write_humble_file(tmp_path / "humble.db3", BagContent((ODOM, MAP_NAME), MISSION.messages[:1]))
    with open_recording(copy_bag(humble, tmp_path / "copy", storage)) as copied:
        definitions = {channel.topic: channel.definition for channel in copied.channels}
        digests = {channel.topic: channel.digest for channel in copied.channels}
    assert definitions["/map_name"] == "string data\n"
    # The hash of std_msgs/msg/String in every ROS 2 release that has hashes.
    assert digests["/map_name"] == "RIHS01_df668c740482bbd48fb39d76a70dfd4bd59db1288021743503259e948f6b1a18"


@pytest.mark.parametrize("storage", Storage)
def test_a_type_that_nobody_knows_is_passed_through(tmp_path: Path, storage: Storage) -> None:
    path = tmp_path / "odd"
    with create_recording(path, storage=storage) as writer:
        writer.write(ODD, START_NS, b"\x00\x01\x00\x00anything")
    expected = [BagMessage("/odd", START_NS, b"\x00\x01\x00\x00anything")]
    assert read_bag(path).messages == expected
    with open_recording(path) as recording:
        (channel,) = recording.channels
    assert channel == ODD
    metadata = read_yaml(path / "metadata.yaml")["rosbag2_bagfile_information"]
    assert metadata["topics_with_message_count"][0]["topic_metadata"]["type_description_hash"] == ""


def test_an_unknown_type_beside_known_ones_does_not_stop_other_readers(tmp_path: Path) -> None:
    for storage in Storage:
        path = tmp_path / storage.value
        with open_recording(write_bag(tmp_path / f"{storage.value} in", MISSION)) as recording:
            known = list(recording.channels)
        with create_recording(path, storage=storage) as writer:
            for channel in known:
                writer.add(channel)
            writer.write(ODD, START_NS, b"\x00\x01\x00\x00")
        assert [message.topic for message in read_with_rosbags(path)] == ["/odd"]


def test_declared_sizes_are_noted_beside_what_was_there(tmp_path: Path) -> None:
    with create_recording(
        tmp_path / "bag", declared_bytes={"/image": 6_220_000}, custom_data={"operator": "Ada"}
    ) as writer:
        writer.write(ODD, START_NS, b"")
    with open_recording(tmp_path / "bag") as recording:
        assert recording.declared_bytes == {"/image": 6_220_000}
        assert recording.custom_data["operator"] == "Ada"
    noted = read_yaml(tmp_path / "bag" / "metadata.yaml")["rosbag2_bagfile_information"]["custom_data"]
    assert json.loads(noted["smarttestudo.declared_bytes"]) == {"/image": 6_220_000}


@pytest.mark.parametrize("storage", Storage)
def test_a_bag_without_messages_can_be_read_again(tmp_path: Path, storage: Storage) -> None:
    with create_recording(tmp_path / "bag", storage=storage) as writer:
        writer.add(Channel(topic="/map_name", type_name=MAP_NAME.type_name, qos=(LATCHED,)))
    with open_recording(tmp_path / "bag") as recording:
        assert [channel.topic for channel in recording.channels] == ["/map_name"]
        assert (recording.start_ns, recording.end_ns, recording.message_count) == (0, 0, 0)
        assert list(recording.messages()) == []
        assert recording.notices() == [f"{tmp_path / 'bag'}: the recording holds no message"]


@settings(max_examples=25)
@given(
    payloads=st.lists(st.tuples(st.integers(0, YEAR_NS), st.binary(max_size=200)), min_size=1, max_size=20),
    storage=st.sampled_from(Storage),
)
def test_any_payload_comes_back_in_time_order(
    payloads: list[tuple[int, bytes]], storage: Storage, tmp_path_factory: pytest.TempPathFactory
) -> None:
    path = tmp_path_factory.mktemp("any") / "bag"
    with create_recording(path, storage=storage) as writer:
        for stamp_ns, payload in payloads:
            writer.write(ODD, stamp_ns, b"\x00\x01\x00\x00" + payload)
    with open_recording(path) as recording:
        read = [(stamp_ns, payload[4:]) for _, stamp_ns, payload in recording.messages()]
    assert read == sorted(payloads, key=lambda message: message[0])


@pytest.mark.parametrize("failure", [RuntimeError, KeyboardInterrupt])
@pytest.mark.parametrize("storage", Storage)
def test_nothing_is_left_when_writing_stops_half_way(
    tmp_path: Path, storage: Storage, failure: type[BaseException]
) -> None:
    def write_and_fail() -> None:
        with create_recording(tmp_path / "bag", storage=storage) as writer:
            writer.write(ODD, START_NS, b"x")
            raise failure

    with pytest.raises(failure):
        write_and_fail()
    assert list(tmp_path.iterdir()) == []


def test_a_bag_has_no_name_before_it_is_whole(tmp_path: Path) -> None:
    with create_recording(tmp_path / "bag") as writer:
        writer.write(ODD, START_NS, b"x")
        (workshop,) = tmp_path.iterdir()
        assert workshop.name.startswith(".")
        assert not list(workshop.rglob("metadata.yaml"))
    assert [path.name for path in tmp_path.iterdir()] == ["bag"]


def refusal_of(path: Path) -> str:
    with pytest.raises(RecordingError) as refused, create_recording(path):
        pytest.fail("nothing may be done before the refusal")
    return str(refused.value).removeprefix(f"{path}: error: ")


@pytest.mark.parametrize("kind", ["folder", "file", "dangling link"])
def test_an_output_that_exists_is_refused(tmp_path: Path, kind: str) -> None:
    path = tmp_path / "bag"
    if kind == "folder":
        path.mkdir()
    elif kind == "file":
        path.touch()
    else:
        path.symlink_to("nowhere")
    assert refusal_of(path) == "exists already; remove it or name another output"


def test_an_output_below_a_file_is_refused(tmp_path: Path) -> None:
    (tmp_path / "file").touch()
    assert refusal_of(tmp_path / "file" / "bag") in (
        "cannot be written: Not a directory",
        "cannot be written: File exists",
    )


def test_an_output_that_may_not_be_written_is_refused() -> None:
    assert refusal_of(Path("/proc/bag")).startswith("cannot be written: ")


def test_a_full_disk_is_told_in_one_line(tmp_path: Path) -> None:
    expected = f"{tmp_path}: error: the disk is full; free some space or write to another disk"
    assert str(write_error(tmp_path, OSError(errno.ENOSPC, "No space left on device"))) == expected
    with closing(sqlite3.connect(tmp_path / "small.db3")) as database:
        database.execute("PRAGMA max_page_count = 1")
        with pytest.raises(sqlite3.OperationalError) as full:
            database.execute("CREATE TABLE t (a)")
    assert str(write_error(tmp_path, full.value)) == expected


WRITE_TOO_MUCH = """
import resource, sys
from pathlib import Path
from smarttestudo.bags.writer import create_recording
from smarttestudo.domain.errors import RecordingError
from smarttestudo.domain.recording import Channel, Storage
resource.setrlimit(resource.RLIMIT_FSIZE, (300_000, 300_000))
try:
    with create_recording(Path(sys.argv[1]), storage=Storage(sys.argv[2])) as writer:
        for i in range(1000):
            writer.write(Channel(topic="/odd", type_name="a/msg/B"), i, bytes(10_000))
except RecordingError as error:
    print(error)
"""


@pytest.mark.parametrize("storage", Storage)
def test_a_disk_that_takes_no_more_costs_one_line_and_leaves_nothing(
    tmp_path: Path, storage: Storage
) -> None:
    path = tmp_path / "bag"
    command = [sys.executable, "-c", WRITE_TOO_MUCH, str(path), storage.value]
    run = subprocess.run(command, capture_output=True, text=True, check=False)
    assert run.stderr == ""
    assert run.stdout.startswith(f"{path}: error: cannot be written: ")
    assert run.stdout.count("\n") == 1
    assert list(tmp_path.iterdir()) == []
