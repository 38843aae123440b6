# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""Files of which a part is damaged, missing or of the wrong kind: what is left of them is read."""

from __future__ import annotations

import sqlite3
from collections.abc import Sequence
from contextlib import closing
from dataclasses import replace
from pathlib import Path

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from mcap.reader import make_reader
from mcap.writer import CompressionType
from rosbags.rosbag2 import CompressionMode, Reader, StoragePlugin

from bags.bag_factory import (
    BagContent,
    BagMessage,
    small_mission,
    write_bag,
    write_mcap_file,
    write_split_bag,
)
from bags.bag_reading import read_bag
from bags.damaged_files import MISSION, assert_each_is_an_original_at_most_once, read_or_refuse, storage_file
from smarttestudo.bags.reader import open_recording
from smarttestudo.domain.errors import RecordingError

TOGETHER = "read together with bag.db3-wal beside it, which holds what is not in it yet"


@pytest.mark.parametrize("is_whole", [True, False])
def test_a_message_with_a_time_that_no_clock_has_costs_itself(tmp_path: Path, *, is_whole: bool) -> None:
    late = BagMessage("/odom", 1 << 63, MISSION.messages[0].payload)
    path = write_mcap_file(tmp_path / "late.mcap", replace(MISSION, messages=(*MISSION.messages, late)))
    if not is_whole:
        path.write_bytes(path.read_bytes()[:-100])
    read = read_bag(path)
    assert read.messages == list(MISSION.messages)
    assert any("1 message with a time after 2262 left out" in notice for notice in read.notices)


@pytest.mark.parametrize("storage", StoragePlugin)
def test_a_file_of_several_that_is_gone_or_empty_costs_only_itself(
    tmp_path: Path, storage: StoragePlugin
) -> None:
    third = len(MISSION.messages) // 3
    parts = [MISSION.between(i * third, (i + 1) * third) for i in range(3)]
    folder = write_split_bag(tmp_path / "mission", parts, storage=storage)
    files = sorted(path for path in folder.iterdir() if path.name != "metadata.yaml")
    files[0].unlink()
    files[1].write_bytes(b"")
    read = read_bag(folder)
    assert read.messages == list(parts[2].messages)
    assert read.notices == [
        f"{files[0]}: missing, but named in the metadata",
        f"{files[1]}: the file is empty",
    ]


