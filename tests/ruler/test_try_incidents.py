# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""A try shows what rules would have recorded, and keeps it: the same that ``testudo replay`` cuts."""

from __future__ import annotations

import json
import sys
import time
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import pytest

from bags.bag_reading import read_bag
from ruler.incident_projects import ALL_OF_IT, NEAR_MISS, RULES, write_incidents
from ruler.ruler_server import Page, served
from smarttestudo.ruler.rules.document import Draft
from smarttestudo.ruler.tries.keep import MAX_KEEPS
from smarttestudo.ruler.tries.try_rules import TryLimits, try_rules

TRY = {"text": RULES, "name": "far.adirf", "bag": "monday"}


@pytest.fixture
def folder(tmp_path: Path) -> Path:
    """What ``testudo replay`` cut is beside the project, not in it."""
    write_incidents(tmp_path / "project")
    (tmp_path / "project" / "incidents").rename(tmp_path / "incidents")
    return tmp_path / "project"


@pytest.fixture
def page(folder: Path) -> Iterator[Page]:
    with served(folder) as page:
        yield page


def contents(folder: Path) -> dict[str, bytes]:
    return {one.name: one.read_bytes() for one in folder.iterdir()}


def keep(page: Page, number: object = 0, run: str = "a", **change: object) -> dict[str, Any]:
    """What came of the keeping of an incident, once it has ended."""
    answer = page.post("/api/try/keep", {**TRY, "number": number, "run": run, **change})
    assert answer.status == 200, answer.error
    while True:
        [state] = [one for one in page.get("/api/try/keeps").json["keeps"] if one["run"] == run]
        if state["state"] != "running":
            return dict(state)
        # The next look, not a deadline.
        time.sleep(0.02)


def test_a_try_shows_what_a_replay_records(page: Page, folder: Path) -> None:
    tried = page.post("/api/try", TRY).json["incidents"]
    assert [(one["number"], one["record"]["name"], one["record"]["rule"]) for one in tried] == [
        (0, "near miss", "Far"),
        (1, "all of it", "Far"),
    ]
    for one, name in zip(tried, (NEAR_MISS, ALL_OF_IT), strict=True):
        path = folder.parent / name
        record: dict[str, Any] = json.loads((path / "incident.json").read_text())
        messages = read_bag(path).messages
        assert one["t"] == pytest.approx(5.04)
        # The rule file has another path there.
        assert one["record"].items() <= {**record, "file": "far.adirf"}.items()
        topics = one["record"]["topics"].values()
        assert sum(each["messages"] for each in topics) == len(messages)
        assert sum(each["bytes"] for each in topics) == sum(len(each.payload) for each in messages)
    assert not (folder / "incidents").exists()


def test_rules_that_record_nothing_say_so(page: Page) -> None:
    assert page.post("/api/try", {**TRY, "text": RULES.replace("> 5", "> 50")}).json["incidents"] == []
    plain = {"text": "begin SetFrequency /odom 5 end", "bag": "monday"}
    assert page.post("/api/try", plain).json["incidents"] is None


def test_what_is_not_shown_is_said(folder: Path) -> None:
    draft = Draft(text=RULES, name="far.adirf")
    answer = try_rules(draft, folder / "monday", lambda _: None, TryLimits(incidents=1))
    assert answer.incidents is not None
    assert [one.record.name for one in answer.incidents] == ["near miss"]
    assert "only the first 1 of 2 incidents are shown" in answer.notices


@pytest.mark.parametrize(("number", "name"), [(0, NEAR_MISS), (1, ALL_OF_IT)])
def test_what_is_kept_is_what_a_replay_writes(page: Page, folder: Path, number: int, name: str) -> None:
    before = sorted(one.name for one in folder.iterdir())
    assert keep(page, number)["kept"] == name
    kept, cut = contents(folder / name), contents(folder.parent / name)
    # The rule file has another path there.
    record = json.loads(cut["incident.json"])
    assert json.loads(kept.pop("incident.json")) == {**record, "file": "far.adirf"}
    assert kept == {file: data for file, data in cut.items() if file != "incident.json"}
    assert [one.name for one in (folder / "incidents").iterdir()] == [Path(name).name]
    assert sorted(one.name for one in folder.iterdir()) == sorted([*before, "incidents"])
    assert page.get("/api/incidents").json["incidents"][0]["name"] == name


