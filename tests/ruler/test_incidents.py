# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""The incidents of a project: listed, opened, saved and deleted; what is wrong with one costs only it."""

from __future__ import annotations

import io
import json
from collections.abc import Callable, Iterator
from pathlib import Path
from typing import Any
from urllib.parse import quote
from zipfile import ZipFile

import pytest

from bags.bag_reading import read_bag
from ruler.incident_projects import (
    ALL_OF_IT,
    NEAR_MISS,
    RULES,
    TRIGGER_NS,
    add_bad_incidents,
    write_incidents,
)
from ruler.ruler_server import Answer, Page, served

WINDOW_START_NS = TRIGGER_NS - 3_000_000_000


@pytest.fixture
def folder(tmp_path: Path) -> Path:
    write_incidents(tmp_path / "project")
    return tmp_path / "project"


@pytest.fixture
def page(folder: Path) -> Iterator[Page]:
    with served(folder) as page:
        yield page


def listed(page: Page) -> list[dict[str, Any]]:
    found: list[dict[str, Any]] = page.get("/api/incidents").json["incidents"]
    return found


def opened(page: Page, name: str) -> Answer:
    return page.post("/api/incident", {"name": name})


def zipped(page: Page, name: str) -> Answer:
    return page.get(f"/api/incident/zip?name={quote(name)}")


def test_all_are_listed_the_newest_first(page: Page, folder: Path) -> None:
    add_bad_incidents(folder)
    found = listed(page)
    assert [one["name"] for one in found] == [
        "incidents/20231114T221401000Z-cut",
        "incidents/20231114T221400000Z-newer",
        NEAR_MISS,
        ALL_OF_IT,
    ]
    assert [one["problem"] for one in found] == [
        "does not hold the record of an incident; was it cut or edited?",
        "version 7 of an incident is not known; read it with the SmartTestudo that wrote it",
        "",
        "",
    ]
    near_miss = found[2]
    files = list((folder / NEAR_MISS).iterdir())
    size_bytes = sum(one.stat().st_size for one in files)
    assert near_miss["incident"] == {
        "robot": "",
        "name": NEAR_MISS.rpartition("/")[2],
        "label": "near miss",
        "rule": "Far",
        "triggered_ns": TRIGGER_NS,
        "from_ns": WINDOW_START_NS,
        "to_ns": TRIGGER_NS + 2_000_000_000,
        "messages": len(read_bag(folder / NEAR_MISS).messages),
        "size_bytes": size_bytes,
        "missing": [],
        "is_read": False,
        "moments": 1,
    }
    assert near_miss["size_bytes"] == size_bytes
    assert found[3]["incident"]["missing"] == ["ended"]


def test_they_may_be_deep_in_the_project_but_not_outside(page: Page, folder: Path) -> None:
    deep = folder / "a" / "b" / "c"
    deep.mkdir(parents=True)
    (folder / "incidents").rename(deep / "incidents")
    (folder.parent / "outside").mkdir()
    (deep / "incidents" / "20231114T221325040Z-all_of_it").rename(folder.parent / "outside" / "other")
    (folder / "link").symlink_to(folder.parent / "outside")
    assert [one["name"] for one in listed(page)] == [f"a/b/c/{NEAR_MISS}"]
    assert opened(page, "link/other").status == 403
    assert zipped(page, "link/other").status == 403


def test_one_says_why_it_was_recorded_and_what_is_missing(page: Page) -> None:
    answer = opened(page, ALL_OF_IT).json
    record = answer["record"]
    assert record["values"] == {"/odom pose_y": 5.04}
    assert answer["units"] == {"/odom pose_y": "m"}
    assert (answer["rule_file"], answer["is_same_text"], record["line"]) == ("far.adirf", True, 9)
    (ended,) = {json.dumps({**one, "topic": ""}) for one in record["missing"]}
    assert json.loads(ended)["reason"] == "ended"
    assert json.loads(ended)["to_ns"] == TRIGGER_NS + 60_000_000_000
    assert set(record["topics"]) == {"/odom", "/gripper", "/map_name", "/scan"}
    assert [one["topic"] for one in record["latched"]] == ["/map_name"]
    came_s = (record["latched"][0]["stamp_ns"] - TRIGGER_NS) / 1e9
    assert came_s == pytest.approx(-5.04, abs=1e-6)


