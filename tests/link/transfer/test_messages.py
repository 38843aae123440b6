# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""Questions about incidents and their answers, as they travel, and what strangers send in their place."""

from __future__ import annotations

from typing import Any

import pytest
from hypothesis import given
from hypothesis import strategies as st

from smarttestudo.domain.errors import LinkError
from smarttestudo.domain.incident import RemoteIncident
from smarttestudo.link.protocol.wire import FrameType, Kind, frame
from smarttestudo.link.transfer.messages import (
    LISTS,
    MAX_LIST_BYTES,
    PIECES,
    PLANS,
    QUESTIONS,
    AskBytes,
    AskList,
    AskPlan,
    PlannedFile,
    TransferPiece,
    TransferPlan,
    list_from_bytes,
    list_to_bytes,
    piece_from_bytes,
)
from smarttestudo.link.transfer.order import ByteRange, Level, RangePart

TOKEN = bytes(range(16))
SHA = "00" * 32


@given(
    st.integers(0, 2**64 - 1), st.integers(0, 2**64 - 1), st.integers(0, 2**64 - 1), st.integers(0, 16_000)
)
def test_a_question_is_what_travelled(asker: int, got: int, cursor: int, size: int) -> None:
    ask = AskBytes(name="a-1", token=TOKEN, asker=asker, got_bytes=got, cursor=cursor, size_bytes=size)
    for question in (ask, AskList(), AskPlan(name="20260102T030405678Z-near_miss")):
        assert QUESTIONS.from_bytes(QUESTIONS.to_bytes(question)) == question


@given(st.binary(max_size=100))
def test_random_bytes_are_a_question_or_refused(data: bytes) -> None:
    for start in (b"", *(frame(Kind.INCIDENT_QUESTION, one) for one in (b"\0", b"\1", b"\2"))):
        try:
            question = QUESTIONS.from_bytes(start + data)
        except LinkError:
            continue
        assert QUESTIONS.to_bytes(question) == start + data


@pytest.mark.parametrize("name", ["", "../x", "a/b", ".hidden", "a" * 101, "a\n", "ä", "\0"])
def test_no_name_of_an_incident_leads_elsewhere(name: str) -> None:
    with pytest.raises(LinkError):
        QUESTIONS.from_bytes(QUESTIONS.to_bytes(AskPlan(name=name)))


def incident(name: object, **changes: object) -> RemoteIncident:
    values: dict[str, object] = {
        "robot": "ada",
        "name": name,
        "label": "near miss",
        "rule": "Close call",
        "triggered_ns": 5,
        "from_ns": 0,
        "to_ns": 9,
        "messages": 3,
        "size_bytes": 700,
        "missing": ("late",),
        **changes,
    }
    return RemoteIncident(**values)  # type: ignore[arg-type]


def test_a_list_is_what_travelled_and_the_newest_of_too_many() -> None:
    few = [incident(f"i{n}", is_read=n % 2 == 0) for n in range(5)]
    assert list_from_bytes(list_to_bytes(few), "ada") == few
    assert list_from_bytes(list_to_bytes([]), "ada") == []
    many = [incident(f"i{n}", rule="r" * 999) for n in range(5_000)]
    data = list_to_bytes(many)
    found = list_from_bytes(data, "ada")
    assert found == many[-len(found) :]
    assert len(data) <= MAX_LIST_BYTES
    assert len(found) > 500


@pytest.mark.parametrize(
    "change",
    [
        {"name": "../../etc/passwd"},
        {"name": "a/b"},
        {"name": "x" * 10_000},
        {"missing": ("x" * 2_000,)},
        {"label": "x" * 2_000},
    ],
)
def test_a_list_that_lies_is_refused(change: dict[str, object]) -> None:
    with pytest.raises(LinkError):
        list_from_bytes(LISTS.to_bytes((incident(**{"name": "i", **change}),)), "ada")


