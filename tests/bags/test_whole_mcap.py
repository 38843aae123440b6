# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""An MCAP file is read by its index as without it, and where the index lies, nothing is lost."""

from __future__ import annotations

import struct
from collections.abc import Callable
from contextlib import closing
from pathlib import Path

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from mcap.writer import CompressionType

from bags.bag_factory import (
    GRIPPER,
    ODOM,
    START_NS,
    BagContent,
    BagMessage,
    small_mission,
    write_mcap_file,
)
from bags.bag_reading import read_bag, read_with_mcap
from smarttestudo.bags import magic
from smarttestudo.bags.mcap.record_bytes import FRAME, Op, record_places
from smarttestudo.bags.mcap.recovered import RecoveredMcapFile
from smarttestudo.bags.mcap.whole_file import McapFile, full_index
from smarttestudo.bags.reader import open_recording

TOPICS = (ODOM, GRIPPER)
NAMES = tuple(topic.name for topic in TOPICS)
MISSION = small_mission()


def opened(path: Path) -> McapFile:
    index = full_index(path)
    assert index is not None
    return McapFile(path, index)


@settings(max_examples=60)
@given(
    entries=st.lists(
        st.tuples(st.sampled_from(NAMES), st.integers(0, 9), st.integers(0, 3000)), min_size=1, max_size=30
    ),
    compression=st.sampled_from(CompressionType),
    chunk_size=st.sampled_from((1, 500, 3000, 9000)),
    names=st.sets(st.sampled_from(NAMES), min_size=1),
)
def test_by_its_index_a_file_gives_what_it_gives_without(
    entries: list[tuple[str, int, int]],
    compression: CompressionType,
    chunk_size: int,
    names: set[str],
    tmp_path_factory: pytest.TempPathFactory,
) -> None:
    messages = tuple(
        BagMessage(topic, START_NS + stamp, bytes([place]) * size)
        for place, (topic, stamp, size) in enumerate(entries)
    )
    path = write_mcap_file(
        tmp_path_factory.mktemp("any") / "any.mcap",
        BagContent(TOPICS, messages),
        compression=compression,
        chunk_size=chunk_size,
    )
    with closing(opened(path)) as whole, closing(RecoveredMcapFile(path)) as walked:
        assert whole.channels == {number: walked.channels[number] for number in whole.channels}
        wanted = {number: one for number, one in whole.channels.items() if one.topic in names}
        read = list(whole.messages(wanted))
        assert read == list(walked.messages(wanted))
        stamps = [stamp_ns for _, stamp_ns, _ in read]
        assert stamps == sorted(stamps)
        by_mcap = [one for one in read_with_mcap(path) if one.topic in names]
        assert sorted((one.topic, stamp, data) for one, stamp, data in read) == sorted(
            (one.topic, one.stamp_ns, one.payload) for one in by_mcap
        )
        for file in (whole, walked):
            assert list(file.sizes(wanted)) == [(one, stamp_ns, len(data)) for one, stamp_ns, data in read]
        for head_bytes in (0, 7):
            assert list(whole.outlines(wanted, head_bytes)) == [
                (channel, stamp_ns, len(data), data[:head_bytes]) for channel, stamp_ns, data in read
            ]
        assert (whole.notices(), whole.readable_share) == ([], 1.0)


def _changed(path: Path, change: Callable[[bytearray, int], None]) -> None:
    """Change the third chunk index of a file; ``change`` has its bytes and where that begins."""
    data = bytearray(path.read_bytes())
    with path.open("rb") as file:
        records = record_places(file, len(magic.MCAP), len(data), 0)
        places = [start for op, start, *_ in records if op == Op.CHUNK_INDEX]
    change(data, places[2] + FRAME.size)
    path.write_bytes(data)


def _lies_about_its_first_stamp(data: bytearray, index: int) -> None:
    (stamp_ns,) = struct.unpack_from("<Q", data, index)
    struct.pack_into("<Q", data, index, stamp_ns + 10**9)


def _lies_about_its_place(data: bytearray, index: int) -> None:
    (start,) = struct.unpack_from("<Q", data, index + 16)
    struct.pack_into("<Q", data, index + 16, start + 5)


def _lies_about_its_place_by_far(data: bytearray, index: int) -> None:
    struct.pack_into("<Q", data, index + 16, 2**64 - 1)


def _lies_about_its_length(data: bytearray, index: int) -> None:
    struct.pack_into("<Q", data, index + 24, 2**62)


@pytest.mark.parametrize(
    "lie",
    [
        _lies_about_its_first_stamp,
        _lies_about_its_place,
        _lies_about_its_place_by_far,
        _lies_about_its_length,
    ],
)
@pytest.mark.parametrize("compression", [CompressionType.NONE, CompressionType.ZSTD])
def test_where_the_index_lies_all_messages_come(
    tmp_path: Path, lie: Callable[[bytearray, int], None], compression: CompressionType
) -> None:
    path = write_mcap_file(tmp_path / "mission.mcap", MISSION, compression=compression, chunk_size=4000)
    _changed(path, lie)
    read = read_bag(path).messages
    with open_recording(path) as recording:
        sizes = [(one.topic, stamp_ns, size) for one, stamp_ns, size in recording.sizes()]
    assert sizes == [(one.topic, one.stamp_ns, len(one.payload)) for one in read]
    if lie is _lies_about_its_first_stamp:
        # Messages of this chunk come late; to see that before would take a look at each chunk.
        read.sort(key=lambda one: one.stamp_ns)
    assert read == list(MISSION.messages)