def test_the_page_has_the_record_as_it_is_on_disk(page: Page, folder: Path) -> None:
    written = json.loads((folder / NEAR_MISS / "incident.json").read_text())
    assert opened(page, NEAR_MISS).json["record"].items() <= written.items()


def test_who_opens_one_has_read_it(page: Page) -> None:
    assert opened(page, NEAR_MISS).status == 200
    read = {one["name"]: one["incident"]["is_read"] for one in listed(page)}
    assert read == {NEAR_MISS: True, ALL_OF_IT: False}


def test_another_text_of_the_rule_file_is_said(page: Page, folder: Path) -> None:
    (folder / "far.adirf").write_text(RULES.replace("> 5", "> 6"))
    answer = opened(page, NEAR_MISS).json
    assert (answer["rule_file"], answer["is_same_text"]) == ("far.adirf", False)
    (folder / "far.adirf").rename(folder / "other.adirf")
    answer = opened(page, NEAR_MISS).json
    assert (answer["rule_file"], answer["is_same_text"]) == (None, False)


def test_the_rates_around_the_moment_count_every_message_of_the_window(page: Page, folder: Path) -> None:
    course = page.post("/api/incident/course", {"name": NEAR_MISS}).json
    assert (course["duration_s"], course["trigger_s"]) == (5, 3)
    assert (course["bin_s"], course["first_bin_s"]) == (1, 0)
    rates = {one["topic"]: one["hz_bins"] for one in course["topics"]}
    messages = read_bag(folder / NEAR_MISS).messages
    for topic in ("/odom", "/gripper"):
        stamps = [one.stamp_ns for one in messages if one.topic == topic]
        assert rates[topic] == [
            sum(
                second <= (stamp_ns - WINDOW_START_NS) / 1e9 < second + 1
                or (second == 4 and stamp_ns == WINDOW_START_NS + 5_000_000_000)
                for stamp_ns in stamps
            )
            for second in range(5)
        ]
    # What came before the window is in it, but did not come in it.
    assert sum(rates["/map_name"]) == 0
    at_moment = [y for t, _, y in course["path"] if abs(t - 3) < 0.1]
    assert at_moment == [pytest.approx(5.04, abs=0.11)]


def test_a_bin_begins_at_the_moment_and_what_nobody_heard_is_unknown(page: Page) -> None:
    course = page.post("/api/incident/course", {"name": ALL_OF_IT}).json
    assert (course["trigger_s"], course["bin_s"], course["first_bin_s"]) == (0.5, 1, -0.5)
    (rates,) = (one["hz_bins"] for one in course["topics"] if one["topic"] == "/odom")
    assert len(rates) == 61
    # The recording ends 4.92 s after the moment; half of the first bin is before the window.
    assert rates[:6] == [pytest.approx(25, abs=2.1)] * 6
    assert rates[6:] == [None] * 55


def test_messages_that_are_gone_cost_the_course_only(page: Page, folder: Path) -> None:
    for file in (folder / NEAR_MISS).glob("*.mcap"):
        file.unlink()
    assert opened(page, NEAR_MISS).status == 200
    answer = page.post("/api/incident/course", {"name": NEAR_MISS})
    assert answer.status == 422
    assert len(listed(page)) == 2


def test_a_zip_holds_the_same_bytes(page: Page, folder: Path) -> None:
    opened(page, NEAR_MISS)
    answer = zipped(page, NEAR_MISS)
    name = NEAR_MISS.rpartition("/")[2]
    assert answer.headers["content-disposition"] == f'attachment; filename="{name}.zip"'
    with ZipFile(io.BytesIO(answer.body)) as archive:
        assert archive.testzip() is None
        found = {one: archive.read(one) for one in archive.namelist()}
    # Whether somebody read it here is no part of it.
    expected = {one.name: one.read_bytes() for one in (folder / NEAR_MISS).iterdir() if one.name != "read"}
    assert found == {f"{name}/{file}": data for file, data in expected.items()}