@pytest.mark.parametrize(
    ("messages", "start"),
    [
        (LISTS, frame(Kind.INCIDENT_LIST, b"\1")),
        (PLANS, frame(Kind.INCIDENT_PLAN, b"\x10" + TOKEN)),
    ],
)
@given(data=st.binary(max_size=200))
def test_random_bytes_are_a_list_or_a_plan_or_refused(
    messages: FrameType[Any], start: bytes, data: bytes
) -> None:
    try:
        found = messages.from_bytes(start + data)
    except LinkError:
        return
    assert messages.from_bytes(messages.to_bytes(found)) == found


def test_a_plan_is_what_travelled() -> None:
    plan = TransferPlan(
        token=TOKEN,
        files=(PlannedFile("incident.json", 7, SHA), PlannedFile("i_0.mcap", 9, SHA)),
        levels=(Level(5, 1.0), Level(9, float("inf"))),
    )
    assert PLANS.from_bytes(PLANS.to_bytes(plan)) == plan
    assert plan.size_bytes == 16


@pytest.mark.parametrize(
    "files",
    [
        [("../x", 1, SHA)],
        [("/etc/passwd", 1, SHA)],
        [("a/b.mcap", 1, SHA)],
        [(".fetch.json", 1, SHA)],
        [("..", 1, SHA)],
        [("", 1, SHA)],
        [("x" * 200, 1, SHA)],
        [("a", 1, SHA), ("A", 1, SHA)],
        [("a", -1, SHA)],
        [("a", 2**63, SHA)],
        [("a", 1, "zz")],
        [("a", 1, "00")],
        [(f"f{n}", 1, SHA) for n in range(1_001)],
    ],
)
def test_a_plan_that_lies_is_refused(files: list[tuple[str, int, str]]) -> None:
    plan = TransferPlan(token=TOKEN, files=tuple(PlannedFile(*one) for one in files), levels=())
    for lie in (plan, TransferPlan(token=b"short", files=(), levels=())):
        with pytest.raises(LinkError):
            PLANS.from_bytes(PLANS.to_bytes(lie))


PARTS = (
    RangePart(ByteRange(0, 0, 100), 20, 80),
    RangePart(ByteRange(3, 2**40, 50, (0, 10)), 0, 50),
    RangePart(ByteRange(1, 5, 9), 0, 4),
)


def test_a_piece_is_what_travelled() -> None:
    piece = TransferPiece(parts=PARTS, body=bytes(range(84)), advised_bytes=700, waiting=3)
    assert piece.covered_bytes == 134
    assert piece_from_bytes(PIECES.to_bytes(piece), 134) == piece


def test_a_piece_that_is_larger_than_what_was_asked_for_is_refused() -> None:
    piece = TransferPiece(parts=PARTS, body=bytes(84), advised_bytes=700, waiting=3)
    with pytest.raises(LinkError):
        piece_from_bytes(PIECES.to_bytes(piece), 133)
    short = TransferPiece(parts=PARTS, body=bytes(83), advised_bytes=700, waiting=3)
    with pytest.raises(LinkError):
        piece_from_bytes(PIECES.to_bytes(short), 500)
    beyond = TransferPiece(
        parts=(RangePart(ByteRange(0, 0, 10), 5, 6),), body=bytes(6), advised_bytes=1, waiting=0
    )
    with pytest.raises(LinkError):
        piece_from_bytes(PIECES.to_bytes(beyond), 500)


@given(st.binary(max_size=200))
def test_random_bytes_are_a_piece_or_refused(data: bytes) -> None:
    whole = PIECES.to_bytes(TransferPiece(parts=PARTS, body=bytes(84), advised_bytes=700, waiting=3))
    for attempt in (data, whole[:6] + data):
        try:
            piece = piece_from_bytes(attempt, 300)
        except LinkError:
            continue
        assert 0 < piece.covered_bytes <= 300
