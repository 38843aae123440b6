# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""Questions about incidents and their answers, as they travel, and what strangers send in their place."""

from __future__ import annotations

import json

import pytest
from hypothesis import given
from hypothesis import strategies as st

from smarttestudo.domain.errors import LinkError
from smarttestudo.domain.remote_incidents import RemoteIncident
from smarttestudo.incidents.transfer_messages import (
    MAX_LIST_BYTES,
    AskBytes,
    AskList,
    AskPlan,
    PlannedFile,
    TransferPiece,
    TransferPlan,
    list_from_bytes,
    list_to_bytes,
    piece_from_bytes,
    piece_to_bytes,
    plan_from_bytes,
    plan_to_bytes,
    question_from_bytes,
    question_to_bytes,
)
from smarttestudo.incidents.transfer_order import ByteRange, Level, RangePart

TOKEN = bytes(range(16))
SHA = "00" * 32


def refuse(_data: bytes, _most: int) -> bytes:
    raise LinkError("nothing is compressed")


@given(
    st.integers(0, 2**64 - 1), st.integers(0, 2**64 - 1), st.integers(0, 2**64 - 1), st.integers(0, 16_000)
)
def test_a_question_is_what_travelled(asker: int, got: int, cursor: int, size: int) -> None:
    ask = AskBytes(name="a-1", token=TOKEN, asker=asker, got_bytes=got, cursor=cursor, size_bytes=size)
    for question in (ask, AskList(), AskPlan(name="20260102T030405678Z-near_miss")):
        assert question_from_bytes(question_to_bytes(question)) == question


@given(st.binary(max_size=100))
def test_random_bytes_are_a_question_or_refused(data: bytes) -> None:
    for start in (b"", b"\1\1", b"\1\2", b"\1\3"):
        try:
            question = question_from_bytes(start + data)
        except LinkError:
            continue
        assert question_to_bytes(question) == start + data


@pytest.mark.parametrize("name", ["", "../x", "a/b", ".hidden", "a" * 101, "a\n", "ä", "\0"])
def test_no_name_of_an_incident_leads_elsewhere(name: str) -> None:
    with pytest.raises(LinkError):
        question_from_bytes(b"\1\2" + name.encode())


def incident(name: str, **changes: object) -> RemoteIncident:
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
    assert list_from_bytes(b"", "ada") == []
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
        {"size_bytes": -(2**70)},
        {"messages": "many"},
        {"rule": ["a"]},
        {"missing": "late"},
        {"label": "x" * 2_000},
    ],
)
def test_a_list_that_lies_is_refused(change: dict[str, object]) -> None:
    record = json.loads(list_to_bytes([incident("i")])) | change
    with pytest.raises(LinkError):
        list_from_bytes(json.dumps(record).encode(), "ada")


def test_a_name_that_moves_the_cursor_of_a_terminal_does_not() -> None:
    (found,) = list_from_bytes(list_to_bytes([incident("i", rule="a\x1b[2J")]), "ada")
    assert found.rule == "a?[2J"


def test_a_plan_is_what_travelled() -> None:
    plan = TransferPlan(
        token=TOKEN,
        files=(PlannedFile("incident.json", 7, SHA), PlannedFile("i_0.mcap", 9, SHA)),
        levels=(Level(5, 1.0), Level(9, float("inf"))),
    )
    assert plan_from_bytes(plan_to_bytes(plan)) == plan
    assert plan.size_bytes == 16


@pytest.mark.parametrize(
    "files",
    [
        [["../x", 1, SHA]],
        [["/etc/passwd", 1, SHA]],
        [["a/b.mcap", 1, SHA]],
        [[".fetch.json", 1, SHA]],
        [["..", 1, SHA]],
        [["", 1, SHA]],
        [["x" * 200, 1, SHA]],
        [["a", 1, SHA], ["A", 1, SHA]],
        [["a", -1, SHA]],
        [["a", 1.5, SHA]],
        [["a", 2**80, SHA]],
        [["a", 1, "zz"]],
        [["a", 1, "00"]],
        [["a", 1]],
        [[f"f{n}", 1, SHA] for n in range(1_001)],
        "files",
        None,
    ],
)
def test_a_plan_that_lies_is_refused(files: object) -> None:
    data = json.dumps({"token": TOKEN.hex(), "files": files, "levels": []}).encode()
    with pytest.raises(LinkError):
        plan_from_bytes(data)


PARTS = (
    RangePart(ByteRange(0, 0, 100), 20, 80),
    RangePart(ByteRange(3, 2**40, 50, (0, 10)), 0, 50),
    RangePart(ByteRange(1, 5, 9), 0, 4),
)


def test_a_piece_is_what_travelled() -> None:
    piece = TransferPiece(parts=PARTS, body=bytes(range(84)), advised_bytes=700, waiting=3)
    assert piece.covered_bytes == 134
    assert piece_from_bytes(piece_to_bytes(piece), 134, refuse) == piece
    packed = piece_to_bytes(piece, lambda _: b"small")
    assert piece_from_bytes(packed, 134, lambda data, most: bytes(range(84))[:most]) == piece


def test_a_piece_that_is_larger_than_what_was_asked_for_is_refused() -> None:
    piece = TransferPiece(parts=PARTS, body=bytes(84), advised_bytes=700, waiting=3)
    with pytest.raises(LinkError):
        piece_from_bytes(piece_to_bytes(piece), 133, refuse)
    short = TransferPiece(parts=PARTS, body=bytes(83), advised_bytes=700, waiting=3)
    with pytest.raises(LinkError):
        piece_from_bytes(piece_to_bytes(short), 500, refuse)
    beyond = TransferPiece(
        parts=(RangePart(ByteRange(0, 0, 10), 5, 6),), body=bytes(6), advised_bytes=1, waiting=0
    )
    with pytest.raises(LinkError):
        piece_from_bytes(piece_to_bytes(beyond), 500, refuse)


@given(st.binary(max_size=200))
def test_random_bytes_are_a_piece_or_refused(data: bytes) -> None:
    whole = piece_to_bytes(TransferPiece(parts=PARTS, body=bytes(84), advised_bytes=700, waiting=3))
    for attempt in (data, whole[:22] + data):
        try:
            piece = piece_from_bytes(attempt, 300, refuse)
        except LinkError:
            continue
        assert 0 < piece.covered_bytes <= 300