def test_a_zip_has_nothing_that_links_lead_to(page: Page, folder: Path) -> None:
    (folder.parent / "secret").write_text("secret")
    (folder / NEAR_MISS / "more.mcap").symlink_to(folder.parent / "secret")
    with ZipFile(io.BytesIO(zipped(page, NEAR_MISS).body)) as archive:
        assert [one for one in archive.namelist() if "more" in one] == []


def test_one_is_deleted_and_no_other(page: Page, folder: Path) -> None:
    answer = page.post("/api/incident/delete", {"name": NEAR_MISS})
    assert [one["name"] for one in answer.json["incidents"]] == [ALL_OF_IT]
    assert not (folder / NEAR_MISS).exists()
    assert page.post("/api/incident/delete", {"name": NEAR_MISS}).status == 404


def test_one_that_cannot_be_read_can_be_deleted(page: Page, folder: Path) -> None:
    add_bad_incidents(folder)
    assert page.post("/api/incident/delete", {"name": "incidents/20231114T221401000Z-cut"}).status == 200
    assert len(listed(page)) == 3


@pytest.mark.parametrize("other", ["notes.txt", "more"])
def test_a_folder_with_something_else_in_it_stays(page: Page, folder: Path, other: str) -> None:
    path = folder / NEAR_MISS / other
    if other == "notes.txt":
        path.write_text("mine")
    else:
        path.mkdir()
    answer = page.post("/api/incident/delete", {"name": NEAR_MISS})
    assert answer.status == 422
    assert other in answer.error
    assert path.exists()


NOT_INCIDENTS = {
    "": 403,
    "..": 403,
    "/etc": 403,
    "incidents/../../project/incidents": 403,
    "incidents": 404,
    "monday": 404,
    "far.adirf": 404,
    "nowhere": 404,
}


@pytest.mark.parametrize(("name", "status"), NOT_INCIDENTS.items())
def test_nothing_else_is_opened_saved_or_deleted(page: Page, folder: Path, name: str, status: int) -> None:
    before = sorted(folder.parent.rglob("*"))
    answers = [
        opened(page, name),
        zipped(page, name),
        *(page.post(f"/api/incident/{what}", {"name": name}) for what in ("delete", "course")),
    ]
    assert [answer.status for answer in answers] == [status] * 4
    assert all(str(folder).encode() not in answer.body for answer in answers)
    assert sorted(folder.parent.rglob("*")) == before


def _linked(record: Path) -> None:
    record.rename(record.with_name("elsewhere.json"))
    record.symlink_to("elsewhere.json")


def _huge(key: str) -> Callable[[Path], None]:
    def edit(record: Path) -> None:
        record.write_text(json.dumps({**json.loads(record.read_text()), key: 10**400}))

    return edit


def _folder(record: Path) -> None:
    record.unlink()
    record.mkdir()


EDITS: dict[str, Callable[[Path], object]] = {
    "empty": lambda record: record.write_text(""),
    "no object": lambda record: record.write_text("[]"),
    "too large": lambda record: record.write_text(" " * 4_000_001),
    "not UTF-8": lambda record: record.write_bytes(b"\xff\xfe{}"),
    "deep": lambda record: record.write_text("[" * 100_000),
    "huge time": _huge("triggered_ns"),
    "huge line": _huge("line"),
    "link": _linked,
    "folder": _folder,
    "ends before it begins": lambda record: record.write_text(
        record.read_text().replace(f'"to_ns": {TRIGGER_NS + 2_000_000_000}', '"to_ns": 1')
    ),
    "huge value": lambda record: record.write_text(record.read_text().replace("5.04", "1" + 400 * "0")),
}


@pytest.mark.parametrize("what", EDITS)
def test_an_edited_record_costs_only_its_incident(page: Page, folder: Path, what: str) -> None:
    EDITS[what](folder / NEAR_MISS / "incident.json")
    bad, good = listed(page)
    assert (bad["name"], good["problem"]) == (NEAR_MISS, "")
    assert bad["problem"]
    assert bad["incident"] is None
    answer = opened(page, NEAR_MISS)
    assert answer.status == 422
    assert str(folder).encode() not in answer.body
