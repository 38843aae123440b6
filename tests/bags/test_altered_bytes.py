# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""Bytes of an MCAP file that were altered since it was written: none of them is taken for a message."""

from __future__ import annotations

import zlib
from pathlib import Path

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from mcap.reader import make_reader
from mcap.stream_reader import CRCValidationError
from mcap.writer import CompressionType

from bags.bag_factory import BagMessage, small_mission, write_mcap_file
from bags.bag_reading import read_bag
from bags.damaged_files import assert_each_is_an_original_at_most_once, read_or_refuse
from smarttestudo.bags.mcap.record_bytes import StoredChannel
from smarttestudo.bags.mcap.summary import read_summary
from smarttestudo.bags.mcap.writer import McapWriter
from smarttestudo.domain.errors import RecordingError

MISSION = small_mission()
TYPES = {topic.name: topic.type_name for topic in MISSION.topics}


def written_by_us(path: Path, messages: tuple[BagMessage, ...] = MISSION.messages) -> Path:
    writer = McapWriter(path)
    for one in messages:
        channel = StoredChannel(topic=one.topic, type_name=TYPES[one.topic], definition="float64 data")
        writer.write(channel, one.stamp_ns, one.payload)
    writer.close()
    return path


@pytest.fixture(scope="module", params=["rosbag2", "ours"])
def file(request: pytest.FixtureRequest, tmp_path_factory: pytest.TempPathFactory) -> Path:
    path = tmp_path_factory.mktemp("whole") / "mission.mcap"
    if request.param == "ours":
        return written_by_us(path)
    return write_mcap_file(path, MISSION, compression=CompressionType.NONE, chunk_size=20_000)


@settings(max_examples=60)
@given(place=st.floats(0, 1, exclude_max=True), bit=st.integers(0, 7))
def test_a_bit_anywhere_makes_no_other_message(
    place: float, bit: int, file: Path, tmp_path_factory: pytest.TempPathFactory
) -> None:
    data = bytearray(file.read_bytes())
    data[int(place * len(data))] ^= 1 << bit
    path = tmp_path_factory.mktemp("altered") / "mission.mcap"
    path.write_bytes(data)
    read = read_or_refuse(path)
    if isinstance(read, RecordingError):
        return
    assert_each_is_an_original_at_most_once(read.messages)
    assert len(read.messages) == len(MISSION.messages) or read.notices


def test_an_altered_message_is_not_read_and_said(file: Path, tmp_path: Path) -> None:
    data = bytearray(file.read_bytes())
    payload = MISSION.messages[len(MISSION.messages) // 2].payload
    data[data.index(payload) + len(payload) // 2] ^= 1
    (tmp_path / "mission.mcap").write_bytes(data)
    read = read_bag(tmp_path / "mission.mcap")
    assert_each_is_an_original_at_most_once(read.messages)
    assert len(read.messages) < len(MISSION.messages)
    assert any("damaged chunks: 1; " in notice for notice in read.notices)


def test_a_topic_whose_name_was_altered_in_the_index_keeps_its_name(file: Path, tmp_path: Path) -> None:
    data = bytearray(file.read_bytes())
    data[data.rindex(b"/odom") + 1] ^= 1
    path = tmp_path / "mission.mcap"
    path.write_bytes(data)
    assert read_bag(path).messages == read_bag(file).messages


def test_what_we_write_has_the_checksums_that_mcap_looks_for(tmp_path: Path) -> None:
    path = written_by_us(tmp_path / "mission.mcap")
    with path.open("rb") as opened:
        summary = read_summary(opened)
        assert summary is not None
        opened.seek(0)
        read = [*make_reader(opened, validate_crcs=True).iter_messages()]
    assert len(read) == len(MISSION.messages)
    data = bytearray(path.read_bytes())
    for chunk in summary.chunks:
        start, end = chunk.chunk_start_offset, chunk.chunk_start_offset + chunk.chunk_length
        records = data[end - chunk.uncompressed_size : end]
        assert int.from_bytes(data[start + 33 : start + 37], "little") == zlib.crc32(records)
    data[data.index(MISSION.messages[0].payload) + 9] ^= 1
    path.write_bytes(data)
    with path.open("rb") as opened, pytest.raises(CRCValidationError):
        list(make_reader(opened, validate_crcs=True).iter_messages())


def test_a_chunk_that_says_to_be_endless_is_read_by_its_record(file: Path, tmp_path: Path) -> None:
    data = bytearray(file.read_bytes())
    with file.open("rb") as stream:
        summary = make_reader(stream).get_summary()
    assert summary is not None
    records_length = summary.chunk_indexes[0].chunk_start_offset + 9 + 32
    data[records_length : records_length + 8] = (1 << 63).to_bytes(8, "little")
    path = tmp_path / "mission.mcap"
    path.write_bytes(data)
    assert len(read_bag(path).messages) == len(MISSION.messages)
