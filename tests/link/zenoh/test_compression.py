# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""Messages that are made smaller where that pays."""

from __future__ import annotations

import random
import struct
from contextlib import suppress

import pytest
import zstandard
from hypothesis import example, given
from hypothesis import strategies as st

from smarttestudo.domain.errors import LinkError
from smarttestudo.link.zenoh.compression import Compressor, decompress

TEXT = b"the same words again and again, " * 40
NOISE = random.Random(5).randbytes(2_000)
MOST_BYTES = 1_000_000


def test_what_shrinks_travels_smaller_and_comes_back_whole() -> None:
    encoded = Compressor().encode(1, TEXT)
    assert encoded.is_compressed
    assert len(encoded.data) < len(TEXT) / 2
    assert decompress(encoded.data, MOST_BYTES) == TEXT


def test_small_messages_and_noise_travel_as_they_are() -> None:
    compressor = Compressor()
    assert compressor.encode(1, b"a" * 199) == (b"a" * 199, False)
    assert compressor.encode(1, NOISE) == (NOISE, False)


def test_a_stream_that_gains_nothing_is_left_alone_and_tried_again_later() -> None:
    compressor = Compressor()
    for _ in range(3):
        compressor.encode(1, NOISE)
    left_alone = 0
    while not compressor.encode(1, TEXT).is_compressed:
        left_alone += 1
    assert 100 <= left_alone <= 1_000
    assert compressor.encode(1, TEXT).is_compressed


def test_one_message_that_gains_nothing_does_not_end_it_and_streams_do_not_share() -> None:
    compressor = Compressor()
    compressor.encode(1, NOISE)
    assert compressor.encode(1, TEXT).is_compressed
    for _ in range(5):
        compressor.encode(1, NOISE)
    assert compressor.encode(2, TEXT).is_compressed


def test_what_would_be_too_large_is_refused_before_it_is_made() -> None:
    bomb = zstandard.ZstdCompressor().compress(bytes(MOST_BYTES + 1))
    assert len(bomb) < 1_000
    with pytest.raises(LinkError, match="1000001"):
        decompress(bomb, MOST_BYTES)


def test_frames_that_say_nothing_or_lie_about_their_size_are_refused() -> None:
    silent = zstandard.ZstdCompressor(write_content_size=False).compress(bytes(MOST_BYTES * 2))
    with pytest.raises(LinkError):
        decompress(silent, MOST_BYTES)
    honest = zstandard.ZstdCompressor().compress(bytes(100_000))
    claim = honest.index(struct.pack("<I", 100_000))
    for lie in (0, 1, 99_999, 100_001, MOST_BYTES, 2**32 - 1):
        lying = honest[:claim] + struct.pack("<I", lie) + honest[claim + 4 :]
        with pytest.raises(LinkError):
            decompress(lying, MOST_BYTES)


@given(st.binary(max_size=300), st.integers(0, 60))
@example(b"", 0)
def test_anything_else_is_refused(data: bytes, kept: int) -> None:
    beginning = zstandard.ZstdCompressor().compress(TEXT)[:kept]
    for damaged in (data, beginning + data):
        with suppress(LinkError):
            assert len(decompress(damaged, MOST_BYTES)) <= MOST_BYTES
