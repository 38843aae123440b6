# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""What robots on a link recorded: listed by the page, and fetched into the project byte for byte."""

from __future__ import annotations

import logging
import threading
import time
from collections.abc import Iterator
from concurrent.futures import ThreadPoolExecutor
from contextlib import ExitStack, nullcontext
from functools import partial
from pathlib import Path
from typing import Any, cast

import pytest

from link.zenoh.ends import WITHIN_S, free_endpoint, refuse_warning
from ruler.incident_projects import ALL_OF_IT, NEAR_MISS, write_incidents
from ruler.ruler_server import Page, served
from smarttestudo.domain.incident import RemoteIncidents
from smarttestudo.link.zenoh import open_link_incidents, open_robot_end
from smarttestudo.link.zenoh.security import LinkOptions

pytestmark = pytest.mark.full
NAME = NEAR_MISS.rpartition("/")[2]
KEPT = f"incidents/ada/{NAME}"
ONE = {"robot": "ada", "name": NAME}


@pytest.fixture
def robot(tmp_path: Path) -> Path:
    """The folder of a robot's incidents."""
    write_incidents(tmp_path / "robot")
    return tmp_path / "robot"


@pytest.fixture
def page(tmp_path: Path, robot: Path) -> Iterator[Page]:
    """The page of an empty project, beside a robot that is called ada."""
    (tmp_path / "project").mkdir()
    endpoint = free_endpoint()
    options = LinkOptions(connect=(endpoint,))
    with open_robot_end("ada", LinkOptions(listen=(endpoint,)), refuse_warning) as end:
        end.offer_incidents(robot / "incidents")
        opened = partial(open_link_incidents, options, refuse_warning)
        with served(tmp_path / "project", open_incidents=opened) as page:
            yield page


def asked(page: Page) -> list[dict[str, Any]]:
    """The incidents of the one robot, once it is heard and has told them."""
    found: list[dict[str, Any]] = of_ada(page)["incidents"]
    return found


def kept(page: Page) -> dict[str, str]:
    """What the project calls those that were fetched."""
    names: dict[str, str] = of_ada(page)["kept"]
    return names


def of_ada(page: Page) -> dict[str, Any]:
    deadline_s = time.monotonic() + WITHIN_S
    while time.monotonic() < deadline_s:
        answer = page.get("/api/robot-incidents").json
        assert answer["is_linked"]
        if answer["robots"]:
            (ada,) = answer["robots"]
            assert ada["robot"] == "ada"
            # A machine that stands still may have it answer too late.
            if not ada["problem"]:
                found: dict[str, Any] = ada
                return found
    raise AssertionError(answer)


def fetched(page: Page, state: str) -> dict[str, Any]:
    """The one fetch, once it is in ``state``."""
    deadline_s = time.monotonic() + WITHIN_S
    while time.monotonic() < deadline_s:
        (fetch,) = page.get("/api/robot-incidents/fetches").json["fetches"]
        if fetch["state"] == state:
            found: dict[str, Any] = fetch
            return found
        time.sleep(0.05)
    raise AssertionError(fetch)


def test_a_robots_incidents_are_listed_and_fetched_byte_for_byte(
    page: Page, robot: Path, tmp_path: Path
) -> None:
    listed = {one["name"]: one for one in asked(page)}
    assert set(listed) == {NAME, ALL_OF_IT.rpartition("/")[2]}
    one = listed[NAME]
    assert (one["robot"], one["label"]) == ("ada", "near miss")
    assert (one["triggered_ns"] - one["from_ns"], one["to_ns"] - one["triggered_ns"]) == (
        3 * 10**9,
        2 * 10**9,
    )
    assert kept(page) == {}
    assert page.post("/api/robot-incidents/fetch", ONE).status == 200
    done = fetched(page, "done")
    assert (done["kept"], done["problem"]) == (KEPT, "")
    assert done["progress"]["got_bytes"] == done["progress"]["total_bytes"] > 0
    assert {one.name: one.read_bytes() for one in (tmp_path / "project" / KEPT).iterdir()} == {
        one.name: one.read_bytes() for one in (robot / NEAR_MISS).iterdir()
    }
    assert [one["name"] for one in page.get("/api/incidents").json["incidents"]] == [KEPT]
    assert kept(page) == {NAME: KEPT}


