# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
from __future__ import annotations

import dataclasses
import sqlite3
from contextlib import closing
from pathlib import Path

import pytest
from mcap.records import Chunk, McapRecord

from bags.bag_factory import small_mission, write_bag
from bags.recorded_by_others import ODOMETRY, Table, chunk, drive, write_records, write_tables
from smarttestudo.bags.reader import open_recording
from smarttestudo.cli.main import main
from smarttestudo.domain.errors import RecordingError

EXPECTED = "give a rosbag2 folder, a .db3 or an .mcap file"


def refusal(path: Path) -> str:
    with pytest.raises(RecordingError) as refused, open_recording(path):
        pass
    line = str(refused.value)
    assert line.startswith(f"{path}: error: ")
    return line.removeprefix(f"{path}: error: ")


def test_a_path_that_is_not_there(tmp_path: Path) -> None:
    assert refusal(tmp_path / "nowhere") == f"no such file or folder; {EXPECTED}"


def test_an_empty_folder(tmp_path: Path) -> None:
    assert refusal(tmp_path) == f"the folder holds no .db3 or .mcap file; {EXPECTED}"


def test_a_folder_whose_metadata_name_files_that_are_gone(tmp_path: Path) -> None:
    folder = write_bag(tmp_path / "bag", small_mission(0.2))
    (folder / "bag.db3").unlink()
    assert refusal(folder) == f"the folder holds no .db3 or .mcap file; {EXPECTED}"


@pytest.mark.parametrize("name", ["bag.db3", "bag.mcap", "bag.txt", "bag"])
def test_an_empty_file(tmp_path: Path, name: str) -> None:
    path = tmp_path / name
    path.touch()
    assert refusal(path) == f"the file is empty; {EXPECTED}"


def test_an_empty_file_in_a_folder_of_its_own(tmp_path: Path) -> None:
    folder = write_bag(tmp_path / "bag", small_mission(0.2))
    (folder / "bag.db3").write_bytes(b"")
    with pytest.raises(RecordingError, match="the file is empty"), open_recording(folder):
        pass


@pytest.mark.parametrize("name", ["bag.db3", "bag.mcap", "bag.db3.zstd"])
def test_a_file_that_only_has_the_name_of_a_bag(tmp_path: Path, name: str) -> None:
    path = tmp_path / name
    path.write_text("dear diary, ")
    assert refusal(path) == f"not a recording: unknown file header; {EXPECTED}"


def test_a_file_of_another_kind(tmp_path: Path) -> None:
    path = tmp_path / "notes.txt"
    path.write_text("dear diary, ")
    assert refusal(path) == f"unknown storage '.txt'; {EXPECTED}"


def test_a_ros_1_bag(tmp_path: Path) -> None:
    path = tmp_path / "old.bag"
    path.write_bytes(b"#ROSBAG V2.0\nxxxxxxxxxxx")
    remedy = f"convert it: rosbags-convert --src {path.name} --dst {path.stem}"
    assert refusal(path) == f"a ROS 1 bag, not a rosbag2; {remedy}"
    (tmp_path / "older.bag").mkdir()
    with pytest.raises(RecordingError) as refused, open_recording(tmp_path):
        pass
    assert str(refused.value) == f"{path}: error: a ROS 1 bag, not a rosbag2; {remedy}"


def test_a_database_that_is_no_bag(tmp_path: Path) -> None:
    path = tmp_path / "songs.db3"
    with closing(sqlite3.connect(path)) as database:
        database.execute("CREATE TABLE songs (title TEXT)")
    assert refusal(path) == "no rosbag2 topics can be found in it"


@pytest.mark.parametrize(
    ("entry", "changed", "refused"),
    [
        ("identifier: sqlite3", "identifier: floppy", "storage 'floppy'; convert it to sqlite3 or mcap"),
        (
            "compression_format: ''",
            "compression_format: rar",
            "compression 'rar'; convert it to zstd or none",
        ),
    ],
)
def test_a_bag_that_needs_a_plugin(tmp_path: Path, entry: str, changed: str, refused: str) -> None:
    folder = write_bag(tmp_path / "bag", small_mission(0.2))
    metadata = folder / "metadata.yaml"
    text = metadata.read_text()
    assert entry in text
    metadata.write_text(text.replace(entry, changed))
    assert refusal(folder) == f"unknown {refused} with `ros2 bag convert`"


