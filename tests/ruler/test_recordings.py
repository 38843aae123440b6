# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""A recording comes into the project, and rules start from it."""

from __future__ import annotations

from collections.abc import Iterator
from pathlib import Path
from urllib.parse import quote

import pytest

from bags.bag_factory import small_mission, write_bag
from ruler.ruler_server import Answer, Page, served

BYTES = "application/octet-stream"


@pytest.fixture
def bag(tmp_path: Path) -> bytes:
    """The file of a recording of 8 s."""
    write_bag(tmp_path / "elsewhere", small_mission(8))
    (file,) = (one for one in (tmp_path / "elsewhere").iterdir() if one.suffix in {".db3", ".mcap"})
    return file.read_bytes()


@pytest.fixture
def folder(tmp_path: Path) -> Path:
    (tmp_path / "project" / "runs").mkdir(parents=True)
    return tmp_path / "project"


@pytest.fixture
def page(folder: Path) -> Iterator[Page]:
    with served(folder) as page:
        yield page


def test_a_recording_says_what_it_holds(page: Page, folder: Path) -> None:
    write_bag(folder / "monday", small_mission(8))
    answer = page.post("/api/recording", {"bag": "monday"}).json
    assert answer["topics"] == ["/gripper", "/image", "/map_name", "/odom", "/scan"]
    assert answer["duration_s"] == pytest.approx(7.96)
    document = page.post("/api/document", {"text": answer["rules_text"], "name": "a.adirf"}).json
    assert document["parses"]
    assert [each for each in document["findings"] if each["severity"] == "error"] == []
    (part,) = document["collections"]
    assert len(part["statements"]) == len(answer["topics"])


def test_a_file_becomes_a_recording_of_the_project(page: Page, folder: Path, bag: bytes) -> None:
    answer = _sent(page, "runs/monday.db3", bag)
    assert (answer.status, answer.json) == (200, {"bag": "runs/monday.db3"})
    assert (folder / "runs" / "monday.db3").read_bytes() == bag
    assert [one["name"] for one in page.get("/api/project").json["files"]] == ["runs/monday.db3"]


def test_a_recording_is_never_replaced(page: Page, folder: Path) -> None:
    assert _sent(page, "monday.mcap", b"first").status == 200
    refused = _sent(page, "monday.mcap", b"second")
    assert refused.status == 422
    assert refused.json["error"]["place"] == "monday.mcap"
    assert (folder / "monday.mcap").read_bytes() == b"first"


@pytest.mark.parametrize(
    ("name", "status"),
    [
        ("../monday.mcap", 403),
        ("/tmp/monday.mcap", 403),
        ("runs/../../monday.mcap", 403),
        ("monday.adirf", 403),
        (".bashrc", 403),
        (".hidden.mcap", 403),
        ("", 403),
        ("nowhere/monday.mcap", 404),
    ],
)
def test_nothing_else_is_written(page: Page, folder: Path, name: str, status: int) -> None:
    before = sorted(folder.parent.rglob("*"))
    answer = _sent(page, name, b"bytes")
    assert answer.status == status
    assert str(folder).encode() not in answer.body
    assert sorted(folder.parent.rglob("*")) == before


@pytest.mark.parametrize(
    ("path", "more"),
    [
        ("/api/recording", {}),
        ("/api/profile/measure", {}),
        ("/api/background/path", {}),
        ("/api/try", {"text": "begin SetFrequency /odom 5 end"}),
        ("/api/profile/curve", {"topic": "/odom"}),
        ("/api/profile/accuracy", {"topic": "/odom"}),
    ],
)
def test_a_recording_that_cannot_be_read_is_named_as_the_project_does(
    page: Page, folder: Path, path: str, more: dict[str, str]
) -> None:
    (folder / "empty.db3").write_bytes(b"")
    error = page.post(path, {"bag": "empty.db3", **more}).json["error"]
    assert (error["message"], error["place"]) == ("the file is empty", "empty.db3")


def test_a_link_does_not_lead_a_recording_out_of_the_project(page: Page, folder: Path) -> None:
    outside = folder.parent / "outside"
    outside.mkdir()
    (folder / "link").symlink_to(outside)
    assert _sent(page, "link/monday.mcap", b"bytes").status == 403
    assert list(outside.iterdir()) == []


def test_a_link_in_a_recording_does_not_lead_out_of_the_project(page: Page, folder: Path, bag: bytes) -> None:
    inside, outside = folder / "runs" / "monday", folder.parent / "elsewhere"
    inside.mkdir()
    for one in outside.iterdir():
        (inside / one.name).symlink_to(one)
    (folder / "tuesday.db3").write_bytes(bag)
    (folder / "tuesday.db3-wal").symlink_to(outside / "log")
    for name in ("runs/monday", "tuesday.db3"):
        answer = page.post("/api/recording", {"bag": name})
        assert (answer.status, answer.error) == (403, "this names a file outside the project folder")
        assert page.post("/api/try", {"text": "begin end", "bag": name}).status == 403
    (folder / "tuesday.db3-wal").unlink()
    (folder / "runs" / "wednesday.db3").symlink_to("../tuesday.db3")
    assert page.post("/api/recording", {"bag": "runs/wednesday.db3"}).json["topics"]


def test_metadata_do_not_lead_a_recording_out_of_the_project(page: Page, folder: Path, bag: bytes) -> None:
    outside, inside = folder.parent / "outside.db3", folder / "runs" / "monday"
    inside.mkdir()
    metadata = inside / "metadata.yaml"
    for path, is_outside in ((outside, True), (folder / "tuesday.db3", False)):
        path.write_bytes(bag)
        metadata.write_text(f"rosbag2_bagfile_information: {{relative_file_paths: ['{path}']}}")
        answer = page.post("/api/recording", {"bag": "runs/monday"})
        assert answer.status == (403 if is_outside else 200)


@pytest.mark.parametrize("kind", ["text/plain", "application/x-www-form-urlencoded", None])
def test_a_form_of_another_site_sends_no_recording(page: Page, folder: Path, kind: str | None) -> None:
    answer = page.request("PUT", "/api/recording?name=monday.mcap", b"bytes", {"Content-Type": kind})
    assert answer.status == 415
    other = {"Content-Type": BYTES, "Origin": "http://example.org"}
    assert page.request("PUT", "/api/recording?name=monday.mcap", b"bytes", other).status == 403
    assert not (folder / "monday.mcap").exists()


def _sent(page: Page, name: str, data: bytes) -> Answer:
    return page.request("PUT", f"/api/recording?name={quote(name)}", data, {"Content-Type": BYTES})
