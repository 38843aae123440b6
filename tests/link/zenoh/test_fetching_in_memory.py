# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""Incidents that are listed and fetched over a link in memory, and strangers at both ends of it."""

from __future__ import annotations

from collections.abc import Callable
from contextlib import ExitStack
from dataclasses import replace
from pathlib import Path

import pytest
import zenoh

from link.zenoh.ends import free_endpoint, operator_end, refuse_warning, robot_end, stranger_at, until
from link.zenoh.fetched_incidents import NAME, contents, fetching_from, listening_robot, never, write_incident
from link.zenoh.memory_zenoh import VirtualTime, network, virtual_time
from smarttestudo.domain.errors import LinkError, TestudoError
from smarttestudo.domain.incident import FetchProgress
from smarttestudo.link.protocol.wire import WIRE_VERSION
from smarttestudo.link.transfer.messages import ASKS, MAX_PART_BYTES, PARTS, VERSION_BYTES, Ask, ContentPart
from smarttestudo.link.transfer.order import ByteRange, TransferOrder
from smarttestudo.link.transfer.plan import PLANS, PlannedFile, TransferPlan
from smarttestudo.link.zenoh import open_robot_end
from smarttestudo.link.zenoh.security import LinkOptions
from smarttestudo.link.zenoh.session import open_session

__all__ = ["network", "virtual_time"]
pytestmark = pytest.mark.usefixtures("network", "virtual_time")
GONE = "the robot, which is not there"
VERSION = bytes([WIRE_VERSION])


def test_a_fetch_waits_for_a_robot_that_left_and_goes_on(tmp_path: Path, virtual_time: VirtualTime) -> None:
    endpoint = free_endpoint()
    path = write_incident(tmp_path / "robot", seconds=3)
    said: list[FetchProgress] = []
    router = open_session(LinkOptions(listen=(endpoint,)), "router", refuse_warning)
    with router, fetching_from(endpoint, robot=None) as incidents, ExitStack() as robot:

        def come() -> None:
            robot.enter_context(robot_end(endpoint)).offer_incidents(path.parent)

        def hear(progress: FetchProgress) -> None:
            if GONE not in {one.waits_for for one in said}:
                if progress.waits_for == GONE:
                    come()
                elif progress.got_bytes > 50_000:
                    robot.close()
            said.append(progress)

        def look() -> bool:
            virtual_time.sleep(0.3)
            return False

        come()
        until(lambda: "r1" in incidents.robots(0))
        fetched = incidents.fetch("r1", NAME, tmp_path / "here", hear, look)
    assert GONE in {one.waits_for for one in said}
    assert fetched is not None
    assert contents(fetched) == contents(path)


def test_a_robot_that_is_away_for_a_moment_is_asked_once_it_is_back(
    tmp_path: Path, virtual_time: VirtualTime
) -> None:
    endpoint = free_endpoint()
    path = write_incident(tmp_path / "robot")
    with operator_end(endpoint), fetching_from(endpoint, robot=None) as incidents, ExitStack() as robot:
        with robot_end(endpoint):
            until(lambda: "r1" in incidents.robots(0))
        until(lambda: incidents.robots(0) == [])
        virtual_time.later(2.0, lambda: robot.enter_context(robot_end(endpoint)).offer_incidents(path.parent))
        assert [one.name for one in incidents.list("r1")] == [NAME]


def test_what_is_not_there_is_said(tmp_path: Path) -> None:
    endpoint = free_endpoint()
    with listening_robot(endpoint, tmp_path / "nothing"), fetching_from(endpoint) as incidents:
        assert incidents.list("r1") == []
        for name in (NAME, "../nothing", f"{NAME}/", ""):
            with pytest.raises(LinkError, match=f"there is no incident '{name}'; 'testudo incidents list'"):
                incidents.fetch("r1", name, tmp_path / "here", lambda _: None, never)
        with pytest.raises(LinkError, match="there is no robot 'r2'"):
            incidents.list("r2")
    assert not (tmp_path / "here").exists()


@pytest.mark.parametrize("left", [(), ("metadata.yaml",)])
def test_an_incident_that_lost_its_record_on_the_robot_is_said_and_not_taken_for_fetched(
    tmp_path: Path, left: tuple[str, ...]
) -> None:
    endpoint, here = free_endpoint(), tmp_path / "here"
    path = write_incident(tmp_path / "there", seconds=1)
    with listening_robot(endpoint, path.parent), fetching_from(endpoint) as incidents:
        assert [one.name for one in incidents.list("r1")] == [NAME]
        for one in path.iterdir():
            if one.name not in left:
                one.unlink()
        with pytest.raises(LinkError, match=r"has no incident\.json"):
            incidents.fetch("r1", NAME, here, lambda _: None, never)
    assert not here.exists()


