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
from PIL import Image

from bags.bag_factory import message_of
from bags.bag_reading import read_bag
from ruler.incident_projects import (
    ALL_OF_IT,
    CAMERA_INCIDENT,
    COMPRESSED,
    NEAR_MISS,
    RAW,
    RULES,
    TRIGGER_NS,
    add_bad_incidents,
    compressed,
    jpeg,
    raw,
    write_camera_incident,
    write_incidents,
)
from ruler.ruler_server import Answer, Page, served
from smarttestudo.ruler.files.project_folder import ProjectFolder
from smarttestudo.ruler.incidents import incidents

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


def test_the_course_says_when_the_moment_was_and_where_the_robot_was(page: Page) -> None:
    course = page.post("/api/incident/course", {"name": NEAR_MISS}).json
    assert (course["duration_s"], course["trigger_s"], course["cameras"]) == (5, 3, [])
    at_moment = [y for t, _, y in course["path"] if abs(t - 3) < 0.1]
    assert at_moment == [pytest.approx(5.04, abs=0.11)]


def test_the_values_of_a_check_are_on_the_axis_of_the_incident(page: Page) -> None:
    check = {"kind": "check", "topic": "/odom", "property": "pose_y", "op": ">", "value": 5}
    for name, duration_s, trigger_s in ((NEAR_MISS, 5, 3), (ALL_OF_IT, 60.5, 0.5)):
        course = page.post("/api/check/course", {"bag": name, "condition": check}).json
        assert course["duration_s"] == duration_s
        held_from_s = next(t for t, truth in course["check"]["turns"] if truth == "true")
        assert held_from_s == pytest.approx(trigger_s, abs=1e-6)


def frame(page: Page, topic: str, number: int | str = 0, name: str = CAMERA_INCIDENT) -> Answer:
    return page.get(f"/api/incident/frame?name={quote(name)}&topic={quote(topic)}&number={number}")


def test_frames_that_the_incident_kept_are_sent_one_at_a_time(page: Page, folder: Path) -> None:
    write_camera_incident(folder)
    (camera,) = page.post("/api/incident/course", {"name": CAMERA_INCIDENT}).json["cameras"]
    assert camera["topic"] == "/camera/compressed"
    assert camera["numbers"] == list(range(50))
    first_s = camera["times_s"][0]
    assert camera["times_s"] == [pytest.approx(first_s + 0.2 * number) for number in range(50)]
    for number in (0, 7, 49):
        answer = frame(page, "/camera/compressed", number)
        assert answer.body == jpeg(number)
        assert answer.headers["content-type"] == "image/jpeg"
        assert answer.headers["x-content-type-options"] == "nosniff"
        assert answer.headers["content-security-policy"].startswith("default-src 'none'")


def test_of_many_frames_every_second_or_third_is_listed(
    folder: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    write_camera_incident(folder)
    monkeypatch.setattr(incidents, "MAX_FRAMES", 20)
    request = incidents.IncidentCourseRequest(name=CAMERA_INCIDENT)
    course = incidents.incident_course(request, ProjectFolder(folder), lambda _: None)
    (camera,) = course.cameras
    assert camera.numbers == tuple(range(0, 50, 3))


PIXELS = {
    "rgb8": (raw("rgb8", bytes([1, 2, 3, 4, 5, 6, 0, 0]), step=8), [(1, 2, 3), (4, 5, 6)]),
    "bgr8": (raw("bgr8", bytes([3, 2, 1, 6, 5, 4]), step=6), [(1, 2, 3), (4, 5, 6)]),
    "mono8": (raw("mono8", bytes([7, 9]), step=2), [7, 9]),
}


def test_raw_frames_come_as_png(page: Page, folder: Path) -> None:
    write_camera_incident(folder, {f"/{name}": (RAW, message) for name, (message, _) in PIXELS.items()})
    for name, (_, pixels) in PIXELS.items():
        answer = frame(page, f"/{name}")
        assert answer.headers["content-type"] == "image/png"
        with Image.open(io.BytesIO(answer.body)) as image:
            assert [image.getpixel((x, 0)) for x in range(2)] == pixels


NO_FRAMES = {
    "depth": (RAW, raw("16UC1", bytes(4), step=4), "its frames are 16UC1, not rgb8, bgr8 or mono8"),
    "cut": (RAW, raw("rgb8", bytes(5), step=6), "a frame has fewer bytes than its size says"),
    "narrow": (RAW, raw("rgb8", bytes(6), step=3), "a frame has fewer bytes than its size says"),
    "coded": (COMPRESSED, compressed("h264", b"\0\0\0\1g"), "its frames are h264, not JPEG or PNG"),
    "script": (COMPRESSED, compressed("jpeg", b"<script>"), "its frames are jpeg, not JPEG or PNG"),
    "none": ("std_msgs/msg/String", message_of("std_msgs/msg/String"), "no picture, but std_msgs/msg/String"),
}


def test_what_is_no_frame_for_a_browser_is_said(page: Page, folder: Path) -> None:
    write_camera_incident(folder, {f"/{name}": (kind, one) for name, (kind, one, _) in NO_FRAMES.items()})
    for name, (_, _, words) in NO_FRAMES.items():
        answer = frame(page, f"/{name}")
        assert (answer.status, answer.headers["content-type"]) == (422, "application/json")
        assert words in answer.error
    for number in ("-1", "50", "x", "", "9" * 30, "٣"):
        assert frame(page, "/camera/compressed", quote(number)).status == 422


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
        frame(page, "/odom", name=name),
        *(page.post(f"/api/incident/{what}", {"name": name}) for what in ("delete", "course")),
    ]
    assert [answer.status for answer in answers] == [status] * 5
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
