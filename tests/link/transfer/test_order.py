# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""The order in which the bytes of an incident travel."""

from __future__ import annotations

import math
from contextlib import suppress
from functools import cache
from itertools import accumulate

import pytest
from hypothesis import given
from hypothesis import strategies as st

from smarttestudo.domain.errors import LinkError
from smarttestudo.link.transfer.order import ByteRange, MessageRange, TransferOrder, read_head

S = 1_000_000_000


def read(order: TransferOrder, offset: int, size_bytes: int) -> bytes:
    """What travels, of files of zeros."""
    return b"".join(
        one if isinstance(one, bytes) else bytes(one.size_bytes)
        for one in order.stretches(offset, size_bytes)
    )


def ranges_of(data: bytes) -> list[ByteRange]:
    """The ranges whose heads and bytes these are."""
    ranges = []
    while data:
        found = read_head(data)
        assert found is not None
        one, head_bytes = found
        ranges.append(one)
        assert len(data) >= head_bytes + one.size_bytes
        data = data[head_bytes + one.size_bytes :]
    return ranges


@cache
@st.composite
def contents(draw: st.DrawFn) -> tuple[list[ByteRange], list[MessageRange], list[ByteRange]]:
    """A file of a head, messages of up to three topics in any order of time, and a tail."""
    sizes = draw(st.lists(st.integers(1, 40_000), max_size=60))
    head = ByteRange(0, 0, draw(st.integers(0, 300)))
    offsets = list(accumulate([head.size_bytes, *sizes]))
    messages = [
        MessageRange(0, offset, size, draw(st.sampled_from("abc")), draw(st.integers(0, 20 * S)))
        for offset, size in zip(offsets, sizes, strict=False)
    ]
    return [head], messages, [ByteRange(0, offsets[-1], draw(st.integers(0, 300)))]


@given(contents(), st.data())
def test_every_byte_is_in_the_order_once_however_it_is_cut(
    content: tuple[list[ByteRange], list[MessageRange], list[ByteRange]], data: st.DataObject
) -> None:
    head, messages, tail = content
    order = TransferOrder(head, messages, tail)
    cuts = data.draw(st.lists(st.integers(0, order.size_bytes), max_size=20).map(sorted))
    whole = read(order, 0, order.size_bytes)
    assert len(whole) == order.size_bytes
    assert whole == b"".join(
        read(order, start, end - start)
        for start, end in zip([0, *cuts], [*cuts, order.size_bytes], strict=True)
    )
    assert read(order, order.size_bytes, 10) == b""
    place = 0
    for one in sorted(ranges_of(whole)):
        assert one.offset == place
        place += one.size_bytes
    assert place == order.files_bytes == tail[0].offset + tail[0].size_bytes
    shuffled = data.draw(st.permutations(messages))
    assert read(TransferOrder(head, shuffled, tail), 0, order.size_bytes) == whole


@given(st.binary(max_size=60))
def test_random_bytes_are_a_head_or_the_beginning_of_one_or_refused(data: bytes) -> None:
    with suppress(LinkError):
        found = read_head(data)
        assert found is None or 0 < found[1] <= len(data)
    assert read_head(b"") is None
    with pytest.raises(LinkError):
        read_head(b"\xff" * 50)


def test_first_one_message_a_second_then_two_small_topics_first_and_images_last() -> None:
    odometry = [MessageRange(0, 1_000 + 700 * n, 700, "/odom", n * S // 20) for n in range(200)]
    scan = [MessageRange(1, 1_000 + 3_000 * n, 3_000, "/scan", n * S // 5) for n in range(50)]
    images = [MessageRange(2, 1_000 + 90_000 * n, 90_000, "/camera", n * S // 3) for n in range(30)]
    heads = [ByteRange(file, 0, 1_000) for file in range(3)]
    order = TransferOrder(heads, [*images, *scan, *odometry])
    ranges = ranges_of(read(order, 0, order.size_bytes))
    assert ranges[:3] == heads
    by_place = {(one.file, one.offset): one for one in (*images, *scan, *odometry)}
    found = [by_place[one.file, one.offset] for one in ranges[3:]]
    assert [(one.topic, one.stamp_ns) for one in found[:20]] == [
        *(("/odom", n * S) for n in range(10)),
        *(("/scan", n * S) for n in range(10)),
    ]
    assert [one.stamp_ns for one in found[20:30]] == [n * S + S // 2 for n in range(10)]
    assert [one.topic for one in found[-30:]] == ["/camera"] * 30
    assert [one.stamp_ns for one in found[-30:-20]] == [n * S for n in range(10)]
    # 20 Hz is whole with the grid of 32 Hz, which is all there is of small messages.
    assert [level.rate_hz for level in order.levels] == [1, 2, 4, 8, 16, math.inf]
    first = ranges_of(read(order, 0, order.levels[0].end))
    assert first == ranges[:23]


def test_messages_of_one_stamp_travel_together() -> None:
    latched = [MessageRange(0, 100 * n, 100, "/tf_static", 5 * S) for n in range(4)]
    later = [MessageRange(0, 1_000 + 100 * n, 100, "/tf_static", 5 * S + n) for n in range(1, 3)]
    order = TransferOrder([], [*later, *latched])
    assert [one.offset for one in ranges_of(read(order, 0, order.size_bytes))][:4] == [0, 100, 200, 300]
