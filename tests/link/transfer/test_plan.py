# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""Lists of incidents and plans of one are what travelled; what lies is refused."""

from __future__ import annotations

from contextlib import suppress
from dataclasses import replace

import pytest
from hypothesis import given
from hypothesis import strategies as st

from smarttestudo.domain.errors import LinkError
from smarttestudo.domain.incident import RemoteIncident
from smarttestudo.link.protocol.wire import FrameType, Kind, frame
from smarttestudo.link.transfer.order import Level
from smarttestudo.link.transfer.plan import (
    MAX_LIST_BYTES,
    PLANS,
    PlannedFile,
    TransferPlan,
    list_from_bytes,
    list_to_bytes,
)

VERSION = bytes(range(8))
SHA = "00" * 32


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


def lied_list(one: RemoteIncident) -> bytes:
    """A list that no robot's end of ours makes: it shortens texts."""
    lists: FrameType[tuple[RemoteIncident, ...]] = FrameType(Kind.INCIDENT_LIST, tuple[RemoteIncident, ...])
    return lists.to_bytes((one,))


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
        list_from_bytes(lied_list(incident(**{"name": "i", **change})), "ada")


@given(data=st.binary(max_size=200))
def test_random_bytes_are_a_list_or_a_plan_or_refused(data: bytes) -> None:
    with suppress(LinkError):
        incidents = list_from_bytes(frame(Kind.INCIDENT_LIST, b"\1") + data, "ada")
        assert list_from_bytes(list_to_bytes(incidents), "ada") == incidents
    with suppress(LinkError):
        plan = PLANS.from_bytes(frame(Kind.INCIDENT_PLAN, b"\x08" + VERSION) + data)
        assert PLANS.from_bytes(PLANS.to_bytes(plan)) == plan


def test_a_plan_is_what_travelled() -> None:
    plan = TransferPlan(
        version=VERSION,
        files=(PlannedFile("incident.json", 7, SHA), PlannedFile("i_0.mcap", 9, SHA)),
        levels=(Level(5, 1.0), Level(9, float("inf"))),
        order_bytes=20,
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
    plan = TransferPlan(
        version=VERSION, files=tuple(PlannedFile(*one) for one in files), levels=(), order_bytes=9
    )
    nothing = TransferPlan(version=VERSION, files=(), levels=(), order_bytes=9)
    for lie in (plan, replace(nothing, version=b"short"), replace(nothing, order_bytes=0)):
        with pytest.raises(LinkError):
            PLANS.from_bytes(PLANS.to_bytes(lie))
