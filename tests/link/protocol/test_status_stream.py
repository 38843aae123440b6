# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""Statuses over a link: what was put together is what was sent, whatever was lost on the way."""

from __future__ import annotations

import contextlib
import zlib
from typing import Any

import pytest
from hypothesis import example, given
from hypothesis import strategies as st

from smarttestudo.domain.errors import LinkError
from smarttestudo.link.protocol.status_stream import StatusReceiver, StatusSender
from smarttestudo.link.protocol.wire import Kind, frame

SECOND = 1_000_000_000
PERIOD_NS = SECOND // 5
numbers = st.integers(-(2**70), 2**70) | st.floats(allow_nan=False, allow_infinity=False)
near = st.integers(0, 50) | st.integers(0, 5_000).map(lambda number: number / 100)
leaves: st.SearchStrategy[Any] = (
    st.none() | st.booleans() | near | numbers | st.text(max_size=5) | st.just([]) | st.just({})
)
records = st.dictionaries(
    st.sampled_from("abcd"),
    st.recursive(
        leaves,
        lambda inner: st.lists(inner, max_size=3) | st.dictionaries(st.text(max_size=2), inner, max_size=3),
        max_leaves=8,
    ),
    max_size=4,
)
alike = st.lists(st.fixed_dictionaries(dict.fromkeys("abcd", leaves)), min_size=1, max_size=12)
sequences = alike | st.lists(records, min_size=1, max_size=8)


def compress(data: bytes, before: bytes) -> bytes:
    """``data`` made small by ``before``."""
    made = zlib.compressobj(zdict=before)
    return made.compress(data) + made.flush()


def decompress(data: bytes, most_bytes: int, before: bytes) -> bytes:
    """What ``compress`` made, of at most so many bytes."""
    try:
        unpacked = zlib.decompressobj(zdict=before).decompress(data, most_bytes + 1)
    except zlib.error as error:
        raise LinkError("damaged") from error
    if len(unpacked) > most_bytes:
        raise LinkError("too large")
    return unpacked


def sender(measured: str = "") -> StatusSender:
    return StatusSender(lambda path: str(path[-1]) in [*measured], compress)


def same(one: Any, other: Any) -> bool:
    """Whether two records are equal, names in the same order; 50 is 50.0, but not True 1."""
    if isinstance(one, dict) and isinstance(other, dict):
        return [*one] == [*other] and all(same(one[key], other[key]) for key in one)
    if isinstance(one, list) and isinstance(other, list):
        return len(one) == len(other) and all(map(same, one, other))
    return bool(one == other) and isinstance(one, bool) == isinstance(other, bool)


@given(sequences, st.lists(st.booleans(), max_size=12))
@example([{"a": 5.25}, {"a": 5.3}, {"a": 5.25}, {"a": 2**60 + 1}, {"a": 1e300}, {"a": True}], [])
def test_a_status_is_whole_or_none_and_a_full_one_mends_a_loss(
    sequence: list[dict[str, Any]], lost: list[bool]
) -> None:
    there, here = sender(), StatusReceiver(decompress)
    for number, record in enumerate(sequence):
        data = there.next(record, number * PERIOD_NS)
        if number < len(lost) and lost[number]:
            continue
        received = here.receive(data)
        assert received is None or same(received, record)
        if here.needs_full:
            mended = here.receive_full(there.number, there.full())
            assert mended is not None
            assert same(mended, record)


@given(alike, st.integers(0, 11))
def test_changes_that_come_before_the_full_status_wait_for_it(
    sequence: list[dict[str, Any]], place: int
) -> None:
    there, here, late = sender(), StatusReceiver(decompress), (0, b"")
    for number, record in enumerate(sequence):
        data = there.next(record, number * PERIOD_NS)
        if number == min(place, len(sequence) - 1):
            late = there.number, there.full()
        if number:
            here.receive(data)
    received = here.receive_full(*late)
    assert received is None or same(received, sequence[-1])
    assert not here.needs_full


def test_what_is_measured_changes_once_a_second_and_the_rest_at_once() -> None:
    there, here = sender(measured="m"), StatusReceiver(decompress)
    seen = []
    for number in range(11):
        received = here.receive(there.next({"m": number, "v": number}, number * PERIOD_NS))
        assert received is not None
        assert received["v"] == number
        seen.append(received["m"])
    assert seen == [0, 0, 0, 0, 0, 5, 5, 5, 5, 5, 10]


def test_what_is_measured_is_there_and_gone_at_once() -> None:
    there, here = sender(measured="m"), StatusReceiver(decompress)
    seen = [here.receive(there.next({"m": value}, 0)) for value in (1.5, None, 2.5)]
    assert seen == [{"m": 1.5}, {"m": None}, {"m": 2.5}]


def test_what_utf_8_cannot_say_arrives_as_a_question_mark() -> None:
    there, here = sender(), StatusReceiver(decompress)
    assert here.receive(there.next({"v": "r\udce9gles"}, 0)) == {"v": "r?gles"}


def test_a_small_change_takes_few_bytes() -> None:
    there = sender()
    record = {f"name of entry {number}": 1000.5 + number for number in range(100)}
    there.next(record, 0)
    unchanged = there.next(record, 0)
    changed = there.next({**record, "name of entry 7": 1007.9, "name of entry 99": None}, 0)
    assert len(unchanged) <= 60
    assert len(changed) <= 90


def test_before_the_first_status_there_is_no_full_one() -> None:
    with pytest.raises(LinkError, match="no status yet"):
        sender().full()


@given(st.binary(max_size=60))
def test_garbage_is_refused_or_mended_by_a_full_status(garbage: bytes) -> None:
    there, here = sender(), StatusReceiver(decompress)
    here.receive(there.next({"a": 1, "b": ["x", None]}, 0))
    for data in (garbage, frame(Kind.STATUS_CHANGES, garbage), frame(Kind.STATUS_CHANGES, b"\2" + garbage)):
        with contextlib.suppress(LinkError):
            here.receive(data)
    here.needs_full = True
    # Garbage may be a change by chance: it is not told from one.
    assert here.receive_full(there.number, there.full()) is not None


@pytest.mark.parametrize(
    "text",
    [b"", b"[]", b"5", b"{", b"[" * 100_000, b'{"a":' * 17 + b"1" + b"}" * 17, b" " * 1_000_001],
    ids=range(7),
)
def test_a_full_status_that_is_none_is_refused(text: bytes) -> None:
    with pytest.raises(LinkError):
        StatusReceiver(decompress).receive_full(1, compress(text, b""))
    with pytest.raises(LinkError):
        StatusReceiver(decompress).receive(frame(Kind.STATUS_CHANGES, b"\1" + compress(text, b"")))