def test_what_is_kept_twice_is_there_once_and_nothing_is_replaced(page: Page, folder: Path) -> None:
    assert keep(page)["kept"] == NEAR_MISS
    assert keep(page)["kept"] == NEAR_MISS
    (folder / NEAR_MISS / "incident.json").write_text("mine")
    assert keep(page)["kept"] == f"{NEAR_MISS}-2"
    assert (folder / NEAR_MISS / "incident.json").read_text() == "mine"


@pytest.mark.parametrize(
    ("change", "status"),
    [
        ({"number": "first"}, 400),
        ({"run": ""}, 422),
        ({"bag": "../monday"}, 403),
        ({"bag": "tuesday"}, 404),
        ({"text": "begin nonsense"}, 409),
    ],
)
def test_what_there_is_not_is_not_kept(
    page: Page, folder: Path, change: dict[str, object], status: int
) -> None:
    before = sorted(folder.rglob("*"))
    assert page.post("/api/try/keep", {**TRY, "number": 0, "run": "a", **change}).status == status
    assert sorted(folder.rglob("*")) == before
    assert page.get("/api/try/keeps").json == {"keeps": []}


@pytest.mark.parametrize("number", [2, -1])
def test_an_incident_that_there_is_not_leaves_nothing_and_says_why(
    page: Page, folder: Path, number: int
) -> None:
    before = sorted(folder.rglob("*"))
    kept = keep(page, number, title="near miss")
    assert (kept["state"], kept["title"], kept["kept"]) == ("failed", "near miss", None)
    assert kept["problem"].startswith("the recording gives no such incident. ")
    assert sorted(folder.rglob("*")) == before


@pytest.fixture
def endless(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> pytest.MonkeyPatch:
    """Each process for work does nothing and never ends by itself, until this is undone."""
    program = tmp_path / "endless"
    program.write_text("#!/bin/sh\nexec sleep 1000\n")
    program.chmod(0o755)
    monkeypatch.setattr(sys, "executable", str(program))
    return monkeypatch


def test_keeping_goes_on_without_the_page_until_it_is_cancelled_or_the_server_ends(
    folder: Path, endless: pytest.MonkeyPatch
) -> None:
    before = sorted(folder.rglob("*"))
    with served(folder) as page:
        for run in ("a", "b"):
            page.post("/api/try/keep", {**TRY, "number": 0, "run": run, "title": f"{run}!"})
        cancelled = page.post("/api/try/keep/cancel", {"run": "b"}).json["keeps"]
        assert [(one["run"], one["title"], one["bag"]) for one in cancelled] == [("a", "a!", "monday")]
        assert page.post("/api/try/keep/cancel", {"run": "a"}).json == {"keeps": []}
        assert sorted(folder.rglob("*")) == before
        endless.undo()
        page.post("/api/try/keep", {**TRY, "number": 0, "run": "c"})
    assert [one for one in folder.iterdir() if one.name.startswith(".keeping")] == []


def test_what_has_ended_is_told_until_it_is_read_and_stays_kept(page: Page, folder: Path) -> None:
    assert keep(page)["kept"] == NEAR_MISS
    assert page.post("/api/try/keep/cancel", {"run": "a"}).json == {"keeps": []}
    assert (folder / NEAR_MISS / "incident.json").exists()


@pytest.mark.usefixtures("endless")
def test_so_many_are_kept_at_once_and_no_more(page: Page) -> None:
    for run in range(MAX_KEEPS):
        assert page.post("/api/try/keep", {**TRY, "number": 0, "run": f"{run}"}).status == 200
    assert page.post("/api/try/keep", {**TRY, "number": 0, "run": "one more"}).status == 422


def test_a_file_where_the_folder_should_be_stays(page: Page, folder: Path) -> None:
    (folder / "incidents").write_text("mine")
    assert keep(page)["state"] == "failed"
    assert (folder / "incidents").read_text() == "mine"
    assert [one.name for one in folder.iterdir() if one.name.startswith(".keeping")] == []


def test_a_link_does_not_lead_what_is_kept_out_of_the_project(page: Page, folder: Path) -> None:
    (folder.parent / "outside").mkdir()
    (folder / "incidents").symlink_to(folder.parent / "outside")
    assert keep(page)["state"] == "failed"
    assert list((folder.parent / "outside").iterdir()) == []
