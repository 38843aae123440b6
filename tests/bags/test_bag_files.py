# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""Metadata that people wrote or moved: files in other places, entries that are missing or make no sense."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path

import pytest
import zstandard
from rosbags.interfaces import Qos, QosDurability, QosReliability
from rosbags.rosbag2 import StoragePlugin

from bags.bag_factory import BagMessage, small_mission, write_bag, write_split_bag
from bags.bag_reading import read_bag
from smarttestudo.bags.bag_files import find_bag_files
from smarttestudo.bags.metadata import read_metadata
from smarttestudo.bags.reader import open_recording

MISSION = small_mission(0.4)
HALF = len(MISSION.messages) // 2
HEAD = "rosbag2_bagfile_information:\n  version: 5\n"
TOPIC = """  topics_with_message_count:
    - topic_metadata: {name: /odom, type: nav_msgs/msg/Odometry, serialization_format: cdr%s}
      message_count: 10
"""


def listing(names: Sequence[str]) -> str:
    return HEAD + "  relative_file_paths:\n" + "".join(f"    - '{name}'\n" for name in names)


def pack(path: Path) -> None:
    path.with_name(f"{path.name}.zstd").write_bytes(zstandard.compress(path.read_bytes()))
    path.unlink()


@pytest.mark.parametrize("storage", StoragePlugin)
@pytest.mark.parametrize(
    ("place", "written"),
    [
        ("bag/bag.X", "bag.X"),
        ("bag/bag.X", "./bag.X"),
        ("bag/bag.X", "former/bag.X"),
        ("bag/bag.X", "/home/robot/bag/bag.X"),
        ("bag/bag.X", "former\\bag.X"),
        ("bag/splits/a/bag.X", "splits/a/bag.X"),
        ("bag/splits/bag.X", "splits\\bag.X"),
        ("other/bag.X", "../other/bag.X"),
        ("other/bag.X", "other/bag.X"),
        ("bag.X", "bag.X"),
        ("other/bag.X", "ROOT/other/bag.X"),
    ],
)
def test_files_are_read_where_the_metadata_have_them(
    tmp_path: Path, storage: StoragePlugin, place: str, written: str
) -> None:
    suffix = "mcap" if storage is StoragePlugin.MCAP else "db3"
    made = next(write_bag(tmp_path / "made", MISSION, storage=storage).glob(f"*.{suffix}"))
    path = tmp_path / place.replace("X", suffix)
    path.parent.mkdir(parents=True, exist_ok=True)
    (tmp_path / "bag").mkdir(exist_ok=True)
    made.rename(path)
    name = written.replace("X", suffix).replace("ROOT", str(tmp_path))
    for before, is_packed in ((name, False), (f"{name}.zstd", False), (name, True)):
        (tmp_path / "bag" / "metadata.yaml").write_text(listing([before]))
        if is_packed:
            pack(path)
        read = read_bag(tmp_path / "bag")
        assert (read.messages, read.notices) == (list(MISSION.messages), [])


def test_recordings_are_joined_by_metadata_beside_them(tmp_path: Path) -> None:
    for name, part in (("one", MISSION.between(0, HALF)), ("two", MISSION.between(HALF, None))):
        write_bag(tmp_path / name, part)
    (tmp_path / "both").mkdir()
    names = ["../one/one.db3", "../two/two.db3", "../one/one.db3"]
    (tmp_path / "both" / "metadata.yaml").write_text(listing(names))
    assert read_bag(tmp_path / "both").messages == list(MISSION.messages)
    assert len(find_bag_files(tmp_path / "both").paths) == 2


def test_a_file_that_the_metadata_do_not_name_is_left_out_with_a_notice(tmp_path: Path) -> None:
    write_split_bag(tmp_path / "bag", [MISSION.between(0, HALF), MISSION.between(HALF, None)])
    first, second = sorted((tmp_path / "bag").glob("*.db3"))
    (tmp_path / "bag" / "metadata.yaml").write_text(listing([first.name]))
    assert find_bag_files(tmp_path / "bag").notices == (
        f"{second}: not read, as the metadata do not name it",
    )


def test_a_letter_of_another_encoding_costs_itself(tmp_path: Path) -> None:
    path = write_bag(tmp_path / "bag", MISSION) / "metadata.yaml"
    written = path.read_text("utf-8")
    named = written.replace("custom_data: null", "custom_data: {operator: Jörgen}")
    assert named != written
    path.write_bytes(named.encode("latin-1"))
    metadata = read_metadata(tmp_path / "bag")
    assert metadata.counts.total == len(MISSION.messages)
    assert metadata.custom_data == {"operator": r"J\xf6rgen"}


