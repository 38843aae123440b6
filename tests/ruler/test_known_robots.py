# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""Robots stay in the list until somebody removes them."""

from __future__ import annotations

import json
import time
from collections.abc import Iterator, Mapping, Sequence
from contextlib import contextmanager
from dataclasses import replace
from pathlib import Path

import pytest

from robot.status.statuses import RELAYED, STATUS, WELL
from smarttestudo.domain.parameter import Got, Values, WasSet
from smarttestudo.domain.remote_robots import GotTopics, HeardStatus
from smarttestudo.ruler.files.project_folder import ProjectFolder
from smarttestudo.ruler.job import RequestError
from smarttestudo.ruler.robots.known import KNOWN_FOLDER, MAX_KNOWN, KnownRobots
from smarttestudo.ruler.robots.link import RobotLink, UnknownRobotError
from smarttestudo.ruler.robots.view import robot_summaries
from smarttestudo.ruler.robots.watch import RobotWatch, RuleWords, seen_robot

DAY_S = 86_400.0


class Robots:
    """Robots that are heard when a test says so."""

    place, remedy, problem, unreadable, has_heard_all = "here", "", None, 0, True

    def __init__(self) -> None:
        self.heard: dict[str, HeardStatus] = {}

    def wait(self, timeout_s: float) -> None:
        time.sleep(0.001)

    def forget(self, robot_id: str) -> None:
        self.heard.pop(robot_id, None)

    def get(self, robot_id: str, names: Sequence[str], got: Got) -> None: ...

    def set(self, robot_id: str, values: Values, was_set: WasSet) -> None: ...

    def topics(self, robot_id: str | None, got: GotTopics) -> None: ...


def heard(name: str, heard_s: float) -> HeardStatus:
    return HeardStatus(status=replace(WELL, robot=name), heard_s=heard_s, size_bytes=900)


def known(folder: Path, now_s: float = 0.0) -> KnownRobots:
    return KnownRobots(ProjectFolder(folder), steady_s=lambda: 100.0, now_s=lambda: 1e9 + now_s)


def test_another_server_knows_when_each_was_heard_last_and_what_it_followed(tmp_path: Path) -> None:
    known(tmp_path).write([heard("ada", 40.0), heard("bob", 90.0)])
    ada, bob = sorted(known(tmp_path, now_s=DAY_S).read().values(), key=lambda one: one.status.robot_id)
    assert (100.0 - ada.heard_s, 100.0 - bob.heard_s) == (60.0 + DAY_S, 10.0 + DAY_S)
    (first, _) = robot_summaries([seen_robot(one, RuleWords()) for one in (bob, ada)], 100.0)
    assert first.label == "ada"
    assert first.health is not None
    assert (first.health.level, first.health.summary) == ("error", "silent for 24 h")
    assert first.rules.paths == WELL.rules.paths
    assert (tmp_path / KNOWN_FOLDER / ".gitignore").read_text() == "*\n"


@pytest.mark.parametrize(
    "text",
    [
        "",
        "{",
        "[" * 50_000,
        "{}",
        "[1, [2], [3, {}], [NaN, {}], [1e999, {}], [true, {}], [1.0, {}, 2]]",
        '[[1.0, {"node": 3}]]',
    ],
)
def test_a_file_that_anybody_wrote_gives_no_robots(tmp_path: Path, text: str) -> None:
    (tmp_path / KNOWN_FOLDER).mkdir(parents=True)
    (tmp_path / KNOWN_FOLDER / "heard.json").write_text(text)
    assert known(tmp_path).read() == {}


def test_so_many_are_kept_and_none_whose_names_are_endless(tmp_path: Path) -> None:
    many = [heard(f"r{number}", float(number)) for number in range(MAX_KNOWN + 20)]
    known(tmp_path).write([*many, heard("x" * 9000, 1e6), heard("twin#1a2b", 1e6)])
    names = {one.status.robot for one in known(tmp_path).read().values()}
    assert names == {f"r{number}" for number in range(22, MAX_KNOWN + 20)}
    assert all(len(row) == 2 for row in json.loads((tmp_path / KNOWN_FOLDER / "heard.json").read_text()))


def test_a_robot_that_is_silent_for_days_is_still_seen_and_the_longest_silent_first() -> None:
    now_s = 0.0
    robots = Robots()
    watch = RobotWatch(robots, lambda: now_s, {"old:/smarttestudo": heard("old", -DAY_S)})
    robots.heard = {"ada:/smarttestudo": heard("ada", 0.0)}
    watch.poll()
    now_s = 3 * DAY_S
    robots.heard["bob:/smarttestudo"] = heard("bob", now_s)
    dead = replace(WELL, robot="dead", topics={"/imu": replace(RELAYED, publishers=0, silence=None)})
    robots.heard["dead:/smarttestudo"] = replace(heard("dead", now_s), status=dead)
    watch.poll()
    labels = [one.label for one in robot_summaries(watch.seen.values(), now_s)]
    assert labels == ["old", "ada", "bob", "dead"]
    watch.remove("ada:/smarttestudo")
    watch.poll()
    assert "ada:/smarttestudo" not in watch.seen


def test_runs_of_one_name_that_are_told_apart_no_more_leave_no_ghost() -> None:
    robots = Robots()
    watch = RobotWatch(robots, lambda: 0.0)
    robots.heard = {one.status.robot_id: one for one in (heard("#1", 0.0), heard("#2", 0.0))}
    watch.poll()
    robots.heard = {"/smarttestudo": heard("", 1.0)}
    watch.poll()
    assert list(watch.seen) == ["/smarttestudo"]


@contextmanager
def linked(folder: Path, robots: Robots) -> Iterator[RobotLink]:
    @contextmanager
    def opened() -> Iterator[Robots]:
        yield robots

    link = RobotLink(opened, KnownRobots(ProjectFolder(folder)))
    link.begin()
    try:
        yield link
    finally:
        link.close()


def until_seen(link: RobotLink, names: Mapping[str, object] | set[str]) -> None:
    end_s = time.monotonic() + 20
    while set(link.seen) != set(names):
        assert time.monotonic() < end_s
        time.sleep(0.01)


def test_a_server_that_starts_again_shows_the_robot_until_somebody_removes_it(tmp_path: Path) -> None:
    name = WELL.robot_id
    robots = Robots()
    robots.heard = {name: HeardStatus(status=WELL, heard_s=time.monotonic(), size_bytes=900)}
    with linked(tmp_path, robots) as link:
        until_seen(link, {name})
        with pytest.raises(RequestError):
            link.remove(name)
    with linked(tmp_path, Robots()) as link:
        assert not link.seen[name].is_heard(time.monotonic())
        link.remove(name)
        until_seen(link, set())
        with pytest.raises(UnknownRobotError):
            link.remove(name)
    with linked(tmp_path, Robots()) as link:
        assert link.seen == {}


def test_where_nothing_can_be_written_robots_are_seen_all_the_same(tmp_path: Path) -> None:
    (tmp_path / ".testudo").write_text("no folder")
    robots = Robots()
    robots.heard = {STATUS.robot_id: HeardStatus(status=STATUS, heard_s=time.monotonic(), size_bytes=900)}
    with linked(tmp_path, robots) as link:
        until_seen(link, {STATUS.robot_id})
