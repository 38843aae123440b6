# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""Questions for bytes and their parts are what travelled; what lies is refused."""

from __future__ import annotations

import pytest
from hypothesis import given
from hypothesis import strategies as st

from smarttestudo.domain.errors import LinkError
from smarttestudo.link.protocol.wire import Kind, frame
from smarttestudo.link.transfer.messages import ASKS, MAX_PART_BYTES, NEWEST, PARTS, Ask, ContentPart, Got

VERSION = bytes(range(8))


@given(st.integers(0, 2**64 - 1), st.integers(0, 2**64 - 1), st.integers(0, 2**64 - 1))
def test_a_question_is_what_travelled(asker: int, got: int, offset: int) -> None:
    for name, version in (("a-1/files", VERSION), ("", NEWEST), ("20260102T030405678Z-near_miss", NEWEST)):
        ask = Ask(name=name, version=version, asker=asker, got_bytes=got, offset=offset)
        for said in (ask, Got(asker=asker, got_bytes=got)):
            assert ASKS.from_bytes(ASKS.to_bytes(said)) == said


@given(st.binary(max_size=100))
def test_random_bytes_are_a_question_or_refused(data: bytes) -> None:
    for start in (b"", *(frame(Kind.ASK, one) for one in (b"\0", b"\1"))):
        try:
            said = ASKS.from_bytes(start + data)
        except LinkError:
            continue
        assert ASKS.to_bytes(said) == start + data


@pytest.mark.parametrize("name", ["../x", "/a", ".hidden", "a" * 121, "a\n", "ä", "\0", "a/../b", "a.b"])
def test_no_name_leads_elsewhere(name: str) -> None:
    with pytest.raises(LinkError):
        ASKS.from_bytes(ASKS.to_bytes(Ask(name=name, version=NEWEST, asker=1, got_bytes=0, offset=0)))


@pytest.mark.parametrize(
    "lie",
    [
        Ask(name="a", version=b"short", asker=1, got_bytes=0, offset=0),
        Ask(name="a", version=VERSION, asker=1, got_bytes=0, offset=-1),
        Ask(name="a", version=VERSION, asker=1, got_bytes=-1, offset=0),
        Got(asker=-1, got_bytes=0),
    ],
)
def test_a_question_that_lies_is_refused(lie: Ask | Got) -> None:
    with pytest.raises(LinkError):
        ASKS.from_bytes(ASKS.to_bytes(lie))


@given(st.binary(min_size=1, max_size=200), st.integers(0, 2**60), st.integers(0, 2**60))
def test_a_part_is_what_travelled(data: bytes, offset: int, more: int) -> None:
    part = ContentPart(version=VERSION, total_bytes=offset + len(data) + more, offset=offset, data=data)
    assert PARTS.from_bytes(PARTS.to_bytes(part)) == part


@pytest.mark.parametrize(
    "lie",
    [
        ContentPart(version=VERSION, total_bytes=4, offset=0, data=b"12345"),
        ContentPart(version=VERSION, total_bytes=10, offset=6, data=b"12345"),
        ContentPart(version=VERSION, total_bytes=2**63, offset=0, data=b"12345"),
        ContentPart(version=VERSION, total_bytes=10, offset=-1, data=b"12345"),
        ContentPart(version=VERSION, total_bytes=10, offset=0, data=b""),
        ContentPart(version=NEWEST, total_bytes=10, offset=0, data=b"12345"),
        ContentPart(version=VERSION, total_bytes=2**40, offset=0, data=bytes(MAX_PART_BYTES + 1)),
    ],
)
def test_a_part_that_lies_is_refused(lie: ContentPart) -> None:
    with pytest.raises(LinkError):
        PARTS.from_bytes(PARTS.to_bytes(lie))


@given(st.binary(max_size=200))
def test_random_bytes_are_a_part_or_refused(data: bytes) -> None:
    whole = PARTS.to_bytes(ContentPart(version=VERSION, total_bytes=300, offset=20, data=bytes(84)))
    for attempt in (data, whole[:14] + data):
        try:
            part = PARTS.from_bytes(attempt)
        except LinkError:
            continue
        assert PARTS.to_bytes(part) == attempt
