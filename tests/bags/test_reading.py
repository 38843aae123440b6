# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
from __future__ import annotations

import json
import os
import re
from pathlib import Path

import pytest
from mcap.writer import CompressionType, IndexType, Writer
from rosbags.rosbag2 import StoragePlugin

from bags.bag_factory import (
    CUSTOM_DEFINITION,
    CUSTOM_TYPE,
    LATCHED,
    MAP_NAME,
    ODOM,
    START_NS,
    TYPES,
    BagContent,
    BagMessage,
    odometry,
    small_mission,
    write_bag,
    write_humble_file,
    write_mcap_file,
    write_pairs,
    write_split_bag,
)
from bags.bag_reading import read_bag
from smarttestudo.bags.definitions import RosbagDecoder
from smarttestudo.bags.measure import measure_bag, measure_run
from smarttestudo.bags.reader import open_recording
from smarttestudo.bags.writer import create_recording
from smarttestudo.domain.recording import Channel

MISSION = small_mission()


def test_every_kind_of_bag_gives_its_messages_byte_for_byte_in_time_order(bag: Path) -> None:
    read = read_bag(bag)
    assert read.messages == list(MISSION.messages)
    assert read.notices == []


def test_a_bag_says_when_it_starts_and_ends_and_how_many_messages_it_holds(bag: Path) -> None:
    with open_recording(bag) as recording:
        assert recording.start_ns == MISSION.messages[0].stamp_ns
        assert recording.end_ns == MISSION.messages[-1].stamp_ns
        assert recording.message_count == len(MISSION.messages)


def test_without_metadata_the_files_are_read_and_a_notice_says_so(bag: Path) -> None:
    kept = (bag / "metadata.yaml").rename(bag / "kept.txt")
    try:
        read = read_bag(bag)
    finally:
        kept.rename(bag / "metadata.yaml")
    assert read.messages == list(MISSION.messages)
    assert read.notices == [f"{bag}: metadata.yaml is missing; the files in the folder were read instead"]


@pytest.mark.parametrize("text", ["{[", "", "rosbag2_bagfile_information: 3", "a: b", "\x00", "&a [*a]"])
def test_broken_metadata_cost_a_notice_and_no_message(tmp_path: Path, text: str) -> None:
    folder = write_bag(tmp_path / "bag", MISSION)
    (folder / "metadata.yaml").write_text(text)
    read = read_bag(folder)
    assert read.messages == list(MISSION.messages)
    assert read.notices == [f"{folder}: metadata.yaml is broken; the files in the folder were read instead"]


def test_a_single_file_is_read_like_its_folder(bag: Path) -> None:
    files = sorted(path for path in bag.iterdir() if path.name != "metadata.yaml")
    assert [message for file in files for message in read_bag(file).messages] == list(MISSION.messages)


@pytest.mark.parametrize("storage", StoragePlugin)
def test_channels_carry_type_definition_hash_and_qos(tmp_path: Path, storage: StoragePlugin) -> None:
    with open_recording(write_bag(tmp_path / "bag", MISSION, storage=storage, version=9)) as recording:
        channels = {channel.topic: channel for channel in recording.channels}
    gripper, map_name = channels["/gripper"], channels["/map_name"]
    assert (gripper.type_name, gripper.definition) == (CUSTOM_TYPE, CUSTOM_DEFINITION)
    assert gripper.digest.startswith("RIHS01_")
    assert map_name.qos == (LATCHED,)
    assert [channel.topic for channel in channels.values() if channel.transient_local] == ["/map_name"]


@pytest.mark.parametrize("storage", StoragePlugin)
def test_overlapping_files_are_merged_by_time(tmp_path: Path, storage: StoragePlugin) -> None:
    parts = [BagContent(MISSION.topics, MISSION.messages[i::3]) for i in range(3)]
    read = read_bag(write_split_bag(tmp_path / "mission", parts, storage=storage))
    assert read.messages == list(MISSION.messages)


def test_declared_sizes_are_known_from_the_folder_and_from_the_file(tmp_path: Path) -> None:
    noted = {"smarttestudo.declared_bytes": json.dumps({"/image": 6_220_000}), "operator": "Ada"}
    for storage in StoragePlugin:
        folder = write_bag(tmp_path / storage.name, MISSION, storage=storage, custom_data=noted)
        file = next(path for path in folder.iterdir() if path.suffix in (".db3", ".mcap"))
        for path in (folder, file):
            with open_recording(path) as recording:
                assert recording.declared_bytes == {"/image": 6_220_000}
                assert recording.custom_data == noted


def test_notes_are_read_as_they_are_written(tmp_path: Path) -> None:
    noted = {"serial": "007", "version": "1.10", "armed": "true", "operator": "~ada", "shift": "12_000"}
    folder = write_bag(tmp_path / "bag", MISSION, custom_data=noted)
    metadata = folder / "metadata.yaml"
    # rosbag2 quotes no such text.
    quoted = r"(?m)^( +(?:serial|version|armed|shift): )'(.+)'$"
    metadata.write_text(re.sub(quoted, r"\1\2", metadata.read_text()))
    assert "serial: 007" in metadata.read_text()
    with open_recording(folder) as recording:
        assert recording.custom_data == noted


