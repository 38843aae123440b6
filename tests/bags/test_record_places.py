# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""The walk over the records of an MCAP file, against one that cuts them off the front of its bytes."""

from __future__ import annotations

import io

from hypothesis import given
from hypothesis import strategies as st

from smarttestudo.bags.mcap.record_bytes import CHUNK_HEADER, Op, RecordPlace, record, record_places

FRAME_BYTES = 9
contents = st.tuples(st.sampled_from([op for op in Op if op is not Op.CHUNK]), st.binary(max_size=60))
plain = st.lists(contents, max_size=5).map(lambda given: b"".join(record(*one) for one in given))
chunks = plain.map(lambda records: record(Op.CHUNK, bytes(CHUNK_HEADER.size) + records))
files = st.lists(plain | chunks, max_size=4).map(b"".join)


def naive(data: bytes, head_bytes: int, *, enters_chunks: bool) -> list[RecordPlace]:
    found, start = [], 0
    while len(data) >= FRAME_BYTES:
        op, size_bytes = data[0], int.from_bytes(data[1:FRAME_BYTES], "little")
        content = data[FRAME_BYTES:][:size_bytes]
        found.append((op, start, start + FRAME_BYTES + size_bytes, content[:head_bytes]))
        is_entered = enters_chunks and op == Op.CHUNK
        step = FRAME_BYTES + (CHUNK_HEADER.size if is_entered else size_bytes)
        data, start = data[step:], start + step
    return found


@given(
    data=files | st.binary(max_size=200),
    cut_bytes=st.integers(0, 40),
    head_bytes=st.integers(0, 40),
    enters_chunks=st.booleans(),
)
def test_whatever_the_bytes_a_walk_gives_each_record_whose_frame_is_there(
    data: bytes, cut_bytes: int, head_bytes: int, enters_chunks: bool
) -> None:
    data = data[: max(0, len(data) - cut_bytes)]
    walked = record_places(io.BytesIO(data), 0, len(data), head_bytes, enters_chunks=enters_chunks)
    assert list(walked) == naive(data, head_bytes, enters_chunks=enters_chunks)


@given(records=plain, chunk=chunks)
def test_a_walk_into_chunks_gives_what_a_walk_within_them_does(records: bytes, chunk: bytes) -> None:
    data = records + chunk
    entered = list(record_places(io.BytesIO(data), 0, len(data), 8, enters_chunks=True))
    start = len(records) + FRAME_BYTES + CHUNK_HEADER.size
    inner = list(record_places(io.BytesIO(data), start, len(data), 8, enters_chunks=True))
    assert [place for place in entered if place[1] >= start] == inner
