# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""Incidents that are listed and fetched over a link of this machine, and strangers at both ends of it."""

from __future__ import annotations

import math
import random
import threading
import time
from collections.abc import Callable, Iterator
from concurrent.futures import ThreadPoolExecutor
from contextlib import contextmanager, suppress
from dataclasses import replace
from pathlib import Path

import pytest
import zenoh

from link.zenoh.ends import (
    WITHIN_S,
    free_endpoint,
    operator_end,
    refuse_warning,
    robot_end,
    stranger_at,
    until,
)
from smarttestudo.bags.mcap.record_bytes import StoredChannel
from smarttestudo.bags.mcap.writer import FileContent, McapWriter
from smarttestudo.bags.metadata_text import METADATA_NAME, metadata_text
from smarttestudo.domain.errors import LinkError, TestudoError
from smarttestudo.domain.incident import IncidentRecord, IncidentTopic
from smarttestudo.domain.incident_json import incident_text
from smarttestudo.domain.remote_incidents import FetchProgress
from smarttestudo.incidents.transfer_messages import (
    MAX_ASK_BYTES,
    AskBytes,
    AskPlan,
    PlannedFile,
    TransferPiece,
    TransferPlan,
)
from smarttestudo.incidents.transfer_order import ByteRange, RangePart
from smarttestudo.link.protocol.incident_messages import PIECES, PLANS, QUESTIONS
from smarttestudo.link.zenoh import open_link_incidents, open_robot_end
from smarttestudo.link.zenoh.compression import packed
from smarttestudo.link.zenoh.link_incidents import LinkIncidents
from smarttestudo.link.zenoh.robot_end import RobotEnd
from smarttestudo.link.zenoh.security import LinkOptions

pytestmark = pytest.mark.process
S = 1_000_000_000
NAME = "20260102T030405678Z-near_miss"
ODOM = StoredChannel(topic="/odom", type_name="nav_msgs/msg/Odometry", definition="float64 x\n" * 90)
IMAGE = StoredChannel(topic="/image", type_name="sensor_msgs/msg/Image", definition="uint8[] data\n")


