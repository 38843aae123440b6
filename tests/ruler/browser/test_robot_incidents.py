# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""A robot's incidents on the page: there at once, fetched by a button, and then like all others."""

from __future__ import annotations

import re
from collections.abc import Iterator
from contextlib import ExitStack
from pathlib import Path

import pytest
from playwright.sync_api import Locator, expect

from axe import violations
from link.zenoh.ends import refuse_warning
from ruler.browser.ruler_page import RulerPage
from ruler.incident_projects import NEAR_MISS, write_incidents
from smarttestudo.link.zenoh import open_robot_end
from smarttestudo.link.zenoh.security import LinkOptions

NAME = NEAR_MISS.rpartition("/")[2]
GONE = re.compile("there is no robot 'ada'|it cannot be reached")


class Robot:
    """A robot, ada, whose incidents can be had while it is there."""

    def __init__(self, folder: Path, port: int) -> None:
        self.endpoint = f"tcp/127.0.0.1:{port}"
        self._folder = folder
        self._open = ExitStack()

    def come(self) -> None:
        end = self._open.enter_context(
            open_robot_end("ada", LinkOptions(listen=(self.endpoint,)), refuse_warning)
        )
        end.offer_incidents(self._folder)

    def leave(self) -> None:
        self._open.close()


@pytest.fixture
def ada(tmp_path: Path, robot_port: int) -> Iterator[Robot]:
    write_incidents(tmp_path / "robot")
    ada = Robot(tmp_path / "robot" / "incidents", robot_port)
    ada.come()
    yield ada
    ada.leave()


@pytest.fixture
def options(ada: Robot) -> tuple[str, ...]:
    return ("--connect", ada.endpoint)


@pytest.fixture
def project(tmp_path: Path) -> Path:
    (tmp_path / "project").mkdir()
    return tmp_path / "project"


@pytest.mark.journey
def test_a_robots_incident_is_fetched_and_opened(ruler: RulerPage, project: Path, tmp_path: Path) -> None:
    ruler.page.get_by_role("link", name="Incidents", exact=True).click()
    near_miss = _near_miss(ruler)
    expect(near_miss).to_contain_text("3 s before to 2 s after")
    assert violations(ruler.page) == []
    near_miss.get_by_role("button", name="Fetch: near miss of ada").click()
    near_miss.get_by_role("link", name="Open it").wait_for()
    expect(ruler.page.get_by_text("1 incident, 1 not read yet")).to_be_visible()
    near_miss.get_by_role("link", name="Open it").click()
    expect(ruler.page.get_by_role("main")).to_contain_text("/odom pose_y was 5.04 m")
    assert _same_bytes(project, tmp_path)


def test_a_robot_that_left_is_named_and_its_incident_fetched_when_it_is_back(
    ruler: RulerPage, ada: Robot, project: Path, tmp_path: Path
) -> None:
    ruler.page.get_by_role("link", name="Incidents", exact=True).click()
    near_miss = _near_miss(ruler)
    near_miss.wait_for()
    ada.leave()
    expect(_heading(ruler)).to_contain_text("2 incidents, not heard now")
    fetch = near_miss.get_by_role("button", name="Fetch: near miss of ada")
    fetch.click()
    expect(near_miss.get_by_role("alert")).to_contain_text(GONE)
    assert not (project / "incidents" / "ada" / NAME).exists()
    ada.come()
    expect(_heading(ruler)).not_to_contain_text("not heard now")
    fetch.click()
    near_miss.get_by_role("link", name="Open it").wait_for()
    assert _same_bytes(project, tmp_path)


def test_a_robot_that_comes_later_is_asked_by_itself(ruler: RulerPage, ada: Robot) -> None:
    ada.leave()
    ruler.page.get_by_role("link", name="Incidents", exact=True).click()
    on_robots = ruler.page.get_by_role("region", name="On robots")
    on_robots.get_by_text("cannot be reached").wait_for()
    ada.come()
    _near_miss(ruler).wait_for()
    expect(on_robots.get_by_text("cannot be reached")).to_have_count(0)


def _heading(ruler: RulerPage) -> Locator:
    return ruler.page.get_by_role("heading", name=re.compile(r"^ada \d"))


def _near_miss(ruler: RulerPage) -> Locator:
    on_ada = ruler.page.get_by_role("table", name="Incidents on ada")
    return on_ada.get_by_role("row").filter(has_text="near miss")


def _same_bytes(project: Path, tmp_path: Path) -> bool:
    """Whether the project has of the incident what the robot has."""
    fetched, kept = project / "incidents" / "ada" / NAME, tmp_path / "robot" / NEAR_MISS
    return {one.name: one.read_bytes() for one in fetched.iterdir() if one.name != "read"} == {
        one.name: one.read_bytes() for one in kept.iterdir()
    }
