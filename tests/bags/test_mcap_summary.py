# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""The summary of an MCAP file is what mcap's own library reads, and damage in it is refused."""

from __future__ import annotations

import io
import struct
from contextlib import suppress
from pathlib import Path

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from mcap.reader import make_reader
from mcap.writer import CompressionType, IndexType, Writer

from bags.bag_factory import START_NS, small_mission, write_mcap_file
from smarttestudo.bags.mcap.record_bytes import StoredChannel
from smarttestudo.bags.mcap.summary import read_summary
from smarttestudo.bags.mcap.writer import McapWriter

MISSION = small_mission()


def assert_as_mcap_reads_it(data: bytes) -> None:
    ours, theirs = read_summary(io.BytesIO(data)), make_reader(io.BytesIO(data)).get_summary()
    if ours is None or theirs is None:
        assert (ours, theirs) == (None, None)
        return
    assert {number: (one.name, one.encoding, one.data) for number, one in ours.schemas.items()} == {
        number: (one.name, one.encoding, one.data) for number, one in theirs.schemas.items()
    }
    assert {
        number: (one.schema_id, one.topic, one.message_encoding, one.metadata)
        for number, one in ours.channels.items()
    } == {
        number: (one.schema_id, one.topic, one.message_encoding, one.metadata)
        for number, one in theirs.channels.items()
    }
    assert [
        (
            one.message_start_time,
            one.chunk_start_offset,
            one.chunk_length,
            len(one.indexed),
            one.message_index_length,
            one.compression,
            one.uncompressed_size,
        )
        for one in ours.chunks
    ] == [
        (
            one.message_start_time,
            one.chunk_start_offset,
            one.chunk_length,
            len(one.message_index_offsets),
            one.message_index_length,
            one.compression,
            one.uncompressed_size,
        )
        for one in theirs.chunk_indexes
    ]
    assert (ours.statistics is None) == (theirs.statistics is None)
    if ours.statistics is not None and theirs.statistics is not None:
        assert ours.statistics.message_count == theirs.statistics.message_count
        assert ours.statistics.message_start_time == theirs.statistics.message_start_time
        assert ours.statistics.message_end_time == theirs.statistics.message_end_time
        assert ours.statistics.channels == theirs.statistics.channel_message_counts


@pytest.mark.parametrize("compression", CompressionType)
@pytest.mark.parametrize("index_types", [IndexType.ALL, IndexType.NONE, IndexType.CHUNK, IndexType.MESSAGE])
@pytest.mark.parametrize("use_chunking", [True, False])
def test_of_files_by_mcap(
    tmp_path: Path, compression: CompressionType, index_types: IndexType, *, use_chunking: bool
) -> None:
    path = write_mcap_file(
        tmp_path / "mission.mcap",
        MISSION,
        compression=compression,
        index_types=index_types,
        use_chunking=use_chunking,
    )
    assert_as_mcap_reads_it(path.read_bytes())


def test_of_a_file_with_attachments_and_metadata() -> None:
    file = io.BytesIO()
    writer = Writer(file)
    writer.start(profile="ros2", library="test")
    writer.add_attachment(START_NS, START_NS, "a photo", "image/png", b"png")
    writer.add_metadata("rosbag2", {"serialized_metadata": "version: 9"})
    channel = writer.register_channel("/plain", "json", 0, {"note": "é", "empty": ""})
    writer.add_message(channel, START_NS, b"{}", START_NS)
    writer.finish()  # type: ignore[no-untyped-call]
    assert_as_mcap_reads_it(file.getvalue())


def test_of_a_file_by_us(tmp_path: Path) -> None:
    writer = McapWriter(tmp_path / "ours.mcap")
    channel = StoredChannel(topic="/scan", type_name="a/msg/A", definition="int8 a", digest="RIHS01_0")
    writer.add(channel)
    writer.write(channel, START_NS, b"payload")
    writer.close()
    assert_as_mcap_reads_it((tmp_path / "ours.mcap").read_bytes())


def written() -> bytes:
    file = io.BytesIO()
    writer = Writer(file, chunk_size=100)
    writer.start(profile="ros2", library="test")
    schema = writer.register_schema("a/msg/A", "ros2msg", b"int8 a")
    channel = writer.register_channel("/plain", "cdr", schema, {"note": "any"})
    for at in range(5):
        writer.add_message(channel, START_NS + at, bytes(60), START_NS + at)
    writer.finish()  # type: ignore[no-untyped-call]
    return file.getvalue()


WHOLE = written()
PLACES = st.integers(1, len(WHOLE)).map(lambda back: len(WHOLE) - back)


@settings(max_examples=300)
@given(
    changes=st.lists(st.tuples(PLACES, st.binary(min_size=1, max_size=8)), max_size=3),
    end=st.integers(0, len(WHOLE)) | st.just(len(WHOLE)),
)
def test_whatever_is_damaged_in_it_the_error_is_one_of_damage(
    changes: list[tuple[int, bytes]], end: int
) -> None:
    data = bytearray(WHOLE)
    for at, piece in changes:
        data[at : at + len(piece)] = piece
    with suppress(struct.error, ValueError, OSError):
        read_summary(io.BytesIO(data[:end]))
