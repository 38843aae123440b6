# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""Chunks that overlap are merged by time with work that grows as their messages do, in bounded memory."""

from __future__ import annotations

import tracemalloc
from collections.abc import Callable, Iterator

import pytest
from hypothesis import given
from hypothesis import strategies as st

from smarttestudo.bags.mcap.recovered import FoundMessage, in_time_order

PAYLOAD = b"payload"


@given(
    chunks=st.lists(st.lists(st.integers(0, 20), min_size=1, max_size=8), max_size=12),
    held_bytes=st.sampled_from((0, 600, 2000, 1 << 28)),
)
def test_chunks_are_merged_as_a_stable_sort_of_all_their_messages(
    chunks: list[list[int]], held_bytes: int
) -> None:
    chunks.sort(key=min)
    found = [
        [(stamp, number, len(PAYLOAD), PAYLOAD + bytes([place])) for place, stamp in enumerate(stamps)]
        for number, stamps in enumerate(chunks)
    ]
    places = [(min(stamps), number) for number, stamps in enumerate(chunks)]
    merged = list(in_time_order(places, found.__getitem__, held_bytes=held_bytes))
    assert merged == sorted((one for chunk in found for one in chunk), key=lambda one: one[0])


class CountedStamp(int):
    """A stamp in ns that counts how often it is compared with another."""

    compared = 0

    def __lt__(self, other: float) -> bool:
        CountedStamp.compared += 1
        return int(self) < other

    def __gt__(self, other: float) -> bool:
        CountedStamp.compared += 1
        return int(self) > other


def chunk_of_a_topic(number: int, _chunks: int) -> range:
    return range(number, 20_000, 1000)


def chunk_of_one_stamp(_number: int, _chunks: int) -> range:
    return range(5, 6)


def chunk_within_the_first(number: int, chunks: int) -> range:
    return range(1000 * number, 1000 * number + 1) if number else range(0, 1000 * chunks, 100)


@pytest.mark.parametrize("stamps_of", [chunk_of_a_topic, chunk_of_one_stamp, chunk_within_the_first])
def test_comparisons_grow_as_the_messages_do(stamps_of: Callable[[int, int], range]) -> None:
    def compared(chunks: int) -> int:
        found = [
            [(CountedStamp(stamp), number, 0, b"") for stamp in stamps_of(number, chunks)]
            for number in range(chunks)
        ]
        places = [(one[0][0], number) for number, one in enumerate(found)]
        CountedStamp.compared = 0
        assert sum(1 for _ in in_time_order(places, found.__getitem__)) == sum(map(len, found))
        return CountedStamp.compared

    assert compared(800) / compared(200) < 4 * 1.6


def test_memory_holds_what_was_said_of_what_overlaps() -> None:
    def read(number: int) -> Iterator[FoundMessage]:
        return ((1000 * place + number, number, 10_000, bytes(10_000)) for place in range(20))

    tracemalloc.start()
    try:
        places = ((number, number) for number in range(100))
        count = sum(1 for _ in in_time_order(places, read, held_bytes=1_000_000))
        _, peak_bytes = tracemalloc.get_traced_memory()
    finally:
        tracemalloc.stop()
    assert count == 2000
    assert peak_bytes < 8_000_000
