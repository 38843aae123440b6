# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""Each save of a rule file keeps a version, in the project and nowhere else."""

from __future__ import annotations

from collections.abc import Iterator
from pathlib import Path
from urllib.parse import quote

import pytest

from ruler.ruler_server import Answer, Page, served
from smarttestudo.ruler.files.drafts import DraftStore
from smarttestudo.ruler.files.project import SaveRequest, read_file, save
from smarttestudo.ruler.files.project_folder import ForbiddenPathError, ProjectFolder
from smarttestudo.ruler.files.versions import MAX_VERSIONS, VersionStore

RULES = "begin\n    SetFrequency /odom 10\nend\n"
MINUTE_MS = 60_000
START_MS = 1_800_000_000_000
"""A moment at which five minutes of the clock begin."""


@pytest.fixture
def folder(tmp_path: Path) -> Path:
    (tmp_path / "project" / "zones").mkdir(parents=True)
    (tmp_path / "project" / "zones" / "a.adirf").write_text(RULES)
    return tmp_path / "project"


@pytest.fixture
def page(folder: Path) -> Iterator[Page]:
    with served(folder) as page:
        yield page


def test_each_version_says_what_it_changed(page: Page, folder: Path) -> None:
    _save(page, RULES.replace("10", "7"))
    _save(page, RULES.replace("10", "7").replace("begin", "// slower\nbegin"))
    _save(page, RULES.replace("10", "7\n    SetFrequency"))
    answer = page.get("/api/versions?name=zones/a.adirf").json
    said = [(each["changes"], each["parses"]) for each in answer["versions"]]
    assert said == [
        ([], False),
        ([], True),
        (["default: /odom 10 → 7 Hz"], True),
        (None, True),
    ]
    kept = [_version(page, each["id"]).json["text"] for each in answer["versions"]]
    assert kept[0] == (folder / "zones" / "a.adirf").read_text()
    assert kept[-1] == RULES
    assert answer["folder"] == ".testudo/versions"


def test_what_another_program_wrote_between_two_saves_is_a_version(page: Page, folder: Path) -> None:
    _save(page, RULES.replace("10", "7"))
    (folder / "zones" / "a.adirf").write_text(RULES.replace("10", "8"))
    _save(page, RULES.replace("10", "9"))
    changes = [each["changes"] for each in page.get("/api/versions?name=zones/a.adirf").json["versions"]]
    assert changes == [
        ["default: /odom 8 → 9 Hz"],
        ["default: /odom 7 → 8 Hz"],
        ["default: /odom 10 → 7 Hz"],
        None,
    ]


def test_the_same_text_is_one_version(page: Page) -> None:
    _save(page, RULES)
    _save(page, RULES)
    assert len(page.get("/api/versions?name=zones/a.adirf").json["versions"]) == 1


def test_versions_are_no_files_of_the_project(page: Page, folder: Path) -> None:
    _save(page, RULES.replace("10", "7"))
    assert [one["name"] for one in page.get("/api/project").json["files"]] == ["zones/a.adirf"]
    assert (folder / ".testudo" / "versions" / ".gitignore").read_text() == "*\n"


def test_the_last_twenty_versions_are_kept(folder: Path) -> None:
    store = VersionStore(ProjectFolder(folder))
    for number in range(MAX_VERSIONS + 5):
        store.keep("zones/a.adirf", f"// {number}\n", START_MS + number * MINUTE_MS)
    versions = store.versions("zones/a.adirf")
    assert len(versions) == MAX_VERSIONS
    assert [store.text("zones/a.adirf", versions[place].id) for place in (0, -1)] == ["// 24\n", "// 5\n"]


def test_a_clock_that_was_set_back_keeps_the_order(folder: Path) -> None:
    store = VersionStore(ProjectFolder(folder))
    store.keep("zones/a.adirf", "// first\n", START_MS)
    store.keep("zones/a.adirf", "// second\n", START_MS - MINUTE_MS)
    assert [store.text("zones/a.adirf", one.id) for one in store.versions("zones/a.adirf")] == [
        "// second\n",
        "// first\n",
    ]


def test_a_save_without_room_for_versions_is_still_a_save(folder: Path) -> None:
    (folder / ".testudo").write_text("in the way")
    project = ProjectFolder(folder)
    request = SaveRequest(
        name="zones/a.adirf", text="// new\n", base_hash=read_file("zones/a.adirf", project).hash
    )
    saved = save(request, project, DraftStore(project), VersionStore(project, lambda: 0.0))
    assert "the version cannot be written" in saved.note
    assert (folder / "zones" / "a.adirf").read_text() == "// new\n"


@pytest.mark.parametrize(
    "name", ["../a.adirf", "/etc/passwd", "zones/../../a.adirf", "", ".", "a.toml", ".testudo/x", "a\0.adirf"]
)
def test_versions_of_other_files_are_refused(page: Page, name: str) -> None:
    assert page.get(f"/api/versions?name={quote(name)}").status == 403
    assert page.post("/api/version", {"name": name, "id": "20261123T010101000Z"}).status == 403


@pytest.mark.parametrize(
    "version_id",
    [
        "",
        "..",
        "../../../secret",
        "20261123T010101000Z/../../../../a",
        "20261123T010101000Z\n",
        "²0261123T010101000Z",
    ],
)
def test_a_version_is_named_by_its_moment_only(page: Page, version_id: str) -> None:
    assert _version(page, version_id).status == 403


def test_a_version_that_is_not_there_is_said(page: Page) -> None:
    answer = _version(page, "20261123T010101000Z")
    assert (answer.status, answer.error) == (404, "this version is no longer kept")


def test_a_link_does_not_lead_versions_out_of_the_project(folder: Path, tmp_path: Path) -> None:
    outside = tmp_path / "outside"
    outside.mkdir()
    (folder / ".testudo").symlink_to(outside)
    store = VersionStore(ProjectFolder(folder))
    with pytest.raises(ForbiddenPathError):
        store.keep("zones/a.adirf", RULES, START_MS)
    assert list(outside.iterdir()) == []


def test_a_link_among_the_versions_is_no_version(folder: Path, tmp_path: Path) -> None:
    store = VersionStore(ProjectFolder(folder))
    store.keep("zones/a.adirf", RULES, START_MS)
    (tmp_path / "secret").write_text("secret")
    place = folder / ".testudo" / "versions" / "zones" / "a.adirf"
    (place / "20300101T000000000Z.adirf").symlink_to(tmp_path / "secret")
    assert len(store.versions("zones/a.adirf")) == 1
    with pytest.raises(ForbiddenPathError):
        store.text("zones/a.adirf", "20300101T000000000Z")


def _save(page: Page, text: str) -> None:
    known = page.get("/api/file?name=zones/a.adirf").json["hash"]
    answer = page.put("/api/file", {"name": "zones/a.adirf", "text": text, "base_hash": known})
    assert (answer.status, answer.json["note"]) == (200, "")


def _version(page: Page, version_id: str) -> Answer:
    return page.post("/api/version", {"name": "zones/a.adirf", "id": version_id})