def test_an_empty_folder_with_its_name_is_no_incident_that_was_fetched(tmp_path: Path) -> None:
    endpoint, here = free_endpoint(), tmp_path / "here"
    path = write_incident(tmp_path / "there", seconds=1)
    (here / NAME).mkdir(parents=True)
    with listening_robot(endpoint, path.parent), fetching_from(endpoint) as incidents:
        assert incidents.fetch("r1", NAME, here, lambda _: None, never) == here / NAME
    assert {one.name for one in (here / NAME).iterdir()} == {one.name for one in path.iterdir()}


@pytest.mark.parametrize(
    "question",
    [b"", b"malformed", VERSION + b"\x0c\0\x09../../etc", VERSION + b"\x0c\1" + bytes(60), bytes(5_000)],
)
def test_a_stranger_who_asks_what_is_malformed_is_refused_and_others_are_answered(
    tmp_path: Path, question: bytes
) -> None:
    endpoint = free_endpoint()
    path = write_incident(tmp_path / "robot")
    with listening_robot(endpoint, path.parent) as end, stranger_at(endpoint, "peer") as session:
        replies = session.get(end.boot.incidents_key, payload=question, timeout=5.0)
        assert all(one.ok is None for one in replies)
        with fetching_from(endpoint) as incidents:
            fetched = incidents.fetch("r1", NAME, tmp_path / "here", lambda _: None, never)
    assert fetched is not None
    assert contents(fetched) == contents(path)


Answer = Callable[[Ask], bytes]
SHA = "00" * 32
LIED = TransferPlan(
    version=bytes(VERSION_BYTES), files=(PlannedFile("a.mcap", 3_000, SHA),), levels=(), order_bytes=3_004
)


def part_of(data: bytes, ask: Ask, version: bytes = bytes(VERSION_BYTES)) -> bytes:
    """The first part of these bytes from where they are asked for."""
    some = data[ask.offset : ask.offset + MAX_PART_BYTES]
    return PARTS.to_bytes(ContentPart(version=version, total_bytes=len(data), offset=ask.offset, data=some))


def travelling(range_: ByteRange) -> bytes:
    """A range as it travels, with zeros for its bytes, cut or filled up to what the plan says."""
    order = TransferOrder([range_], [])
    head = next(one for one in order.stretches(0, 60) if isinstance(one, bytes))
    return (head + bytes(3_004))[:3_004]


def lie(**changes: object) -> Answer:
    plan = PLANS.to_bytes(replace(LIED, **changes))  # type: ignore[arg-type]
    return lambda ask: part_of(travelling(ByteRange(0, 0, 3_000)) if "/" in ask.name else plan, ask)


def lying_part(make: Callable[[Ask], bytes]) -> Answer:
    return lambda ask: make(ask) if "/" in ask.name else part_of(PLANS.to_bytes(LIED), ask)


def lying_range(range_: ByteRange) -> Answer:
    return lying_part(lambda ask: part_of(travelling(range_), ask))


@pytest.mark.parametrize(
    "answer",
    [
        lie(files=(PlannedFile("../../outside", 3_000, SHA),)),
        lie(files=(PlannedFile("/tmp/outside", 3_000, SHA),)),
        lie(files=(PlannedFile("a.mcap", 2**61, SHA),)),
        lie(),
        lying_range(ByteRange(1, 0, 3_000)),
        lying_range(ByteRange(0, 2_500, 3_000)),
        lying_range(ByteRange(0, 2**50, 3_000)),
        lying_part(lambda ask: part_of(bytes(3_004), ask)),
        lying_part(lambda ask: part_of(b"\xff" * 3_004, ask)),
        lying_part(lambda ask: part_of(bytes(2_000), ask)),
        lying_part(lambda ask: part_of(bytes(3_004), ask, b"another!")),
        lying_part(lambda _: b"malformed"),
        lying_part(lambda ask: part_of(bytes(3_004), ask)[:-1]),
        lambda _: b"malformed",
        lambda ask: part_of(VERSION + b"\x0e" + b"[" * 100_000, ask),
    ],
)
def test_a_robot_that_lies_costs_its_own_fetch_only(tmp_path: Path, answer: Answer) -> None:
    endpoint = free_endpoint()
    here = tmp_path / "deep" / "here"
    here.mkdir(parents=True)
    with (
        open_robot_end("r1", LinkOptions(listen=(endpoint,)), refuse_warning) as end,
        stranger_at(endpoint, "peer") as session,
    ):

        def take(query: zenoh.Query) -> None:
            assert query.payload is not None
            said = ASKS.from_bytes(query.payload.to_bytes())
            with query:
                if isinstance(said, Ask):
                    query.reply(end.boot.incidents_key, answer(said))

        liar = session.declare_queryable(end.boot.incidents_key, take)
        with fetching_from(endpoint) as incidents, pytest.raises(TestudoError):
            incidents.fetch("r1", NAME, here, lambda _: None, never)
        liar.undeclare()
    assert {path.name for path in tmp_path.rglob("*")} <= {
        "deep",
        "here",
        f".{NAME}.partial",
        "a.mcap",
        ".fetch.json",
        ".fetch.lock",
    }
    assert not (here / NAME).exists()
