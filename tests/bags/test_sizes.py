# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""Sizes without payloads are those of a full read, whatever holds the messages."""

from __future__ import annotations

import sqlite3
from collections import defaultdict
from collections.abc import Iterator
from contextlib import closing
from pathlib import Path

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from mcap.writer import CompressionType, IndexType
from rosbags.rosbag2 import StoragePlugin

from bags.bag_factory import (
    GRIPPER,
    KINDS,
    ODOM,
    START_NS,
    BagContent,
    BagMessage,
    small_mission,
    write_bag,
    write_humble_file,
    write_mcap_file,
)
from smarttestudo.bags.measure import measure_bag
from smarttestudo.bags.reader import open_recording
from smarttestudo.bags.statistics import RecordingSpan, TraceAccumulator, topic_statistics
from smarttestudo.domain.errors import RecordingError
from smarttestudo.domain.rate_meter import Intervals

MISSION = small_mission()
Size = tuple[str, int, int]


def sizes_and_notices(path: Path) -> tuple[list[Size], list[str]]:
    with open_recording(path) as recording:
        sizes = [(channel.topic, stamp_ns, size) for channel, stamp_ns, size in recording.sizes()]
        return sizes, list(recording.notices())


def counted_in_full(path: Path) -> tuple[list[Size], list[str]]:
    with open_recording(path) as recording:
        sizes = [
            (channel.topic, stamp_ns, len(payload)) for channel, stamp_ns, payload in recording.messages()
        ]
        return sizes, list(recording.notices())


def written(content: BagContent) -> list[Size]:
    return [(message.topic, message.stamp_ns, len(message.payload)) for message in content.messages]


def test_every_kind_of_bag_is_measured_as_message_by_message(bag: Path) -> None:
    traces: dict[str, TraceAccumulator] = defaultdict(TraceAccumulator)
    intervals: dict[str, Intervals] = defaultdict(Intervals)
    with open_recording(bag) as recording:
        span = RecordingSpan(start_ns=recording.start_ns, end_ns=recording.end_ns)
        for channel, stamp_ns, payload in recording.messages():
            traces[channel.topic].add(stamp_ns, len(payload))
            intervals[channel.topic].record(stamp_ns)
    summary = measure_bag(bag, lambda _: None)
    assert {one.name for one in summary.topics} == set(traces)
    for one in summary.topics:
        assert one.statistics == topic_statistics(traces[one.name], span)
        assert (one.longest_gap_s, one.jitter_s) == (
            intervals[one.name].longest_s,
            intervals[one.name].jitter_s,
        )


def test_every_kind_of_bag_gives_the_sizes_that_were_written(bag: Path) -> None:
    assert sizes_and_notices(bag) == (written(MISSION), [])


@pytest.fixture(scope="module", params=KINDS, ids=str)
def whole_file(request: pytest.FixtureRequest, tmp_path_factory: pytest.TempPathFactory) -> Path:
    storage, compression = request.param
    folder = write_bag(
        tmp_path_factory.mktemp("whole") / "mission", MISSION, storage=storage, compression=compression
    )
    return next(path for path in folder.iterdir() if path.name != "metadata.yaml")


