# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""What an operator's end fetches by itself, of robots that come and go."""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from dataclasses import replace
from pathlib import Path

import pytest

from smarttestudo.domain.errors import LinkError
from smarttestudo.domain.incident import (
    OUTAGE_NAME,
    OUTAGE_RULE,
    FetchProgress,
    OnProgress,
    RemoteIncident,
    SilentRobotError,
)
from smarttestudo.link.receive.incident_mirror import (
    POLL_PERIOD_S,
    STALLED_AFTER_S,
    STARTS_WITHIN_S,
    TURN_S,
    IncidentMirror,
    MirrorFolders,
)

OUTAGE = RemoteIncident(
    robot="ada",
    name="20260105T080014801Z-outage",
    label=OUTAGE_NAME,
    rule=OUTAGE_RULE,
    triggered_ns=1,
    from_ns=1,
    to_ns=2,
    messages=1,
    size_bytes=5_000,
)
SIZE_BYTES = OUTAGE.size_bytes


class Robots:
    """``RemoteIncidents`` in memory; ``asked`` is called when a robot is asked for anything."""

    problem = None

    def __init__(self) -> None:
        self.there = ["ada"]
        self.outages: list[RemoteIncident] = []
        self.asked: Callable[[], None] = lambda: None
        self.error: LinkError | None = None
        self.now_s = 0.0
        self.fetched: list[str] = []
        self.bytes_per_s = {"ada": 1e9, "bob": 1e9}
        self.leaves_at_s = math.inf
        self.got_bytes: dict[tuple[str, str], float] = {}

    def robots(self, within_s: float) -> Sequence[str]:
        assert within_s == 0, "who polls now and then waits for nobody"
        return self.there

    def list(self, robot: str) -> Sequence[RemoteIncident]:
        self.asked()
        if robot not in self.there:
            raise LinkError(f"there is no robot {robot!r}")
        if self.error is not None:
            raise self.error
        return [replace(one, robot=robot) for one in self.outages]

    def steady_s(self) -> float:
        return self.now_s

    def fetch(
        self, robot: str, name: str, folder: Path, on_progress: OnProgress, cancelled: Callable[[], bool]
    ) -> Path | None:
        self.fetched.append(robot)
        speed = self.bytes_per_s[robot]
        while (got_bytes := self.got_bytes.get((robot, name), 0)) < SIZE_BYTES:
            if cancelled():
                return None
            waits_for = None if speed else "a part of the link that topics leave unused"
            on_progress(FetchProgress(got_bytes=int(got_bytes), total_bytes=SIZE_BYTES, waits_for=waits_for))
            self.now_s += 0.5
            self.got_bytes[robot, name] = got_bytes + 0.5 * speed
            if self.now_s >= self.leaves_at_s:
                self.there.remove("ada")
                self.leaves_at_s = math.inf
        path = folder / name
        path.mkdir(parents=True, exist_ok=True)
        (path / "incident.json").touch()
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


def test_at_the_start_what_killed_fetches_only_began_goes_and_nothing_else(tmp_path: Path) -> None:
    begun, going_on, other = (
        tmp_path / "ada" / f".{name}.partial" for name in (OUTAGE.name, f"{OUTAGE.name}-2", "x")
    )
    for path in (begun, going_on, other):
        path.mkdir(parents=True)
        (path / ".fetch.lock").touch()
    (going_on / "a.mcap").write_bytes(b"data")
    (tmp_path / "notes.txt").touch()
    MirrorFolders(outages=tmp_path).make()
    assert [path.exists() for path in (begun, going_on, other)] == [False, True, True]


def test_an_empty_folder_is_fetched_and_one_with_files_is_not_fetched_again(tmp_path: Path) -> None:
    robots, said = Robots(), list[str]()
    robots.outages = [OUTAGE]
    (tmp_path / "ada" / OUTAGE.name).mkdir(parents=True)
    mirror = IncidentMirror(robots, MirrorFolders(outages=tmp_path), said.append, pytest.fail)
    mirror.poll()
    mirror.poll()
    assert said == [f"ada: outage {tmp_path / 'ada' / OUTAGE.name}"]
    assert robots.fetched == ["ada"]


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


