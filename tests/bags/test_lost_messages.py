# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""Nothing of a recording is lost without a word: what is read is what was written, or a notice says more."""

from __future__ import annotations

import random
import sqlite3
import struct
from collections import Counter
from collections.abc import Callable
from contextlib import closing, suppress
from dataclasses import dataclass
from pathlib import Path

import lz4.frame  # type: ignore[import-untyped]
import pytest
import zstandard
from hypothesis import given, settings
from hypothesis import strategies as st
from mcap.reader import NonSeekingReader
from mcap.writer import CompressionType
from rosbags.rosbag2 import CompressionMode, StoragePlugin

from bags.bag_factory import (
    BagContent,
    BagMessage,
    small_mission,
    write_bag,
    write_humble_file,
    write_mcap_file,
)
from bags.damaged_files import storage_file
from smarttestudo.bags import magic
from smarttestudo.bags.mcap.record_bytes import (
    FRAME,
    ChunkPlace,
    Op,
    StoredChannel,
    channel_record,
    chunk_index,
    chunk_start,
    file_end,
    file_start,
    message_index,
    record,
    record_places,
    schema_record,
    statistics,
)
from smarttestudo.bags.metadata import MessageCounts
from smarttestudo.bags.reader import open_recording
from smarttestudo.domain.errors import RecordingError

MISSION = small_mission(0.4)
STORED = {
    topic.name: StoredChannel(topic=topic.name, type_name=topic.type_name, definition="float64 x\n")
    for topic in MISSION.topics
}
NUMBERS = {name: number for number, name in enumerate(STORED, start=1)}
ANNOUNCED = b"".join(
    schema_record(NUMBERS[name], channel.schema) + channel_record(NUMBERS[name], NUMBERS[name], channel)
    for name, channel in STORED.items()
)
Read = Counter[tuple[str, int, bytes]]
WRITTEN: Read = Counter((one.topic, one.stamp_ns, one.payload) for one in MISSION.messages)


def message_record(message: BagMessage) -> bytes:
    header = struct.pack("<HIQQ", NUMBERS[message.topic], 0, message.stamp_ns, message.stamp_ns)
    return record(Op.MESSAGE, header + message.payload)


RECORDS = [message_record(message) for message in MISSION.messages]


def chunk_of(content: bytes, compression: str = "", packed: bytes | None = None) -> bytes:
    name = compression.encode()
    data = content if packed is None else packed
    head = struct.pack("<QQQII", 0, 1 << 62, len(content), 0, len(name)) + name + struct.pack("<Q", len(data))
    return record(Op.CHUNK, head + data)


def file_of(*parts: bytes) -> bytes:
    end = record(Op.DATA_END, bytes(4)) + record(Op.FOOTER, bytes(20)) + b"\x89MCAP0\r\n"
    return file_start() + b"".join(parts) + end


@dataclass(frozen=True)
class Reading:
    messages: Read
    is_whole: bool


def read(path: Path) -> Reading | None:
    """The messages of ``path``, the same by sizes; ``None`` where it is refused."""
    try:
        with open_recording(path) as recording:
            sizes = Counter((one.topic, stamp_ns, size) for one, stamp_ns, size in recording.sizes())
            sizes_are_whole = recording.readable_share == 1 and not recording.notices()
        with open_recording(path) as recording:
            messages = Counter(
                (one.topic, stamp_ns, bytes(data)) for one, stamp_ns, data in recording.messages()
            )
            is_whole = recording.readable_share == 1 and not recording.notices()
    except RecordingError:
        return None
    if sizes_are_whole and is_whole:
        assert sizes == Counter((topic, stamp_ns, len(data)) for topic, stamp_ns, data in messages.elements())
    return Reading(messages, is_whole)


def by_another_reader(path: Path) -> Read:
    """What mcap's reader of streams, or SQLite, gets of ``path`` until it raises."""
    found: Read = Counter()
    if path.suffix == ".zstd":
        unpacked = path.with_suffix("")
        with suppress(zstandard.ZstdError), path.open("rb") as packed, unpacked.open("wb") as file:
            zstandard.ZstdDecompressor().copy_stream(packed, file)
        return by_another_reader(unpacked)
    with suppress(Exception):
        if path.suffix == ".mcap":
            with path.open("rb") as file:
                for _, channel, message in NonSeekingReader(file).iter_messages(log_time_order=False):
                    found[channel.topic, message.log_time, message.data] += 1
        else:
            with closing(sqlite3.connect(f"file:{path}?immutable=1", uri=True)) as database:
                found.update(
                    database.execute(
                        "SELECT name, timestamp, data FROM messages JOIN topics ON topics.id = topic_id"
                    )
                )
    return found


