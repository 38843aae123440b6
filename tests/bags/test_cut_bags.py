# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""Files that end too early: all that is whole in them is read, and what is not is said."""

from __future__ import annotations

import random
import sqlite3
import struct
from collections.abc import Iterator
from contextlib import closing, suppress
from dataclasses import replace
from pathlib import Path

import pytest
from mcap.exceptions import McapError
from mcap.reader import NonSeekingReader
from mcap.writer import CompressionType
from rosbags.rosbag2 import StoragePlugin

from bags.bag_factory import (
    KINDS,
    START_NS,
    BagContent,
    write_bag,
    write_mcap_file,
    write_split_bag,
)
from bags.bag_reading import read_bag
from bags.damaged_files import MISSION, assert_each_is_an_original_at_most_once, read_or_refuse, storage_file
from smarttestudo.bags.mcap.record_bytes import (
    ChunkPlace,
    Op,
    StoredChannel,
    channel_record,
    chunk_start,
    file_start,
    record,
    schema_record,
)
from smarttestudo.bags.reader import open_recording
from smarttestudo.domain.errors import RecordingError

NOTHING_LEFT = (
    "no rosbag2 topics can be found in it",
    "no part of it can be decompressed",
    "no message of the recording can be read",
    "messages can be read",
    "message can be read",
)
PERCENTS = range(5, 100, 5)


@pytest.fixture(scope="module", params=KINDS, ids=str)
def whole_file(request: pytest.FixtureRequest, tmp_path_factory: pytest.TempPathFactory) -> Path:
    storage, compression = request.param
    folder = tmp_path_factory.mktemp("whole") / "mission"
    return storage_file(write_bag(folder, MISSION, storage=storage, compression=compression))


@pytest.fixture(scope="module", params=["zstd", "lz4", "plain", "unchunked"])
def small_chunks(request: pytest.FixtureRequest, tmp_path_factory: pytest.TempPathFactory) -> Path:
    compression = {"zstd": CompressionType.ZSTD, "lz4": CompressionType.LZ4}.get(request.param)
    path = tmp_path_factory.mktemp("chunks") / "mission.mcap"
    return write_mcap_file(
        path,
        MISSION,
        compression=compression or CompressionType.NONE,
        use_chunking=request.param != "unchunked",
    )