@pytest.mark.parametrize("text", ["[]", "{", '{"/image": -1}', '{"/image": "big"}', '{"/image": true}'])
def test_declared_sizes_that_make_no_sense_cost_a_notice(tmp_path: Path, text: str) -> None:
    noted = {"smarttestudo.declared_bytes": text}
    with open_recording(write_bag(tmp_path / "bag", MISSION, custom_data=noted)) as recording:
        assert recording.declared_bytes == {}
        assert len(recording.notices()) == 1


MCAP_FORMS = {
    "zstd": {},
    "lz4": {"compression": CompressionType.LZ4},
    "plain": {"compression": CompressionType.NONE},
    "one chunk": {"chunk_size": 10_000_000},
    "unchunked": {"use_chunking": False},
    "no index": {"index_types": IndexType.NONE},
    "chunks without message index": {"index_types": IndexType.CHUNK},
    "channels in the chunks only": {"repeat_channels": False},
}


@pytest.mark.parametrize("form", MCAP_FORMS)
def test_every_form_of_mcap_gives_its_messages_in_time_order(tmp_path: Path, form: str) -> None:
    shuffled = BagContent(MISSION.topics, MISSION.messages[1::2] + MISSION.messages[::2])
    path = write_mcap_file(tmp_path / "mission.mcap", shuffled, **MCAP_FORMS[form])  # type: ignore[arg-type]
    read = read_bag(path)
    assert read.messages == list(MISSION.messages)
    assert [notice for notice in read.notices if "stamps go back" not in notice] == []


def test_a_humble_file_defines_no_types_yet_its_standard_types_decode(tmp_path: Path) -> None:
    decoder = RosbagDecoder()
    with open_recording(write_humble_file(tmp_path / "humble.db3", MISSION)) as recording:
        channels = {channel.topic: channel for channel in recording.channels}
        assert {channel.definition for channel in channels.values()} == {None}
        assert [name for name, channel in channels.items() if decoder.why_undecodable(channel)] == [
            "/gripper"
        ]
        payload = next(payload for channel, _, payload in recording.messages() if channel.topic == "/odom")
    assert decoder.decode(channels["/odom"], payload).pose.pose.position.y == 0.0  # type: ignore[attr-defined]


def test_two_writers_of_one_topic_become_one_channel(tmp_path: Path) -> None:
    parts = [
        BagContent((ODOM, MAP_NAME), (BagMessage("/odom", START_NS + i, odometry(i, i)),)) for i in range(2)
    ]
    with open_recording(write_split_bag(tmp_path / "bag", parts)) as recording:
        assert [channel.topic for channel in recording.channels] == ["/odom", "/map_name"]


DEFINITIONS = ("float64 a\nfloat64 b\n", "float64 b\nfloat64 a\n", "float64 a # in m\nfloat64 b\n")
"""Two types, and the first with another comment."""


def test_a_message_is_decoded_by_its_own_definition(tmp_path: Path) -> None:
    decoder = RosbagDecoder()
    with open_recording(write_pairs(tmp_path / "redefined.mcap", DEFINITIONS)) as recording:
        assert [channel.definition for channel in recording.channels] == list(DEFINITIONS[:2])
        decoded = [decoder.decode(channel, payload) for channel, _, payload in recording.messages()]
    assert [message.a for message in decoded] == [1.0, 1.0, 1.0]  # type: ignore[attr-defined]


def test_a_channel_without_a_schema_is_read_like_any_other(tmp_path: Path) -> None:
    path = tmp_path / "plain.mcap"
    with path.open("wb") as file:
        writer = Writer(file)
        writer.start(profile="", library="test")
        channel = writer.register_channel("/plain", "json", 0)
        for at in range(5):
            writer.add_message(channel, START_NS + at, b"{}", START_NS + at)
        writer.finish()  # type: ignore[no-untyped-call]
    read = read_bag(path)
    assert len(read.messages) == 5
    assert read.notices == []
    assert measure_bag(path, lambda _: None).notices == (
        "/plain: recorded as json, not as cdr; its messages are counted, but cannot be decoded",
    )


@pytest.mark.parametrize("name", ["run #3", "run?3", "50%41", os.fsdecode(b"\xff")])
def test_names_that_mean_something_in_an_address_are_taken_as_they_are(tmp_path: Path, name: str) -> None:
    folder = write_bag(tmp_path / "plain", MISSION)
    folder = folder.rename(tmp_path / name)
    assert read_bag(folder).messages == list(MISSION.messages)


def test_a_robot_whose_odometry_got_a_field_is_followed_through_both_definitions(tmp_path: Path) -> None:
    text, _ = TYPES.generate_msgdef(ODOM.type_name, ros_version=2)
    head, *parts = text.split("=" * 80)
    longer = "".join((f"{head}float64 quality\n", *("=" * 80 + part for part in parts)))
    with create_recording(tmp_path / "bag") as writer:
        for at in range(20):
            definition, end = (text, b"") if at < 10 else (longer, bytes(8))
            channel = Channel(topic="/odom", type_name=ODOM.type_name, definition=definition)
            writer.write(channel, START_NS + at * 10**9, odometry(at, 0.0) + end)
    path = measure_run(tmp_path / "bag", lambda _: None).path
    assert [point.x_m for point in path] == [*range(20)]