def test_a_damaged_chunk_costs_its_messages_and_no_other(tmp_path: Path) -> None:
    path = write_mcap_file(tmp_path / "mission.mcap", MISSION)
    with path.open("rb") as file:
        summary = make_reader(file).get_summary()
    assert summary is not None
    content = summary.chunk_indexes[len(summary.chunk_indexes) // 2].chunk_start_offset + 60
    data = bytearray(path.read_bytes())
    data[content : content + 40] = bytes(40)
    path.write_bytes(data)
    read = read_bag(path)
    assert_each_is_an_original_at_most_once(read.messages)
    assert 0.6 * len(MISSION.messages) < len(read.messages) < len(MISSION.messages)
    assert read.messages[-1] == MISSION.messages[-1]
    (notice,) = read.notices
    assert notice.startswith(f"{path}: damaged chunks: 1; 90 % readable, ends at ")


def test_a_damaged_chunk_of_a_cut_file_is_named_once_though_the_file_is_read_twice(tmp_path: Path) -> None:
    path = write_mcap_file(tmp_path / "mission.mcap", MISSION, compression=CompressionType.NONE)
    data = bytearray(path.read_bytes()[:-9000])
    image = data.index(bytes([7]) * 4000)
    data[image : image + 100] = bytes(100)
    path.write_bytes(data)
    with open_recording(path) as recording:
        messages, again = (list(recording.messages()) for _ in range(2))
        notices = recording.notices()
    assert messages == again
    assert 0.5 * len(MISSION.messages) < len(messages) < len(MISSION.messages)
    assert {(stamp_ns, payload) for _, stamp_ns, payload in messages} <= {
        (message.stamp_ns, message.payload) for message in MISSION.messages
    }
    assert [notice for notice in notices if "damaged chunks: 1; " in notice] == [notices[-1]]


def test_a_damaged_page_of_a_database_costs_its_messages_and_no_other(tmp_path: Path) -> None:
    path = storage_file(write_bag(tmp_path / "bag", MISSION))
    data = bytearray(path.read_bytes())
    page = len(data) // 4096 // 2 * 4096
    data[page : page + 4096] = b"\xff" * 4096
    path.write_bytes(data)
    read = read_bag(path)
    assert len({(message.topic, message.stamp_ns) for message in read.messages}) == len(read.messages)
    assert 0.8 * len(MISSION.messages) < len(read.messages)
    assert read.messages[-1] == MISSION.messages[-1]


def overwrite_pages(path: Path, numbers: Sequence[int]) -> None:
    """Fill pages with what is no page of a database."""
    data = bytearray(path.read_bytes())
    for number in numbers:
        data[(number - 1) * 4096 : number * 4096] = b"\xaa" * 4096
    path.write_bytes(data)


def pages_of_messages(path: Path) -> dict[str, int]:
    """The root pages of the table and its index."""
    with closing(sqlite3.connect(path)) as database:
        return dict(database.execute("SELECT type, rootpage FROM sqlite_master WHERE tbl_name = 'messages'"))


@pytest.mark.parametrize("has_index", [True, False])
def test_messages_that_went_with_their_pages_are_missed(tmp_path: Path, *, has_index: bool) -> None:
    small = [one for one in MISSION.messages if one.topic != "/image"]
    path = storage_file(write_bag(tmp_path / "bag", BagContent(MISSION.topics, tuple(small))))
    index = () if has_index else (pages_of_messages(path)["index"],)
    overwrite_pages(path, (path.stat().st_size // 4096 // 2, *index))
    with open_recording(path) as recording:
        read = list(recording.messages())
        share, (notice,) = recording.readable_share, recording.notices()
    missing = len(small) - len(read)
    assert missing > 0
    assert share == len(read) / len(small)
    assert f" after {len(read)} messages, {missing} rows cannot be read" in notice


def test_a_recording_ends_with_its_last_message_that_can_be_read(tmp_path: Path) -> None:
    small = [one for one in MISSION.messages if one.topic != "/image"]
    path = storage_file(write_bag(tmp_path / "bag", BagContent(MISSION.topics, tuple(small))))
    pages = path.stat().st_size // 4096
    leaves = [number for number in range(1, pages + 1) if path.read_bytes()[(number - 1) * 4096] == 0x0D]
    last = next(number for number in reversed(leaves) if small[-1].payload in page_of(path, number))
    overwrite_pages(path, [last])
    with open_recording(path) as recording:
        stamps_ns = [stamp_ns for _, stamp_ns, _ in recording.messages()]
        assert stamps_ns[-1] < small[-1].stamp_ns
        assert recording.end_ns == stamps_ns[-1]


def page_of(path: Path, number: int) -> bytes:
    return path.read_bytes()[(number - 1) * 4096 : number * 4096]


@pytest.mark.parametrize("is_whole", [True, False])
def test_rows_of_topics_that_the_database_does_not_name_are_missed(tmp_path: Path, *, is_whole: bool) -> None:
    path = storage_file(write_bag(tmp_path / "bag", MISSION))
    with closing(sqlite3.connect(path)) as database:
        database.execute("DELETE FROM topics WHERE name = '/scan'")
        late_ns = MISSION.messages[-1].stamp_ns + 10**12
        database.execute("INSERT INTO messages (topic_id, timestamp, data) VALUES (99, ?, x'00')", (late_ns,))
        database.commit()
    if not is_whole:
        overwrite_pages(path, [pages_of_messages(path)["index"]])
    known = [one for one in MISSION.messages if one.topic != "/scan"]
    homeless = len(MISSION.messages) - len(known) + 1
    for with_payloads in (True, False):
        with open_recording(path) as recording:
            assert len([*(recording.messages() if with_payloads else recording.sizes())]) == len(known)
            assert recording.end_ns == known[-1].stamp_ns
            assert recording.readable_share == len(known) / (len(known) + homeless)
            assert f"{homeless} messages of topics that the file does not name" in recording.notices()[-1]


@pytest.mark.parametrize("has_index", [True, False])
def test_what_is_behind_damage_in_a_chunk_without_checksum_is_missed(
    tmp_path: Path, *, has_index: bool
) -> None:
    folder = write_bag(tmp_path / "bag", MISSION, storage=StoragePlugin.MCAP)
    path = storage_file(folder)
    data = bytearray(path.read_bytes() if has_index else path.read_bytes()[:-8])
    message = data.index(MISSION.messages[len(MISSION.messages) // 2].payload)
    data[message - 31 : message] = b"\xaa" * 31
    path.write_bytes(data)
    read = read_bag(path)
    assert 0 < len(read.messages) < len(MISSION.messages)
    assert any("damaged chunks: 1; " in notice for notice in read.notices)


def test_a_message_that_does_not_decompress_costs_itself(tmp_path: Path) -> None:
    packed = write_bag(tmp_path / "bag", MISSION, compression=CompressionMode.MESSAGE)
    content = BagContent(MISSION.topics, tuple(read_stored(storage_file(packed))))
    third = content.messages[2]
    broken = BagMessage(third.topic, third.stamp_ns, third.payload[:-5])
    messages = (*content.messages[:2], broken, *content.messages[3:])
    path = write_bag(tmp_path / "broken", BagContent(MISSION.topics, messages))
    read = read_bag(path)
    assert read.messages == [*MISSION.messages[:2], *MISSION.messages[3:]]
    assert read.notices == [f"{third.topic}: 1 message that could not be decompressed was left out"]


def read_stored(path: Path) -> list[BagMessage]:
    with Reader(path) as reader:
        return [BagMessage(connection.topic, stamp, data) for connection, stamp, data in reader.messages()]


def test_messages_left_in_a_log_beside_the_database_are_named(tmp_path: Path) -> None:
    path = storage_file(write_bag(tmp_path / "bag", MISSION))
    with closing(sqlite3.connect(path)) as database:
        database.execute("PRAGMA journal_mode = WAL")
        database.execute("PRAGMA wal_autocheckpoint = 0")
        last_ns = MISSION.messages[-1].stamp_ns + 1
        database.execute("INSERT INTO messages (topic_id, timestamp, data) VALUES (1, ?, x'00')", (last_ns,))
        database.commit()
        read = read_bag(path)
    assert read.messages == [*MISSION.messages, BagMessage("/odom", last_ns, b"\x00")]
    whole = len(MISSION.messages)
    assert read.notices == [
        f"{path}: {TOGETHER}",
        f"its metadata count {whole} messages, {whole + 1} can be read; of /odom 100, 101 can be read",
    ]


@pytest.mark.parametrize("values", ["1, 'noon', x'00'", "1, 5, NULL", "1, 5, 'text'"])
def test_rows_of_the_wrong_types_cost_themselves(tmp_path: Path, values: str) -> None:
    path = storage_file(write_bag(tmp_path / "bag", MISSION))
    with closing(sqlite3.connect(path)) as database:
        database.execute("ALTER TABLE messages RENAME TO strict")
        database.execute("CREATE TABLE messages (id INTEGER PRIMARY KEY, topic_id, timestamp, data)")
        database.execute("INSERT INTO messages SELECT * FROM strict WHERE id % 2 = 0")
        database.execute("DROP TABLE strict")
        database.execute("DELETE FROM metadata")
        database.execute(f"INSERT INTO messages (topic_id, timestamp, data) VALUES ({values})")
        database.commit()
    read = read_bag(path)
    assert read.messages == list(MISSION.messages[1::2])
    assert len(read.notices) == 1


@pytest.fixture(scope="module", params=StoragePlugin, ids=str)
def tiny_file(request: pytest.FixtureRequest, tmp_path_factory: pytest.TempPathFactory) -> Path:
    folder = tmp_path_factory.mktemp("tiny")
    if request.param is StoragePlugin.MCAP:
        return write_mcap_file(folder / "tiny.mcap", small_mission(0.4), chunk_size=4000)
    return storage_file(write_bag(folder / "tiny", small_mission(0.4)))


@settings(max_examples=80)
@given(data=st.data())
def test_bytes_changed_at_random_raise_nothing_but_a_recording_error(
    tiny_file: Path, data: st.DataObject
) -> None:
    changed = bytearray(tiny_file.read_bytes())
    for _ in range(data.draw(st.integers(1, 6))):
        at = data.draw(st.integers(0, len(changed) - 1))
        junk = data.draw(st.binary(min_size=1, max_size=12))
        changed[at : at + len(junk)] = junk
    path = tiny_file.with_stem("changed")
    path.write_bytes(changed)
    read = read_or_refuse(path)
    if isinstance(read, RecordingError):
        assert "\n" not in str(read)
    else:
        assert len(read.messages) <= len(small_mission(0.4).messages)