def test_a_robot_that_is_still_starting_is_asked_again_at_the_next_look_without_a_word(
    tmp_path: Path,
) -> None:
    warned: list[str] = []
    robots, mirror, said = one_robot(tmp_path, warned)
    robots.error = SilentRobotError("ada does not answer this")
    mirror.poll()
    robots.now_s = STARTS_WITHIN_S - 1
    mirror.poll()
    robots.error, robots.outages = None, [OUTAGE]
    mirror.poll()
    assert (said, warned) == ([f"ada: outage {tmp_path / 'ada' / OUTAGE.name}"], [])


def test_a_robot_that_does_not_answer_is_named_once_it_is_connected_for_long(tmp_path: Path) -> None:
    warned: list[str] = []
    robots, mirror, _ = one_robot(tmp_path, warned)
    robots.error = SilentRobotError("ada does not answer this")
    mirror.poll()
    robots.there = []
    robots.now_s = 100.0
    mirror.poll()
    robots.there = ["ada"]
    mirror.poll()
    assert warned == []
    robots.now_s += STARTS_WITHIN_S
    mirror.poll()
    assert warned == ["ada: error: ada does not answer this"]


def one_robot(folder: Path, warned: list[str]) -> tuple[Robots, IncidentMirror, list[str]]:
    robots, said = Robots(), list[str]()
    folders = MirrorFolders(outages=folder)
    return robots, IncidentMirror(robots, folders, said.append, warned.append, steady_s=robots.steady_s), said


def two_robots(folder: Path, warned: list[str]) -> tuple[Robots, IncidentMirror, list[str]]:
    robots, mirror, said = one_robot(folder, warned)
    robots.there, robots.outages = ["ada", "bob"], [OUTAGE]
    return robots, mirror, said


def test_a_fetch_that_gets_nothing_is_said_once_and_gives_way_to_other_robots(tmp_path: Path) -> None:
    warned: list[str] = []
    robots, mirror, said = two_robots(tmp_path, warned)
    robots.bytes_per_s["ada"] = 0
    for _ in range(35):
        mirror.poll()
    assert said == [f"bob: outage {tmp_path / 'bob' / OUTAGE.name}"]
    assert warned == [f"ada {OUTAGE.name}: waits for a part of the link that topics leave unused"]
    assert robots.fetched == ["ada", "bob", "ada"]
    assert robots.now_s < 2 * STALLED_AFTER_S + 2
    robots.bytes_per_s["ada"] = 1e9
    for _ in range(30):
        mirror.poll()
    assert said[1:] == [f"ada: outage {tmp_path / 'ada' / OUTAGE.name}"]


def test_a_robot_that_is_switched_off_while_it_is_fetched_from_keeps_nobody_waiting(tmp_path: Path) -> None:
    robots, mirror, said = two_robots(tmp_path, [])
    robots.bytes_per_s["ada"], robots.leaves_at_s = 1, 10.0
    mirror.poll()
    assert said == [f"bob: outage {tmp_path / 'bob' / OUTAGE.name}"]
    assert robots.now_s < 11
    robots.there, robots.bytes_per_s["ada"] = ["ada", "bob"], 1e9
    mirror.poll()
    assert said[1:] == [f"ada: outage {tmp_path / 'ada' / OUTAGE.name}"]


def test_robots_take_turns_where_a_fetch_takes_long_and_one_alone_goes_on_at_once(tmp_path: Path) -> None:
    warned: list[str] = []
    robots, mirror, said = two_robots(tmp_path, warned)
    robots.bytes_per_s["ada"] = 50
    assert mirror.poll() == 0
    assert said == [f"bob: outage {tmp_path / 'bob' / OUTAGE.name}"]
    assert robots.now_s < TURN_S + 2
    robots.there = ["ada"]
    assert mirror.poll() == POLL_PERIOD_S
    assert said[1:] == [f"ada: outage {tmp_path / 'ada' / OUTAGE.name}"]
    assert warned == []


def test_what_is_recorded_meanwhile_comes_before_the_rest_of_a_fetch_that_takes_long(tmp_path: Path) -> None:
    robots, mirror, said = one_robot(tmp_path, [])
    old, new = (replace(OUTAGE, name=f"{name}-outage", triggered_ns=ns) for name, ns in (("a", 1), ("b", 2)))
    robots.outages, robots.bytes_per_s["ada"] = [old], 50
    mirror.poll()
    robots.outages = [old, new]
    for _ in range(4):
        mirror.poll()
    assert said == [f"ada: outage {tmp_path / 'ada' / one.name}" for one in (new, old)]