def cuts(path: Path) -> Iterator[bytes]:
    data = path.read_bytes()
    return (data[: len(data) * percent // 100] for percent in range(5, 100, 5))


@pytest.mark.full
def test_a_bag_cut_at_every_twentieth_gives_the_sizes_of_a_full_read(
    whole_file: Path, tmp_path: Path
) -> None:
    cut = tmp_path / whole_file.name
    for data in cuts(whole_file):
        cut.write_bytes(data)
        try:
            full = counted_in_full(cut)
        except RecordingError:
            with pytest.raises(RecordingError):
                sizes_and_notices(cut)
        else:
            assert sizes_and_notices(cut) == full


@pytest.mark.parametrize("compression", CompressionType)
@pytest.mark.parametrize("repeat_channels", [True, False])
@pytest.mark.parametrize("use_chunking", [True, False])
@pytest.mark.parametrize("index_types", [IndexType.ALL, IndexType.NONE, IndexType.CHUNK])
def test_every_way_to_write_an_mcap_file_gives_the_sizes_that_were_written(
    tmp_path: Path,
    compression: CompressionType,
    repeat_channels: bool,
    use_chunking: bool,
    index_types: IndexType,
) -> None:
    path = write_mcap_file(
        tmp_path / "mission.mcap",
        MISSION,
        compression=compression,
        repeat_channels=repeat_channels,
        use_chunking=use_chunking,
        index_types=index_types,
    )
    assert sizes_and_notices(path)[0] == written(MISSION)


def test_a_bag_of_humble_gives_the_sizes_that_were_written(tmp_path: Path) -> None:
    assert sizes_and_notices(write_humble_file(tmp_path / "humble.db3", MISSION))[0] == written(MISSION)


# Chunks of small records are read at once, those of large ones hopped over.
payload_bytes = st.integers(0, 1000) | st.integers(4000, 12_000)


@settings(max_examples=60)
@given(
    entries=st.lists(
        st.tuples(st.sampled_from([ODOM.name, GRIPPER.name]), st.integers(0, 9), payload_bytes),
        min_size=1,
        max_size=30,
    ),
    storage=st.sampled_from(["sqlite3", "plain", "zstd"]),
)
def test_messages_in_any_order_of_any_size_are_counted_as_a_full_read_does(
    entries: list[tuple[str, int, int]], storage: str, tmp_path_factory: pytest.TempPathFactory
) -> None:
    messages = tuple(BagMessage(topic, START_NS + s, bytes(size)) for topic, s, size in entries)
    content = BagContent((ODOM, GRIPPER), messages)
    folder = tmp_path_factory.mktemp("any")
    if storage == "sqlite3":
        path = write_humble_file(folder / "any.db3", content)
    else:
        compression = CompressionType.ZSTD if storage == "zstd" else CompressionType.NONE
        path = write_mcap_file(folder / "any.mcap", content, compression=compression, chunk_size=3000)
    assert sizes_and_notices(path) == counted_in_full(path)


@pytest.mark.parametrize("storage", StoragePlugin)
def test_payloads_are_left_unread(tmp_path: Path, storage: StoragePlugin) -> None:
    folder = write_bag(tmp_path / "bag", MISSION, storage=storage)
    path = next(path for path in folder.iterdir() if path.name != "metadata.yaml")
    data = path.read_bytes()
    image = data.index(bytes([7]) * 4000)
    path.write_bytes(data[: image - 4] + b"\xff" * 4000 + data[image + 3996 :])
    assert sizes_and_notices(folder) == (written(MISSION), [])


@pytest.mark.parametrize("values", ["1, 'noon', x'00'", "1, 5, NULL", "1, 5, 'text'"])
def test_rows_of_the_wrong_types_cost_themselves(tmp_path: Path, values: str) -> None:
    folder = write_bag(tmp_path / "bag", MISSION)
    path = folder / "bag.db3"
    with closing(sqlite3.connect(path)) as database:
        database.execute("ALTER TABLE messages RENAME TO strict")
        database.execute("CREATE TABLE messages (id INTEGER PRIMARY KEY, topic_id, timestamp, data)")
        database.execute("INSERT INTO messages SELECT * FROM strict WHERE id % 2 = 0")
        database.execute("DROP TABLE strict")
        database.execute(f"INSERT INTO messages (topic_id, timestamp, data) VALUES ({values})")
        database.commit()
    assert sizes_and_notices(path) == counted_in_full(path)


def test_a_chunk_whose_records_make_no_sense_is_read_in_full(tmp_path: Path) -> None:
    path = write_mcap_file(tmp_path / "mission.mcap", MISSION, compression=CompressionType.NONE)
    data = bytearray(path.read_bytes())
    image = data.index(bytes([7]) * 5000)
    length = data.rindex((9000).to_bytes(4, "little"), 0, image) - 300
    data[length : length + 300] = b"\xff" * 300
    path.write_bytes(data)
    sizes, notices = sizes_and_notices(path)
    assert (sizes, notices) == counted_in_full(path)
    assert 0.5 * len(MISSION.messages) < len(sizes) < len(MISSION.messages)
    assert len(notices) == 1