def write_incident(folder: Path, name: str = NAME, seconds: int = 6) -> Path:
    """Two files of odometry at 20 Hz and images at 2 Hz, with what belongs to an incident."""
    path = folder / name
    path.mkdir(parents=True)
    files: dict[str, FileContent] = {}
    pictures = random.Random(1)
    for number in range(2):
        writer = McapWriter(path / f"{name}_{number}.mcap")
        for tick in range(number * seconds * 20, (number + 1) * seconds * 20):
            writer.write(ODOM, tick * S // 20, tick.to_bytes(8, "little") * 90)
            if tick % 10 == 0:
                # No compression makes it smaller.
                writer.write(IMAGE, tick * S // 20, pictures.randbytes(40_960))
        files[f"{name}_{number}.mcap"] = writer.close()
    (path / METADATA_NAME).write_text(metadata_text(files, [ODOM, IMAGE]))
    record = IncidentRecord(
        name="near miss",
        rule="Close call",
        path="rules.adirf",
        line=3,
        triggered_ns=5 * S,
        from_ns=0,
        to_ns=12 * S,
        values={},
        rules_sha256="",
        topics={"/odom": IncidentTopic(type_name=ODOM.type_name, messages=240, size_bytes=1)},
    )
    (path / "incident.json").write_text(incident_text(record))
    return path


def contents(folder: Path) -> dict[str, bytes]:
    return {path.name: path.read_bytes() for path in folder.iterdir()}


@contextmanager
def listening_robot(
    endpoint: str, folder: Path, name: str = "r1", fetch_budget_kb_per_s: float = math.inf
) -> Iterator[RobotEnd]:
    options = LinkOptions(listen=(endpoint,), fetch_budget_kb_per_s=fetch_budget_kb_per_s)
    with open_robot_end(name, options, refuse_warning) as end:
        end.offer_incidents(folder)
        yield end


@contextmanager
def fetching_from(endpoint: str, robot: str | None = "r1") -> Iterator[LinkIncidents]:
    with open_link_incidents(LinkOptions(connect=(endpoint,)), refuse_warning) as incidents:
        if robot is not None:
            until(lambda: robot in incidents.robots(0))
        yield incidents


def never() -> bool:
    return False


class Progress:
    """What was said of a fetch; ``cancelled`` from ``until_bytes`` on."""

    def __init__(self, until_bytes: float = float("inf")) -> None:
        self.seen: list[FetchProgress] = []
        self.until_bytes = until_bytes

    def __call__(self, progress: FetchProgress) -> None:
        self.seen.append(progress)

    def cancelled(self) -> bool:
        return bool(self.seen) and self.seen[-1].got_bytes >= self.until_bytes


def test_an_incident_is_listed_and_fetched_byte_for_byte(tmp_path: Path) -> None:
    endpoint = free_endpoint()
    path = write_incident(tmp_path / "robot")
    (path / "read").touch()
    with listening_robot(endpoint, path.parent), fetching_from(endpoint) as incidents:
        (one,) = incidents.list("r1")
        assert (one.robot, one.name, one.label, one.rule) == ("r1", NAME, "near miss", "Close call")
        assert one.is_read
        progress = Progress()
        fetched = incidents.fetch("r1", NAME, tmp_path / "here", progress, never)
        assert fetched == tmp_path / "here" / NAME
        expected = contents(path)
        del expected["read"]
        assert contents(fetched) == expected
        assert progress.seen[-1].got_bytes == progress.seen[-1].total_bytes
        assert progress.seen[-1].level_hz == float("inf")
        assert incidents.fetch("r1", NAME, tmp_path / "here", progress, never) == fetched


def test_a_fetch_takes_no_more_than_its_budget(tmp_path: Path) -> None:
    endpoint = free_endpoint()
    path = write_incident(tmp_path / "robot")
    progress = Progress()
    with (
        listening_robot(endpoint, path.parent, fetch_budget_kb_per_s=300) as robot,
        fetching_from(endpoint) as incidents,
    ):
        begun_s = time.monotonic()
        fetched = incidents.fetch(robot.robot, NAME, tmp_path / "here", progress, never)
        took_s = time.monotonic() - begun_s
    assert fetched is not None
    total_bytes = progress.seen[-1].total_bytes
    assert total_bytes > 1_000_000
    # Of the odometry, less than this is left of what is written.
    assert took_s > (total_bytes - 200_000) / 300_000 - 1.5


def test_a_fetch_goes_on_where_it_was_with_another_run_of_the_robot(tmp_path: Path) -> None:
    endpoint = free_endpoint()
    path = write_incident(tmp_path / "robot", seconds=30)
    here = tmp_path / "here"
    with listening_robot(endpoint, path.parent), fetching_from(endpoint) as incidents:
        first = Progress(until_bytes=100_000)
        assert incidents.fetch("r1", NAME, here, first, first.cancelled) is None
    assert [one.name for one in here.iterdir()] == [f".{NAME}.partial"]
    with listening_robot(endpoint, path.parent), fetching_from(endpoint) as incidents:
        second = Progress()
        fetched = incidents.fetch("r1", NAME, here, second, never)
    assert second.seen[0].got_bytes >= first.seen[-1].got_bytes > 0
    assert fetched is not None
    assert contents(fetched) == contents(path)


class Fetcher:
    """A fetch on a thread of its own."""

    def __init__(self, incidents: LinkIncidents, folder: Path) -> None:
        self.progress = Progress()
        self.fetched: Path | None = None
        self._thread = threading.Thread(target=self._run, args=(incidents, folder))
        self._thread.start()

    def _run(self, incidents: LinkIncidents, folder: Path) -> None:
        self.fetched = incidents.fetch("r1", NAME, folder, self.progress, never)

    def join(self) -> Path:
        self._thread.join(4 * WITHIN_S)
        assert self.fetched is not None
        return self.fetched


def test_a_fetch_waits_for_a_robot_that_left_and_goes_on(tmp_path: Path) -> None:
    endpoint = free_endpoint()
    path = write_incident(tmp_path / "robot", seconds=10)
    with operator_end(endpoint, warn=lambda _: None), fetching_from(endpoint, robot=None) as incidents:
        with robot_end(endpoint) as end:
            end.offer_incidents(path.parent)
            until(lambda: "r1" in incidents.robots(0))
            fetcher = Fetcher(incidents, tmp_path / "here")
            seen = fetcher.progress.seen
            until(lambda: bool(seen) and seen[-1].got_bytes > 50_000)
        until(lambda: seen[-1].waits_for == "the robot, which is not there")
        with robot_end(endpoint) as end:
            end.offer_incidents(path.parent)
            assert contents(fetcher.join()) == contents(path)


def test_a_robot_that_is_away_for_a_moment_is_asked_once_it_is_back(tmp_path: Path) -> None:
    endpoint = free_endpoint()
    path = write_incident(tmp_path / "robot")
    with (
        operator_end(endpoint),
        fetching_from(endpoint, robot=None) as incidents,
        ThreadPoolExecutor() as asking,
    ):
        with robot_end(endpoint):
            until(lambda: "r1" in incidents.robots(0))
        until(lambda: incidents.robots(0) == [])
        listed = asking.submit(incidents.list, "r1")
        with robot_end(endpoint) as end:
            end.offer_incidents(path.parent)
            assert [one.name for one in listed.result(WITHIN_S)] == [NAME]


def test_several_fetch_beside_each_other_and_over_the_end_of_an_operator(tmp_path: Path) -> None:
    endpoint = free_endpoint()
    path = write_incident(tmp_path / "robot")
    with operator_end(endpoint) as operator, robot_end(endpoint) as end:
        end.offer_incidents(path.parent)
        until(lambda: end.state.is_connected, lambda: operator.wait(0.01))
        with fetching_from(endpoint) as one, fetching_from(endpoint) as other:
            fetchers = [Fetcher(one, tmp_path / "one"), Fetcher(other, tmp_path / "other")]
            for fetcher in fetchers:
                assert contents(fetcher.join()) == contents(path)


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


@pytest.mark.parametrize(
    "question", [b"", b"malformed", b"\4\x0c\1\x09../../etc", b"\4\x0c\2" + bytes(60), bytes(5_000)]
)
def test_a_stranger_who_asks_what_is_malformed_is_refused_and_others_are_answered(
    tmp_path: Path, question: bytes
) -> None:
    endpoint = free_endpoint()
    path = write_incident(tmp_path / "robot")
    with (
        listening_robot(endpoint, path.parent) as end,
        stranger_at(endpoint, "peer") as session,
    ):
        replies = session.get(end.boot.incidents_key, payload=question, timeout=5.0)
        assert all(one.ok is None for one in replies)
        with fetching_from(endpoint) as incidents:
            fetched = incidents.fetch("r1", NAME, tmp_path / "here", lambda _: None, never)
    assert fetched is not None
    assert contents(fetched) == contents(path)


def test_others_are_answered_while_a_stranger_asks_all_the_time(tmp_path: Path) -> None:
    endpoint = free_endpoint()
    path = write_incident(tmp_path / "robot")
    many = QUESTIONS.to_bytes(
        AskBytes(name=NAME, token=bytes(16), asker=1, got_bytes=2**63, cursor=2**63, size_bytes=MAX_ASK_BYTES)
    )
    with (
        listening_robot(endpoint, path.parent) as end,
        stranger_at(endpoint, "peer") as session,
        fetching_from(endpoint) as incidents,
    ):

        def ask() -> None:
            for _ in range(20_000):
                session.get(end.boot.incidents_key, payload=many, timeout=1.0)

        stranger = threading.Thread(target=ask)
        stranger.start()
        answered = 0
        while stranger.is_alive():
            # A busy machine may answer a single one too late.
            with suppress(LinkError):
                answered += len(incidents.list("r1"))
        assert answered > 0
        fetched = incidents.fetch("r1", NAME, tmp_path / "here", lambda _: None, never)
    assert fetched is not None
    assert contents(fetched) == contents(path)


Answer = Callable[[AskPlan | AskBytes], bytes]
SHA = "00" * 32
LIED = TransferPlan(token=bytes(16), files=(PlannedFile("a.mcap", 3_000, SHA),), levels=())


def whole_piece(ask: AskBytes, file: int = 0, offset: int | None = None, size: int | None = None) -> bytes:
    size = ask.size_bytes if size is None else size
    part = RangePart(ByteRange(file, ask.cursor if offset is None else offset, size), 0, size)
    return PIECES.to_bytes(TransferPiece(parts=(part,), body=bytes(size), advised_bytes=900, waiting=0))


def lie(**changes: object) -> Answer:
    plan = PLANS.to_bytes(replace(LIED, **changes))  # type: ignore[arg-type]

    def answer(question: AskPlan | AskBytes) -> bytes:
        return packed(plan) if isinstance(question, AskPlan) else whole_piece(question)

    return answer


def lying_piece(make: Callable[[AskBytes], bytes]) -> Answer:
    return lambda question: packed(PLANS.to_bytes(LIED)) if isinstance(question, AskPlan) else make(question)


@pytest.mark.parametrize(
    "answer",
    [
        lie(files=(PlannedFile("../../outside", 3_000, SHA),)),
        lie(files=(PlannedFile("/tmp/outside", 3_000, SHA),)),
        lie(files=(PlannedFile("a.mcap", 2**61, SHA),)),
        lie(),
        lying_piece(lambda ask: whole_piece(ask, file=1)),
        lying_piece(lambda ask: whole_piece(ask, offset=2_500)),
        lying_piece(lambda ask: whole_piece(ask, offset=2**50)),
        lying_piece(lambda ask: whole_piece(ask, offset=0)),
        lying_piece(lambda ask: whole_piece(ask, size=ask.size_bytes + 1)),
        lying_piece(lambda _: b"malformed"),
        lying_piece(lambda ask: whole_piece(ask)[:-1]),
        lambda _: b"malformed",
        lambda _: packed(b"\4\x0e" + b"[" * 100_000),
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
            question = QUESTIONS.from_bytes(query.payload.to_bytes())
            with query:
                if isinstance(question, AskPlan) or (isinstance(question, AskBytes) and question.size_bytes):
                    query.reply(end.boot.incidents_key, answer(question))

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