def test_a_database_whose_column_names_are_damaged(tmp_path: Path) -> None:
    content = small_mission(0.2)
    path = write_bag(tmp_path / "bag", content) / "bag.db3"
    path.write_bytes(path.read_bytes().replace(b"offered_qos", b"\x80ffered_qos"))
    with open_recording(path) as recording:
        assert sum(1 for _ in recording.messages()) == len(content.messages)
    path.write_bytes(path.read_bytes().replace(b"name TEXT", b"nmae TEXT"))
    assert refusal(path) == "no rosbag2 topics can be found in it"


COMMANDS = ("info", "rates", "bandwidth")


def packed_with_brotli(*records: McapRecord) -> list[McapRecord]:
    packed, *indexes = chunk(*records)
    assert isinstance(packed, Chunk)
    return [dataclasses.replace(packed, compression="br", data=b"\x0b\x02\x80 not zstd"), *indexes]


@pytest.mark.parametrize("command", COMMANDS)
@pytest.mark.parametrize("is_closed", [True, False])
def test_chunks_of_a_compression_that_is_not_read(
    tmp_path: Path, capsys: pytest.CaptureFixture[str], command: str, *, is_closed: bool
) -> None:
    packed = packed_with_brotli(*ODOMETRY, *drive())
    path = write_records(tmp_path / "a.mcap", *packed, is_closed=is_closed)
    assert main(["bag", command, str(path)]) != 0
    out, err = capsys.readouterr()
    assert "chunks compressed with 'br', which is not read: 1" in err
    assert "1970" not in out + err
    if is_closed:
        assert f"{path}: error: none of its 100 messages can be read; " in err


@pytest.mark.parametrize("command", COMMANDS)
def test_half_of_the_chunks_of_a_compression_that_is_not_read(
    tmp_path: Path, capsys: pytest.CaptureFixture[str], command: str
) -> None:
    packed = packed_with_brotli(*drive(range(50, 100)))
    path = write_records(tmp_path / "a.mcap", *chunk(*ODOMETRY, *drive(range(50))), *packed)
    main(["bag", command, str(path)])
    err = capsys.readouterr().err
    assert "chunks compressed with 'br', which is not read: 1; 50 % readable" in err


@pytest.mark.parametrize("command", COMMANDS)
@pytest.mark.parametrize("storage", ["mcap", "sqlite3"])
def test_a_recording_without_messages_has_no_date(
    tmp_path: Path, capsys: pytest.CaptureFixture[str], command: str, storage: str
) -> None:
    if storage == "mcap":
        path = write_records(tmp_path / "a.mcap", *ODOMETRY)
    else:
        path = write_tables(tmp_path / "a.db3", [Table("/odom", "nav_msgs/msg/Odometry", [])])
    assert main(["bag", command, str(path)]) == 0
    out, err = capsys.readouterr()
    assert f"note: {path}: the recording holds no message" in err
    assert "1970" not in out + err


def test_a_folder_with_two_storages_and_no_metadata(tmp_path: Path) -> None:
    (tmp_path / "a.db3").write_bytes(b"x")
    (tmp_path / "a.mcap").write_bytes(b"x")
    cause = "the folder holds .db3 and .mcap files, and no metadata name those of the recording"
    assert refusal(tmp_path) == f"{cause}; name one of the files"


def test_a_packed_file_beside_its_unpacked_copy_is_not_counted_twice(tmp_path: Path) -> None:
    content = small_mission(0.2)
    folder = write_bag(tmp_path / "bag", content)
    (folder / "metadata.yaml").unlink()
    (folder / "bag.db3.zstd").write_bytes(b"left over")
    with open_recording(folder) as recording:
        assert sum(1 for _ in recording.messages()) == len(content.messages)