def read_all_cuts(path: Path, folder: Path) -> list[int]:
    """How many messages each cut of ``path`` gives; each cut is checked."""
    data = path.read_bytes()
    counts: list[int] = []
    for percent in PERCENTS:
        cut = folder / path.name
        cut.write_bytes(data[: len(data) * percent // 100])
        read = read_or_refuse(cut)
        if isinstance(read, RecordingError):
            assert not counts or counts[-1] == 0
            assert read.cause.endswith(NOTHING_LEFT)
            counts.append(0)
            continue
        assert_each_is_an_original_at_most_once(read.messages)
        assert read.notices, f"cut at {percent} % without a word"
        assert all(notice.startswith(f"{cut}: ") for notice in read.notices)
        counts.append(len(read.messages))
    return counts


def test_a_file_cut_at_every_twentieth_gives_what_is_left_and_says_so(
    whole_file: Path, tmp_path: Path
) -> None:
    counts = read_all_cuts(whole_file, tmp_path)
    assert counts == sorted(counts)
    assert counts[-1] > 0.5 * len(MISSION.messages)


def cuts(path: Path, folder: Path) -> Iterator[Path]:
    """``path`` cut at every twentieth of its length, one after the other."""
    data = path.read_bytes()
    cut = folder / path.name
    for percent in PERCENTS:
        cut.write_bytes(data[: len(data) * percent // 100])
        yield cut


def found_by_sqlite(path: Path) -> set[tuple[int, bytes]]:
    """What SQLite reads of a cut file once it is told not to mind its length; some rows it makes up."""
    found = set()
    database = sqlite3.connect(f"file:{path}?immutable=1", uri=True)
    with closing(database), suppress(sqlite3.Error):
        database.execute("PRAGMA writable_schema = ON")
        for stamp_ns, payload in database.execute("SELECT timestamp, data FROM messages"):
            found.add((stamp_ns, payload))
    return found


def found_by_mcap(path: Path) -> set[tuple[int, bytes]]:
    """What mcap's reader for streams gives of a cut file until it raises."""
    found = set()
    with path.open("rb") as file, suppress(McapError, EOFError, struct.error):
        for _, _, message in NonSeekingReader(file).iter_messages(log_time_order=False):
            found.add((message.log_time, message.data))
    return found


def found_by_us(path: Path) -> set[tuple[int, bytes]]:
    read = read_or_refuse(path)
    messages = [] if isinstance(read, RecordingError) else read.messages
    return {(message.stamp_ns, message.payload) for message in messages}


@pytest.mark.parametrize("big_images", [False, True])
def test_a_cut_sqlite_file_gives_at_least_what_sqlite_finds_in_it(tmp_path: Path, big_images: bool) -> None:
    noise = random.Random(1)  # zeros would be made up as well as read
    few = tuple(
        replace(message, payload=noise.randbytes(len(message.payload)))
        for message in MISSION.messages
        if big_images or message.topic != "/image"
    )
    path = storage_file(write_bag(tmp_path / "bag", BagContent(MISSION.topics, few)))
    written = {(message.stamp_ns, message.payload) for message in few}
    for cut in cuts(path, tmp_path):
        found = found_by_sqlite(cut) & written
        assert found_by_us(cut) >= found
    assert len(found) > 0.5 * len(few)


def test_a_cut_mcap_file_gives_at_least_what_its_library_finds_in_it(
    small_chunks: Path, tmp_path: Path
) -> None:
    for cut in cuts(small_chunks, tmp_path):
        found = found_by_mcap(cut)
        assert found_by_us(cut) >= found
    assert len(found) > 0.5 * len(MISSION.messages)


def test_a_cut_sqlite_file_gives_nearly_its_share_of_the_messages(tmp_path: Path) -> None:
    counts = read_all_cuts(storage_file(write_bag(tmp_path / "bag", MISSION)), tmp_path)
    first_rows_at = 0.1  # the tables' own pages
    for percent, count in zip(PERCENTS, counts, strict=True):
        assert count >= (percent / 100 - first_rows_at) * len(MISSION.messages)


def test_a_cut_mcap_file_gives_the_whole_part_of_its_last_chunk_too(
    small_chunks: Path, tmp_path: Path
) -> None:
    counts = read_all_cuts(small_chunks, tmp_path)
    assert counts == sorted(counts)
    assert counts[-1] > 0.8 * len(MISSION.messages)


@pytest.mark.parametrize("storage", StoragePlugin)
def test_a_bag_whose_last_file_is_cut_and_that_has_no_metadata_is_read_as_far_as_it_goes(
    tmp_path: Path, storage: StoragePlugin
) -> None:
    half = len(MISSION.messages) // 2
    parts = [MISSION.between(0, half), MISSION.between(half, len(MISSION.messages))]
    folder = write_split_bag(tmp_path / "mission", parts, storage=storage)
    (folder / "metadata.yaml").unlink()
    last = max(folder.iterdir())
    last.write_bytes(last.read_bytes()[:-9000])
    read = read_bag(folder)
    assert_each_is_an_original_at_most_once(read.messages)
    assert read.messages[:half] == list(MISSION.messages[:half])
    assert len(read.messages) > half
    assert len(read.notices) == 2


@pytest.mark.parametrize("storage", StoragePlugin)
def test_a_cut_bag_of_simulated_time_starts_at_zero(tmp_path: Path, storage: StoragePlugin) -> None:
    messages = tuple(replace(one, stamp_ns=one.stamp_ns - START_NS) for one in MISSION.messages)
    path = storage_file(write_bag(tmp_path / "bag", BagContent(MISSION.topics, messages), storage=storage))
    path.write_bytes(path.read_bytes()[: path.stat().st_size // 2])
    with open_recording(path) as recording:
        assert recording.start_ns == 0


@pytest.mark.parametrize("size_bytes", [8, 9, 30, 36, 37, 60])
def test_of_a_file_that_ends_in_its_header_nothing_can_be_read(tmp_path: Path, size_bytes: int) -> None:
    path = write_mcap_file(tmp_path / "short.mcap", MISSION)
    path.write_bytes(path.read_bytes()[:size_bytes])
    read = read_or_refuse(path)
    assert isinstance(read, RecordingError)
    assert read.cause.endswith(NOTHING_LEFT)


@pytest.mark.parametrize("has_schema", [True, False])
@pytest.mark.parametrize("in_chunk", [True, False])
def test_a_cut_file_may_have_its_schema_behind_its_channel_or_nowhere(
    tmp_path: Path, *, has_schema: bool, in_chunk: bool
) -> None:
    channel = StoredChannel(topic="/odom", type_name="nav_msgs/msg/Odometry", definition="float64 x\n")
    message = record(Op.MESSAGE, struct.pack("<HIQQ", 1, 0, START_NS, START_NS) + b"payload")
    records = channel_record(1, 7, channel) + message
    if has_schema:
        records += schema_record(7, channel.schema)
    if in_chunk:
        records = chunk_start(ChunkPlace(start=0, record_bytes=len(records))) + records
    path = tmp_path / "cut.mcap"
    path.write_bytes(file_start() + records + b"\x05\x99")
    with open_recording(path) as recording:
        ((read, _, payload),) = recording.messages()
        assert payload == b"payload"
        assert (read.topic, read.type_name) == ("/odom", channel.type_name if has_schema else "")
        assert read.definition == (channel.definition if has_schema else None)
        lacks = f"{path}: /odom: the file has no schema for it, so its type is not known"
        assert (lacks in recording.notices()) != has_schema