BESIDE = {
    "before": lambda: (ANNOUNCED, RECORDS[0], chunk_of(b"".join(RECORDS[1:]))),
    "after": lambda: (ANNOUNCED, chunk_of(b"".join(RECORDS[1:])), RECORDS[0]),
    "between": lambda: (
        chunk_of(ANNOUNCED + b"".join(RECORDS[:5])),
        RECORDS[5],
        chunk_of(b"".join(RECORDS[6:])),
    ),
}


@pytest.mark.parametrize("place", BESIDE)
def test_messages_beside_chunks_are_read(tmp_path: Path, place: str) -> None:
    path = tmp_path / "beside.mcap"
    path.write_bytes(file_of(*BESIDE[place]()))
    assert read(path) == Reading(WRITTEN, is_whole=True)


def test_messages_of_a_channel_that_nobody_describes_are_missing(tmp_path: Path) -> None:
    path, channel_at = tmp_path / "homeless.mcap", FRAME.size
    homeless = [one[:channel_at] + struct.pack("<H", 99) + one[channel_at + 2 :] for one in RECORDS]
    path.write_bytes(file_of(ANNOUNCED, *RECORDS, *homeless))
    with open_recording(path) as recording:
        assert (recording.message_count, recording.readable_share) == (len(RECORDS), 0.5)


def indexed_file(outside: int, counted: int) -> bytes:
    """A file whose summary names one chunk, and counts ``counted`` of the ``outside`` messages behind it."""
    data = file_start() + ANNOUNCED
    chunk, content = ChunkPlace(start=len(data)), b""
    for message, stored in zip(MISSION.messages[outside:], RECORDS[outside:], strict=True):
        chunk.note(NUMBERS[message.topic], message.stamp_ns, len(content))
        content += stored
    chunk.record_bytes = len(content)
    data += chunk_start(chunk) + content
    for channel, stamps in chunk.stamps.items():
        chunk.indexes[channel] = len(data)
        data += message_index(channel, stamps)
    chunk.index_bytes = len(data) - chunk.start - len(chunk_start(chunk)) - len(content)
    data += b"".join(RECORDS[:outside]) + record(Op.DATA_END, bytes(4))
    counts = Counter(NUMBERS[one.topic] for one in (*MISSION.messages[outside:], *MISSION.messages[:counted]))
    groups = (
        (Op.SCHEMA, ANNOUNCED),
        (Op.CHUNK_INDEX, chunk_index(chunk)),
        (Op.STATISTICS, statistics(counts, schemas=len(STORED), chunks=[chunk])),
    )
    return data + file_end(len(data), groups)


@pytest.mark.parametrize(("outside", "counted"), [(0, 0), (3, 3), (3, 0), (3, 5), (0, 2)])
def test_messages_that_the_index_does_not_name_are_read(tmp_path: Path, outside: int, counted: int) -> None:
    path = tmp_path / "indexed.mcap"
    path.write_bytes(indexed_file(outside, counted))
    assert read(path) == Reading(WRITTEN, is_whole=outside == counted)