def test_a_cancelled_fetch_goes_on_later(page: Page, robot: Path, tmp_path: Path) -> None:
    """A larger incident, so that it takes a while; whether it was cancelled in time does not matter."""
    with (robot / NEAR_MISS / "more.mcap").open("wb") as file:
        file.write(bytes(range(256)) * 40_000)
    asked(page)
    page.post("/api/robot-incidents/fetch", ONE)
    page.post("/api/robot-incidents/cancel", ONE)
    deadline_s = time.monotonic() + WITHIN_S
    while page.get("/api/robot-incidents/fetches").json["fetches"][0]["state"] == "running":
        assert time.monotonic() < deadline_s
        time.sleep(0.05)
    page.post("/api/robot-incidents/fetch", ONE)
    assert fetched(page, "done")["kept"] == KEPT
    assert {one.name: one.read_bytes() for one in (tmp_path / "project" / KEPT).iterdir()} == {
        one.name: one.read_bytes() for one in (robot / NEAR_MISS).iterdir()
    }


def test_what_the_robot_does_not_have_fails_with_a_reason(page: Page) -> None:
    asked(page)
    page.post("/api/robot-incidents/fetch", {"robot": "ada", "name": "20260101T000000000Z-none"})
    assert fetched(page, "failed")["problem"]


def test_who_is_there_is_told_without_a_question_to_robots(page: Page) -> None:
    assert page.get("/api/robot-incidents/fetches").json == {"fetches": [], "heard": []}
    asked(page)
    assert page.get("/api/robot-incidents/fetches").json == {"fetches": [], "heard": ["ada"]}


@pytest.mark.parametrize("name", ["../up", "/etc", "a/b", "", ".hidden", "x" * 101])
@pytest.mark.parametrize("which", ["robot", "name"])
def test_no_name_leads_out_of_the_folder(page: Page, tmp_path: Path, which: str, name: str) -> None:
    assert page.post("/api/robot-incidents/fetch", {**ONE, which: name}).status == 403
    assert list((tmp_path / "project").iterdir()) == []


class Silent:
    """Robots of which nobody knows in time whether they are there."""

    problem = None

    def __init__(self) -> None:
        self.asked, self.ended = threading.Event(), threading.Event()

    def robots(self, _within_s: float) -> list[str]:
        self.asked.set()
        self.ended.wait(WITHIN_S)
        return []


def test_a_server_that_ends_while_robots_are_asked_says_so_in_one_line(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    silent = Silent()

    def end_when_cut(record: logging.LogRecord) -> bool:
        # The server waits for its thread, so that this must end before it.
        if "Cancel 1 running task" in record.getMessage():
            silent.ended.set()
        return True

    with ThreadPoolExecutor() as asking, ExitStack() as at_end:
        log = logging.getLogger("uvicorn.error")
        at_end.callback(log.removeFilter, end_when_cut)
        with served(tmp_path, open_incidents=lambda: nullcontext(cast("RemoteIncidents", silent))) as page:
            log.addFilter(end_when_cut)
            cut = asking.submit(page.get, "/api/robot-incidents")
            assert silent.asked.wait(WITHIN_S)
        assert cut.result().status == 500
    said = capsys.readouterr().err.splitlines()
    assert [line for line in said if "Cancel 1 running task" not in line] == []


def test_without_a_link_nothing_is_asked(tmp_path: Path) -> None:
    (tmp_path / "project").mkdir()
    with served(tmp_path / "project") as page:
        answer = page.get("/api/robot-incidents").json
        assert (answer["is_linked"], answer["robots"]) == (False, [])
        assert page.post("/api/robot-incidents/fetch", ONE).status == 422
        assert page.post("/api/robot-incidents/cancel", ONE).json == {"fetches": [], "heard": []}
