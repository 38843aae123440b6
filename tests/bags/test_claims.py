# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""Lists that a recording claims to hold are read once, however often it names or repeats a thing."""

from __future__ import annotations

import struct
from pathlib import Path

import pytest
from mcap.writer import CompressionType

from bags.bag_factory import small_mission, write_mcap_file
from bags.bag_reading import read_bag
from smarttestudo.bags.channel_reader import MAX_COMPARED, MergedChannels
from smarttestudo.bags.definitions import _types_in
from smarttestudo.bags.mcap.record_bytes import FRAME, Op, record
from smarttestudo.bags.mcap.summary import read_metadata
from smarttestudo.bags.mcap.whole_file import full_index
from smarttestudo.bags.metadata import embedded_metadata
from smarttestudo.bags.metadata import read_metadata as read_bag_metadata
from smarttestudo.domain.errors import RecordingError
from smarttestudo.domain.recording import Channel, Storage

MISSION = small_mission(1.0)


def test_an_index_that_names_a_chunk_a_hundred_times_gives_its_messages_once(tmp_path: Path) -> None:
    path = write_mcap_file(tmp_path / "bag.mcap", MISSION, compression=CompressionType.NONE)
    data = path.read_bytes()
    whole = full_index(path)
    assert whole is not None
    places = data.rindex(struct.pack("<Q", whole.chunks[0].chunk_start_offset))
    start = places - 16 - FRAME.size
    op, size_bytes = FRAME.unpack_from(data, start)
    assert op == Op.CHUNK_INDEX
    one = data[start : start + FRAME.size + size_bytes]
    footer = bytearray(data[-37:])
    footer[-12:-8] = bytes(4)
    path.write_bytes(data[:start] + one * 99 + data[start:-37] + bytes(footer))
    assert full_index(path) is None
    assert read_bag(path).messages == list(MISSION.messages)


def test_metadata_are_found_without_looking_into_chunks(tmp_path: Path) -> None:
    path = tmp_path / "bag.mcap"
    text = struct.pack("<I", 7) + b"rosbag2"
    entry = struct.pack("<I", 3) + b"key" + struct.pack("<I", 5) + b"value"
    # A chunk that any decompressor would fail on.
    chunk = record(Op.CHUNK, struct.pack("<QQQII4sQ", 0, 0, 1 << 40, 0, 4, b"zstd", 3) + b"???")
    metadata = record(Op.METADATA, text + struct.pack("<I", len(entry)) + entry)
    path.write_bytes(b"\x89MCAP0\r\n" + chunk + metadata)
    with path.open("rb") as file:
        assert read_metadata(file, "rosbag2") == {"key": "value"}
        assert read_metadata(file, "another") == {}
    assert embedded_metadata(path, Storage.MCAP) is None


METADATA = """
rosbag2_bagfile_information:
  relative_file_paths: [{path}]
  topics_with_message_count: [{{topic_metadata: {{name: {name}, type: a, serialization_format: cdr}}}}]
  storage_identifier: {storage}
  custom_data: {{key: {value}}}
"""


@pytest.mark.parametrize("place", ["path", "name", "storage", "value"])
def test_a_list_of_lists_of_aliases_is_no_text(tmp_path: Path, place: str) -> None:
    # Each is nine times as long as the one before.
    lists = "".join(f"a{level}: &a{level} [{f'*a{level - 1}, ' * 9}]\n" for level in range(1, 30))
    usual = dict.fromkeys(("path", "name", "storage", "value"), "text")
    text = METADATA.format(**{**usual, place: "*a29"})
    (tmp_path / "metadata.yaml").write_text(f"a0: &a0 [x]\n{lists}{text}")
    with pytest.raises(RecordingError, match="is broken"):
        read_bag_metadata(tmp_path)
    (tmp_path / "metadata.yaml").write_text(METADATA.format(**usual))
    assert read_bag_metadata(tmp_path).custom_data == {"key": "text"}


def test_the_definitions_of_a_topic_are_compared_with_a_few() -> None:
    channels = [
        Channel(
            topic="/a", type_name="a/msg/A", definition=f"float64 x{number}\n", serialization_format="cdr"
        )
        for number in range(200)
    ]
    before = _types_in.cache_info()
    merged = MergedChannels(channels)
    after = _types_in.cache_info()
    assert len(merged.all()) == len(channels)
    assert all(merged.of(channel) == channel for channel in channels)
    read = after.hits + after.misses - before.hits - before.misses
    assert read <= len(channels) * 2 * MAX_COMPARED
