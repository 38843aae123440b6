# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""Content is unpacked as far as it was declared, and no further than is said; the rest is never in memory."""

from __future__ import annotations

import io
import struct
import tracemalloc
from collections.abc import Callable
from pathlib import Path

import lz4.frame  # type: ignore[import-untyped]
import pytest
import zstandard
from mcap.writer import CompressionType

from bags.bag_factory import small_mission, write_mcap_file
from bags.bag_reading import read_bag
from smarttestudo.bags import unpacking
from smarttestudo.bags.mcap.record_bytes import FRAME
from smarttestudo.bags.mcap.records import chunk_content
from smarttestudo.bags.mcap.whole_file import full_index
from smarttestudo.bags.reader import open_recording
from smarttestudo.bags.unpacking import MAX_UNPACKED_BYTES, TooLargeError
from smarttestudo.domain.errors import RecordingError

BOMB_BYTES = 200_000_000
MISSION = small_mission(1.0)


def zstd_of_zeros(size_bytes: int, *, declares: bool = False) -> bytes:
    packed = io.BytesIO()
    size = size_bytes if declares else -1
    with zstandard.ZstdCompressor(level=1).stream_writer(packed, size=size, closefd=False) as writer:
        for _ in range(size_bytes // 1_000_000):
            writer.write(bytes(1_000_000))
    return packed.getvalue()


def lz4_of_zeros(size_bytes: int) -> bytes:
    compressor = lz4.frame.LZ4FrameCompressor()
    pieces = [compressor.begin()]
    pieces += (compressor.compress(bytes(1_000_000)) for _ in range(size_bytes // 1_000_000))
    return b"".join([*pieces, compressor.flush()])


def chunk_of(compression: str, packed: bytes, declared_bytes: int) -> bytes:
    name = compression.encode()
    head = struct.pack("<QQQII", 0, 0, declared_bytes, 0, len(name))
    return head + name + struct.pack("<Q", len(packed)) + packed


@pytest.mark.parametrize("declared_bytes", [1000, MAX_UNPACKED_BYTES + 1, 2**64 - 1])
@pytest.mark.parametrize(("compression", "pack"), [("zstd", zstd_of_zeros), ("lz4", lz4_of_zeros)])
def test_a_chunk_is_not_unpacked_beyond_what_it_declares(
    compression: str, pack: Callable[[int], bytes], declared_bytes: int
) -> None:
    chunk = chunk_of(compression, pack(BOMB_BYTES), declared_bytes)
    tracemalloc.start()
    try:
        with pytest.raises(TooLargeError):
            chunk_content(chunk, is_whole=True)
        _, peak_bytes = tracemalloc.get_traced_memory()
    finally:
        tracemalloc.stop()
    assert peak_bytes < BOMB_BYTES


@pytest.mark.parametrize(("compression", "pack"), [("zstd", zstd_of_zeros), ("lz4", lz4_of_zeros)])
def test_a_chunk_of_several_frames_is_unpacked_to_what_it_declares(
    compression: str, pack: Callable[[int], bytes]
) -> None:
    chunk = chunk_of(compression, pack(1_000_000) + pack(2_000_000), 3_000_000)
    assert chunk_content(chunk, is_whole=True) == bytes(3_000_000)


@pytest.mark.parametrize("compression", [CompressionType.ZSTD, CompressionType.LZ4])
def test_a_chunk_that_holds_more_than_it_declares_costs_itself(
    tmp_path: Path, compression: CompressionType
) -> None:
    path = write_mcap_file(tmp_path / "bag.mcap", MISSION, compression=compression, chunk_size=20_000)
    index = full_index(path)
    assert index is not None
    data = bytearray(path.read_bytes())
    struct.pack_into("<Q", data, index.chunks[0].chunk_start_offset + FRAME.size + 16, 5)
    path.write_bytes(data)
    read = read_bag(path)
    assert 0 < len(read.messages) < len(MISSION.messages)
    limit = "chunks longer than declared or than 1 000 000 000 bytes, which are not decompressed: 1; "
    assert any(limit in notice for notice in read.notices), read.notices


@pytest.mark.parametrize("declares", [False, True])
def test_a_message_is_not_unpacked_beyond_the_limit(declares: bool, monkeypatch: pytest.MonkeyPatch) -> None:
    packed = zstd_of_zeros(BOMB_BYTES, declares=declares)
    monkeypatch.setattr(unpacking, "MAX_UNPACKED_BYTES", 1_000_000)
    tracemalloc.start()
    try:
        assert unpacking.unpack_message(packed) is None
        _, peak_bytes = tracemalloc.get_traced_memory()
    finally:
        tracemalloc.stop()
    assert peak_bytes < BOMB_BYTES


@pytest.mark.parametrize("declares", [False, True])
@pytest.mark.parametrize("name", ["bag.db3.zstd", "bag.mcap.zstd"])
def test_a_file_that_unpacks_to_thousands_of_times_its_length_is_refused(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, declares: bool, name: str
) -> None:
    monkeypatch.setattr(unpacking, "MAX_UNPACKED_BYTES", 1_000_000)
    path = tmp_path / name
    path.write_bytes(zstd_of_zeros(BOMB_BYTES, declares=declares))
    cause = "is not decompressed: its content is longer than"
    with pytest.raises(RecordingError, match=cause), open_recording(path):
        pass
