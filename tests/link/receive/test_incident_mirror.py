# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""What an operator's end fetches by itself, of robots that come and go."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from pathlib import Path

import pytest

from smarttestudo.domain.errors import LinkError
from smarttestudo.domain.remote_incidents import (
    OUTAGE_NAME,
    OUTAGE_RULE,
    FetchProgress,
    OnProgress,
    RemoteIncident,
)
from smarttestudo.link.receive.incident_mirror import IncidentMirror, MirrorFolders

OUTAGE = RemoteIncident(
    robot="ada",
    name="20260105T080014801Z-outage",
    label=OUTAGE_NAME,
    rule=OUTAGE_RULE,
    triggered_ns=1,
    from_ns=1,
    to_ns=2,
    messages=1,
    size_bytes=5,
)


class Robots:
    """``RemoteIncidents`` in memory; ``asked`` is called when a robot is asked for anything."""

    problem = None

    def __init__(self) -> None:
        self.there = ["ada"]
        self.outages: list[RemoteIncident] = []
        self.asked: Callable[[], None] = lambda: None
        self.error: LinkError | None = None

    def robots(self, within_s: float) -> Sequence[str]:
        return self.there

    def list(self, robot: str) -> Sequence[RemoteIncident]:
        self.asked()
        if robot not in self.there:
            raise LinkError(f"there is no robot {robot!r}")
        if self.error is not None:
            raise self.error
        return self.outages

    def fetch(
        self,
        robot: str,
        name: str,
        folder: Path,
        on_progress: OnProgress,
        cancelled: Callable[[], bool],
    ) -> Path | None:
        path = folder / name
        path.mkdir(parents=True)
        on_progress(FetchProgress(got_bytes=5, total_bytes=5))
        return path


def test_a_robot_that_leaves_while_it_is_asked_is_no_error_and_is_fetched_from_when_it_is_back(
    tmp_path: Path,
) -> None:
    robots, said = Robots(), list[str]()
    mirror = IncidentMirror(robots, MirrorFolders(outages=tmp_path), said.append, pytest.fail)
    robots.asked = robots.there.clear
    mirror.poll()
    robots.asked = lambda: None
    mirror.poll()
    robots.there, robots.outages = ["ada"], [OUTAGE]
    mirror.poll()
    assert said == [f"ada: outage {tmp_path / 'ada' / OUTAGE.name}"]


def test_after_an_error_a_robot_that_comes_back_is_asked_at_once_and_one_that_stays_a_minute_later(
    tmp_path: Path,
) -> None:
    for looks_away, looks_until_asked in ((1, 1), (0, 30)):
        robots, warned, asked = Robots(), list[str](), list[int]()
        mirror = IncidentMirror(robots, MirrorFolders(outages=tmp_path), pytest.fail, warned.append)
        robots.error = LinkError("it does not answer")
        mirror.poll()
        assert [one.partition(" ")[0] for one in warned] == ["ada:"]
        robots.there = []
        for _ in range(looks_away):
            mirror.poll()
        robots.there, robots.error = ["ada"], None
        for look in range(1, 40):
            robots.asked = lambda: asked.append(look)  # noqa: B023
            mirror.poll()
        assert asked[0] == looks_until_asked