def packed_in_frames(compression: str, frames: int) -> bytes:
    content = ANNOUNCED + b"".join(RECORDS)
    size = -(-len(content) // frames)
    pieces = [content[at : at + size] for at in range(0, len(content), size)]
    pack: Callable[[bytes], bytes] = zstandard.compress if compression == "zstd" else lz4.frame.compress
    return chunk_of(content, compression, b"".join(map(pack, pieces)))


@pytest.mark.parametrize("frames", [1, 2, 7])
@pytest.mark.parametrize("compression", ["zstd", "lz4"])
def test_all_frames_of_a_chunk_are_read(tmp_path: Path, compression: str, frames: int) -> None:
    path = tmp_path / "frames.mcap"
    path.write_bytes(file_of(packed_in_frames(compression, frames)))
    assert read(path) == Reading(WRITTEN, is_whole=True)
    # What a chunk says that it holds is compared with what it does.
    short = bytearray(packed_in_frames(compression, frames))
    (size,) = struct.unpack_from("<Q", short, FRAME.size + 16)
    struct.pack_into("<Q", short, FRAME.size + 16, size + 1)
    path.write_bytes(file_of(bytes(short)))
    assert read(path) == Reading(WRITTEN, is_whole=False)


@pytest.mark.parametrize("op", [0, 2, 7, 0x10, 0x7F, 0x80, 0xFF])
@pytest.mark.parametrize("size_bytes", [0, 50])
def test_what_a_chunk_may_not_hold_is_damage(tmp_path: Path, op: int, size_bytes: int) -> None:
    odd = FRAME.pack(op, size_bytes) + bytes(size_bytes)
    path = tmp_path / "odd.mcap"
    path.write_bytes(file_of(chunk_of(ANNOUNCED + b"".join(RECORDS[:4]) + odd + b"".join(RECORDS[4:]))))
    found = read(path)
    assert found is not None
    assert not found.is_whole
    assert found.messages <= WRITTEN


@pytest.mark.parametrize(("op", "is_whole"), [(0, False), (0x10, False), (0x7F, False), (0x80, True)])
def test_of_unknown_records_beside_chunks_those_of_applications_are_no_loss(
    tmp_path: Path, op: int, *, is_whole: bool
) -> None:
    path = tmp_path / "odd.mcap"
    odd = FRAME.pack(op, 9) + bytes(9)
    path.write_bytes(file_of(ANNOUNCED, *RECORDS[:4], odd, *RECORDS[4:]))
    found = read(path)
    assert found is not None
    assert found.is_whole == is_whole
    assert found.messages == WRITTEN if op else found.messages < WRITTEN


def test_a_length_that_swallows_its_neighbours_is_damage(tmp_path: Path) -> None:
    zeros = record(Op.MESSAGE, RECORDS[0][FRAME.size : FRAME.size + 22] + bytes(900))
    content = bytearray(ANNOUNCED + b"".join((*RECORDS[:4], zeros, *RECORDS[4:])))
    at = len(ANNOUNCED) + sum(map(len, RECORDS[:3]))
    path = tmp_path / "swallowed.mcap"
    for more in range(9, 1000, 9):
        (size,) = struct.unpack_from("<Q", RECORDS[3], 1)
        struct.pack_into("<Q", content, at + 1, size + more)
        path.write_bytes(file_of(chunk_of(bytes(content))))
        found = read(path)
        assert found is not None
        assert not found.is_whole, f"swallowed {more} bytes"


@pytest.mark.parametrize("is_doubled", [True, False])
@pytest.mark.parametrize("use_chunking", [True, False])
def test_records_that_were_removed_or_doubled_are_missed(
    tmp_path: Path, *, is_doubled: bool, use_chunking: bool
) -> None:
    whole = write_mcap_file(tmp_path / "whole.mcap", MISSION, chunk_size=1000, use_chunking=use_chunking)
    data, path = whole.read_bytes(), tmp_path / "other.mcap"
    with whole.open("rb") as file:
        places = [*record_places(file, len(magic.MCAP), len(data), 0)]
    kinds = {Op.MESSAGE, Op.CHUNK, Op.MESSAGE_INDEX, Op.CHUNK_INDEX, Op.STATISTICS}
    for op, start, end, _ in places:
        if op in kinds:
            more = data[start:end] * 2 if is_doubled else b""
            path.write_bytes(data[:start] + more + data[end:])
            found = read(path)
            assert found is not None
            if op in {Op.MESSAGE, Op.CHUNK}:
                assert not found.is_whole
            else:
                assert found.messages == WRITTEN


def test_the_number_of_a_channel_that_was_altered_is_missed(tmp_path: Path) -> None:
    whole = write_mcap_file(tmp_path / "whole.mcap", MISSION, compression=CompressionType.NONE)
    data, path = bytearray(whole.read_bytes()), tmp_path / "altered.mcap"
    with whole.open("rb") as file:
        places = record_places(file, len(magic.MCAP), len(data), 0, enters_chunks=True)
        chunks = [start for op, start, *_ in places if op == Op.CHUNK]
        message = data.index(RECORDS[5][FRAME.size + 6 :]) - 6
    for start in chunks:
        data[start + FRAME.size + 24 : start + FRAME.size + 28] = bytes(4)
    for number in (*NUMBERS.values(), 99):
        is_altered = data[message : message + 2] != number.to_bytes(2, "little")
        path.write_bytes(data[:message] + number.to_bytes(2, "little") + data[message + 2 :])
        found = read(path)
        assert found is not None
        assert found.is_whole != is_altered


def test_what_comes_behind_the_end_is_said(tmp_path: Path) -> None:
    whole = write_mcap_file(tmp_path / "one.mcap", MISSION).read_bytes()
    (tmp_path / "two.mcap").write_bytes(whole + whole)
    found = read(tmp_path / "two.mcap")
    assert found is not None
    assert not found.is_whole
    assert found.messages == WRITTEN


def test_metadata_that_count_more_messages_than_there_are_say_so(tmp_path: Path) -> None:
    for storage in StoragePlugin:
        folder = write_bag(tmp_path / storage.name, MISSION, storage=storage)
        metadata = folder / "metadata.yaml"
        count = len(MISSION.messages)
        for said, share in ((2 * count, 0.5), (count - 1, 1.0), (0, 1.0)):
            text = metadata.read_text()
            metadata.write_text(
                text.replace(f"message_count: {count}\n  rel", f"message_count: {said}\n  rel")
            )
            with open_recording(folder) as recording:
                assert len([*recording.messages()]) == count
                note = f"its metadata count {said} messages, {count} can be read"
                assert recording.notices() == ([note] if said else [])
                assert recording.readable_share == share
            metadata.write_text(text)


@pytest.mark.parametrize("which", ["id % 2", "id < 9", "id > 9", "topic_id = 1", "id = 4"])
@pytest.mark.parametrize("has_metadata", [True, False])
def test_rows_that_were_deleted_are_missed(tmp_path: Path, which: str, *, has_metadata: bool) -> None:
    path = storage_file(write_bag(tmp_path / "bag", MISSION))
    with closing(sqlite3.connect(path)) as database:
        database.execute(f"DELETE FROM messages WHERE {which}")
        if not has_metadata:
            database.execute("DELETE FROM metadata")
        database.commit()
    found = read(path)
    assert found is not None
    assert found.messages == by_another_reader(path)
    # Nothing tells of the last ones of a file without metadata.
    assert found.is_whole == (which == "id > 9" and not has_metadata)


@pytest.mark.parametrize("has_metadata", [True, False])
def test_rows_that_were_deleted_are_said_once(tmp_path: Path, *, has_metadata: bool) -> None:
    folder = write_bag(tmp_path / "bag", MISSION)
    path = storage_file(folder)
    with closing(sqlite3.connect(path)) as database:
        database.execute("DELETE FROM messages WHERE id = 4")
        database.execute("DELETE FROM metadata")
        database.commit()
    if not has_metadata:
        (folder / "metadata.yaml").unlink()
    with open_recording(folder if has_metadata else path) as recording:
        (notice,) = recording.notices()
    count = len(MISSION.messages)
    expected = (
        f"its metadata count {count} messages, {count - 1} can be read; of /"
        if has_metadata
        else f"{path}: 1 row is not there: deleted, or lost"
    )
    assert notice.startswith(expected)


@pytest.mark.parametrize("name", ["messages", "timestamp_idx"])
@pytest.mark.parametrize(
    "damage", [b"\0", b"\xaa", b"\x0d" + bytes(11), b"\x0a" + bytes(11), b"\x05" + bytes(11)]
)
@pytest.mark.parametrize("seconds", [0.1, 4])
def test_a_database_whose_root_is_lost_is_not_read_as_empty(
    tmp_path: Path, name: str, damage: bytes, seconds: float
) -> None:
    mission = small_mission(seconds)
    path = write_humble_file(tmp_path / "humble.db3", mission)
    with closing(sqlite3.connect(path)) as database:
        query = "SELECT rootpage FROM sqlite_master WHERE name = ?"
        ((root,),) = database.execute(query, (name,))
    data = bytearray(path.read_bytes())
    data[(root - 1) * 4096 : root * 4096] = damage * (4096 // len(damage)) + bytes(4096 % len(damage))
    path.write_bytes(data)
    found = read(path)
    assert found is None or not found.is_whole


def noisy(content: BagContent) -> BagContent:
    noise = random.Random(1)
    messages = (
        BagMessage(one.topic, one.stamp_ns, one.payload[:40] + noise.randbytes(60) + bytes(200 * (at % 5)))
        for at, one in enumerate(content.messages)
    )
    return BagContent(content.topics, tuple(messages))


FUZZED = noisy(small_mission(0.6))
FUZZED_WRITTEN: Read = Counter((one.topic, one.stamp_ns, one.payload) for one in FUZZED.messages)


@dataclass(frozen=True)
class Kind:
    suffix: str
    data: bytes
    has_checksums: bool = False


@pytest.fixture(scope="module")
def kinds(tmp_path_factory: pytest.TempPathFactory) -> list[Kind]:
    folder = tmp_path_factory.mktemp("kinds")
    made = []
    for compression in CompressionType:
        path = write_mcap_file(
            folder / f"{compression.name}.mcap", FUZZED, compression=compression, chunk_size=2000
        )
        made.append(Kind(".mcap", path.read_bytes(), has_checksums=True))
    path = write_mcap_file(folder / "unchunked.mcap", FUZZED, use_chunking=False)
    made.append(Kind(".mcap", path.read_bytes()))
    made.append(Kind(".db3", write_humble_file(folder / "humble.db3", FUZZED).read_bytes()))
    for storage in StoragePlugin:
        for mode in (CompressionMode.NONE, CompressionMode.FILE):
            path = storage_file(
                write_bag(folder / f"{storage.name}{mode.name}", FUZZED, storage=storage, compression=mode)
            )
            made.append(Kind("".join(path.suffixes), path.read_bytes()))
    return made


@st.composite
def damages(draw: st.DrawFn) -> tuple[Callable[[bytearray], None], bool]:
    """What is done to the bytes of a file, and whether all of them keep their places."""
    share = draw(st.floats(0, 1, exclude_max=True))
    size = draw(st.sampled_from((1, 4, 8, 30, 100, 1000, 4096)))
    junk = draw(st.binary(min_size=1, max_size=9))
    bit = draw(st.integers(0, 7))
    how = draw(st.sampled_from(("cut", "flip", "write", "zero", "remove", "double")))

    def change(data: bytearray) -> None:
        at = int(share * len(data))
        if how == "cut":
            del data[at:]
        elif how == "flip":
            data[at] ^= 1 << bit
        elif how == "write":
            data[at : at + len(junk)] = junk[: len(data) - at]
        elif how == "zero":
            data[at : at + size] = bytes(min(size, len(data) - at))
        elif how == "remove":
            del data[at : at + size]
        else:
            data[at:at] = data[at : at + size]

    return change, how in {"flip", "write", "zero"}


@settings(max_examples=400)
@given(number=st.integers(0, 99), damage=damages())
def test_damage_is_read_as_whole_only_where_nothing_is_lost(
    number: int,
    damage: tuple[Callable[[bytearray], None], bool],
    kinds: list[Kind],
    tmp_path_factory: pytest.TempPathFactory,
) -> None:
    kind, (change, in_place) = kinds[number % len(kinds)], damage
    data = bytearray(kind.data)
    change(data)
    path = tmp_path_factory.getbasetemp() / f"damaged{kind.suffix}"
    path.write_bytes(data)
    found = read(path)
    if found is None or not found.is_whole:
        return
    if kind.has_checksums or not in_place:
        assert found.messages == FUZZED_WRITTEN
    assert found.messages.total() == FUZZED_WRITTEN.total()
    assert found.messages.total() >= (by_another_reader(path) & FUZZED_WRITTEN).total()


def test_a_loss_counts_among_all_messages_also_where_the_metadata_count_some_of_the_files_only() -> None:
    promised = MessageCounts(total=240, files={"a_0.mcap": 80})
    held = MessageCounts(total=200, files={"a_0.mcap": 40, "a_1.mcap": 80, "a_2.mcap": 80})
    assert min(promised.shares(held)) == pytest.approx(200 / 240)
