# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""Incidents that are listed and fetched over a link of this machine, and strangers at both ends of it."""

from __future__ import annotations

import threading
import time
from contextlib import suppress
from pathlib import Path

import pytest

from link.zenoh.ends import WITHIN_S, free_endpoint, operator_end, robot_end, stranger_at, until
from link.zenoh.fetched_incidents import (
    NAME,
    Progress,
    contents,
    fetching_from,
    listening_robot,
    never,
    write_incident,
)
from smarttestudo.domain.errors import LinkError
from smarttestudo.link.transfer.messages import ASKS, VERSION_BYTES, Ask
from smarttestudo.link.zenoh.incidents import LinkIncidents

pytestmark = pytest.mark.full


@pytest.mark.contract
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


@pytest.mark.contract
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


@pytest.mark.contract
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


def test_several_fetch_beside_each_other_and_over_the_end_of_an_operator(tmp_path: Path) -> None:
    endpoint = free_endpoint()
    path = write_incident(tmp_path / "robot", seconds=2)
    with operator_end(endpoint) as operator, robot_end(endpoint) as end:
        end.offer_incidents(path.parent)
        until(lambda: end.state.is_connected, lambda: operator.wait(0.01))
        with fetching_from(endpoint) as one, fetching_from(endpoint) as other:
            fetchers = [Fetcher(one, tmp_path / "one"), Fetcher(other, tmp_path / "other")]
            for fetcher in fetchers:
                assert contents(fetcher.join()) == contents(path)


def test_others_are_answered_while_a_stranger_asks_all_the_time(tmp_path: Path) -> None:
    endpoint = free_endpoint()
    path = write_incident(tmp_path / "robot")
    many = ASKS.to_bytes(
        Ask(name=f"{NAME}/files", version=bytes(VERSION_BYTES), asker=1, got_bytes=2**63, offset=2**63)
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
