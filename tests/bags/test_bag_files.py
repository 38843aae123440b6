# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""Metadata that people wrote or moved: files in other places, entries that are missing or make no sense."""

from __future__ import annotations

import os
import shutil
from collections.abc import Callable, Sequence
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


def splits(folder: Path, *names: str) -> Path:
    """Storage files of these names without metadata, each of another part of the mission."""
    folder.mkdir()
    for number, name in enumerate(names):
        made = write_bag(folder / f"made{number}", MISSION.between(number, number + 1))
        next(made.glob("*.db3")).rename(folder / name)
        shutil.rmtree(made)
    return folder


@pytest.mark.parametrize(
    ("names", "missing"),
    [
        (("a_0.db3", "a_2.db3"), ["a_1.db3"]),
        (("a_1.db3", "a_2.db3"), ["a_0.db3"]),
        (("a_0.db3", "a_1.db3", "b_0.db3", "b_2.db3"), ["b_1.db3"]),
        (("a_0.DB3", "a_3.DB3"), ["a_1.DB3", "a_2.DB3"]),
        (("a_0.db3", "a_1.db3"), []),
        (("a_3.db3",), []),
        (("of_2024.db3", "of_2025.db3"), []),
        (("one.db3", "two.db3"), []),
        (("a_20240101.db3", "a_20240103.db3"), []),
    ],
)
def test_the_numbers_of_files_without_metadata_tell_which_are_missing(
    tmp_path: Path, names: Sequence[str], missing: Sequence[str]
) -> None:
    folder = splits(tmp_path / "bag", *names)
    with open_recording(folder) as recording:
        assert sum(1 for _ in recording.messages()) == len(names)
        _, *notices = recording.notices()
        assert (recording.readable_share == 1) == (not missing)
    assert notices == [f"{folder / name}: missing, by the numbers of the other files" for name in missing]


def test_of_many_missing_files_few_are_named(tmp_path: Path) -> None:
    folder = splits(tmp_path / "bag", "a_0.db3", "a_900.db3")
    _, *named, rest = find_bag_files(folder).notices
    assert len(named) == 3
    assert rest == f"{folder}: 899 files missing, by their numbers"


def linked(folder: Path) -> None:
    (folder / "b.db3").symlink_to("bag.db3")


def hard_linked(folder: Path) -> None:
    (folder / "b.db3").hardlink_to(folder / "bag.db3")


def copied(folder: Path) -> None:
    shutil.copy(folder / "bag.db3", folder / "b.db3")


@pytest.mark.parametrize("double", [linked, hard_linked, copied])
@pytest.mark.parametrize("has_metadata", [True, False])
def test_a_file_that_is_there_twice_is_read_once(
    tmp_path: Path, double: Callable[[Path], None], *, has_metadata: bool
) -> None:
    folder = write_bag(tmp_path / "bag", MISSION)
    double(folder)
    (folder / "metadata.yaml").unlink()
    if has_metadata:
        (folder / "metadata.yaml").write_text(listing(["bag.db3", "b.db3"]))
    read = read_bag(folder)
    assert read.messages == list(MISSION.messages)
    first, second = ("bag.db3", "b.db3") if has_metadata else ("b.db3", "bag.db3")
    assert read.notices[-1] == f"{folder / second}: the same file as {first}, and read once"
    assert len(read.notices) == (1 if has_metadata else 2)


@pytest.mark.parametrize("name", ["./bag.db3", ".//bag.db3", "../bag/bag.db3", "./././bag.db3"])
def test_a_file_that_the_metadata_name_twice_is_read_once(tmp_path: Path, name: str) -> None:
    folder = write_bag(tmp_path / "bag", MISSION)
    (folder / "metadata.yaml").write_text(listing(["bag.db3", name]))
    read = read_bag(folder)
    assert read.messages == list(MISSION.messages)
    (notice,) = read.notices
    assert "read once" in notice
    assert "missing" not in notice


def loop(path: Path) -> str:
    path.symlink_to(path.name)
    return "cannot be read: Too many levels of symbolic links"


def pipe(path: Path) -> str:
    os.mkfifo(path)
    return "cannot be read: it is a device or a pipe, not a file"


def dangling(path: Path) -> str:
    path.symlink_to("nowhere")
    return "cannot be read: No such file or directory"


def empty(path: Path) -> str:
    path.touch()
    return "the file is empty"


def folder_of_that_name(path: Path) -> str:
    path.mkdir()
    return "cannot be read: it is a folder"


@pytest.mark.parametrize("make", [loop, pipe, dangling, empty, folder_of_that_name])
@pytest.mark.parametrize("has_metadata", [True, False])
def test_what_is_no_file_is_named_with_its_reason(
    tmp_path: Path, make: Callable[[Path], str], *, has_metadata: bool
) -> None:
    folder = write_bag(tmp_path / "bag", MISSION)
    why = make(folder / "b.db3")
    (folder / "metadata.yaml").unlink()
    if has_metadata:
        (folder / "metadata.yaml").write_text(listing(["bag.db3", "b.db3"]))
    with open_recording(folder) as recording:
        assert sum(1 for _ in recording.messages()) == len(MISSION.messages)
        notices = [notice for notice in recording.notices() if "metadata.yaml is missing" not in notice]
    # A folder in a folder without metadata may be another recording.
    is_said = has_metadata or make is not folder_of_that_name
    assert notices == ([f"{folder / 'b.db3'}: {why}"] if is_said else [])


@pytest.mark.parametrize("storage", StoragePlugin)
@pytest.mark.parametrize("name", ["A.MCAP", "a.Db3", "a", "a.bag2", "a.txt", "A.MCAP.ZSTD", "a.db3.Zstd"])
def test_a_single_file_is_read_by_its_content(tmp_path: Path, storage: StoragePlugin, name: str) -> None:
    made = write_bag(tmp_path / "made", MISSION, storage=storage)
    (file,) = (path for path in made.iterdir() if path.suffix in {".mcap", ".db3"})
    data = file.read_bytes()
    path = tmp_path / name
    path.write_bytes(zstandard.compress(data) if name.lower().endswith(".zstd") else data)
    with open_recording(path) as recording:
        assert recording.storage.name == storage.name
        assert sum(1 for _ in recording.messages()) == len(MISSION.messages)
        assert recording.notices() == []


def test_files_with_upper_case_names_in_a_folder_are_read(tmp_path: Path) -> None:
    folder = splits(tmp_path / "bag", "A_0.DB3", "A_1.db3")
    (folder / "A_1.db3").rename(folder / "A_1.DB3")
    assert read_bag(folder).messages == list(MISSION.messages[:2])