def test_an_entry_that_is_indented_too_far_is_one_of_the_list(tmp_path: Path) -> None:
    folder = write_split_bag(tmp_path / "bag - b", [MISSION.between(0, HALF), MISSION.between(HALF, None)])
    first, second = (f"bag - b_{number}.db3" for number in (0, 1))
    (folder / second).rename(folder / "second.db3")
    (folder / "metadata.yaml").write_text(
        f"{HEAD}  relative_file_paths:\n  - {first}\n  - second.db3\n    - third.db3\n"
    )
    read = read_bag(folder)
    assert read.messages == list(MISSION.messages)
    assert read.notices == [f"{folder / 'third.db3'}: missing, but named in the metadata"]


def test_one_file_stands_for_one_of_two_names(tmp_path: Path) -> None:
    folder = write_bag(tmp_path / "bag", MISSION)
    (folder / "metadata.yaml").write_text(listing(["a/bag.db3", "b/bag.db3"]))
    read = read_bag(folder)
    assert read.messages == list(MISSION.messages)
    assert read.notices == [f"{folder / 'b' / 'bag.db3'}: missing, but named in the metadata"]


PROFILE = {
    "history": "1",
    "depth": "7",
    "reliability": "1",
    "durability": "1",
    "deadline": "{sec: 1, nsec: 2}",
    "lifespan": "{sec: 1, nsec: 2}",
    "liveliness": "1",
    "liveliness_lease_duration": "{sec: 1, nsec: 2}",
    "avoid_ros_namespace_conventions": "false",
}


@pytest.mark.parametrize("left_out", [*PROFILE, ""])
@pytest.mark.parametrize("is_text", [True, False])
def test_a_profile_by_hand_needs_no_more_than_is_known(
    tmp_path: Path, left_out: str, *, is_text: bool
) -> None:
    folder = write_bag(tmp_path / "bag", MISSION)
    profile = "{" + ", ".join(f"{key}: {value}" for key, value in PROFILE.items() if key != left_out) + "}"
    texts = ("{}", "[{}]") if not is_text else ("'{}'", "'[{}]'", "'- {}'")
    for text in texts:
        entry = ", offered_qos_profiles: " + text.format(profile)
        (folder / "metadata.yaml").write_text(listing(["bag.db3"]) + TOPIC % entry)
        metadata = read_metadata(folder)
        ((qos,),) = (channel.qos for channel in metadata.channels)
        assert isinstance(qos, Qos)
        assert metadata.notices == ()
        assert qos.depth == (0 if left_out == "depth" else 7)
        assert (qos.reliability is QosReliability.RELIABLE) == (left_out != "reliability")
        assert (qos.durability is QosDurability.TRANSIENT_LOCAL) == (left_out != "durability")


@pytest.mark.parametrize(
    "text", ["reliable", "'['", "'- 5'", "[reliable]", "'- {depth: deep}'", "{deadline: never}", "7", "'{'"]
)
def test_a_qos_text_that_makes_no_sense_costs_itself(tmp_path: Path, text: str) -> None:
    folder = write_bag(tmp_path / "bag", MISSION)
    entry = f", offered_qos_profiles: {text}"
    (folder / "metadata.yaml").write_text(
        listing(["bag.db3"]) + TOPIC % entry + "  custom_data: {weather: rain}\n"
    )
    notice = f"{folder}: the QoS profiles of /odom cannot be read and were left out"
    with open_recording(folder) as recording:
        assert recording.custom_data == {"weather": "rain"}
        read = [BagMessage(channel.topic, stamp, data) for channel, stamp, data in recording.messages()]
        assert read == list(MISSION.messages)
        assert recording.notices() == [notice]


@pytest.mark.parametrize(
    "text",
    [
        "",
        "  topics_with_message_count:\n",
        "  topics_with_message_count: []\n",
        "  message_count: many\n",
        "  custom_data:\n  compression_format: ''\n  storage_identifier: ''\n",
    ],
)
def test_metadata_need_no_more_than_the_files(tmp_path: Path, text: str) -> None:
    folder = write_bag(tmp_path / "bag", MISSION)
    (folder / "metadata.yaml").write_text(listing(["bag.db3"]) + text)
    read = read_bag(folder)
    assert (read.messages, read.notices) == (list(MISSION.messages), [])


@pytest.mark.parametrize("topic", ["5", "{}", "{topic_metadata: 5}", "{topic_metadata: {name: /odom}}"])
def test_a_topic_that_makes_no_sense_costs_itself(tmp_path: Path, topic: str) -> None:
    folder = write_bag(tmp_path / "bag", MISSION)
    topics = f"  topics_with_message_count: [{topic}]\n  custom_data: {{weather: rain}}\n"
    (folder / "metadata.yaml").write_text(listing(["bag.db3"]) + topics)
    with open_recording(folder) as recording:
        assert recording.custom_data == {"weather": "rain"}
        assert recording.notices() == [f"{folder}: a topic of metadata.yaml makes no sense and was left out"]
