# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""What is not saved is kept in the project, and reaches the file by a save only."""

from __future__ import annotations

import resource
from collections.abc import Iterator, Mapping
from contextlib import contextmanager
from pathlib import Path
from urllib.parse import quote

import pytest

from ruler.ruler_server import Answer, Page, served
from smarttestudo.files.whole_file import OutputFileError
from smarttestudo.ruler.files.drafts import DraftStore, Unsaved
from smarttestudo.ruler.files.project_folder import ForbiddenPathError, ProjectFolder

NAME = "zones/a.adirf"
RULES = "begin\n    SetFrequency /odom 10\nend\n"
MINE, THEIRS = RULES.replace("10", "11"), RULES.replace("10", "12")


@pytest.fixture
def folder(tmp_path: Path) -> Path:
    (tmp_path / "project" / "zones").mkdir(parents=True)
    (tmp_path / "project" / NAME).write_text(RULES)
    (tmp_path / "project" / "wlan.toml").write_text('[topics."/odom"]\nmessage_kb = 0.7\n')
    return tmp_path / "project"


@pytest.fixture
def page(folder: Path) -> Iterator[Page]:
    with served(folder) as page:
        yield page


def test_a_draft_is_for_everybody_and_the_file_stays_as_it_is(page: Page, folder: Path) -> None:
    assert page.get(f"/api/draft?name={NAME}").json == {"draft": None}
    assert _keep(page, "ada 1", [], MINE).status == 200
    draft = page.get(f"/api/draft?name={NAME}").json["draft"]
    assert (draft["id"], draft["content"], draft["beside"]) == ("ada 1", MINE, '{"map":null}')
    assert (folder / NAME).read_text() == RULES
    assert [one["name"] for one in page.get("/api/drafts").json["drafts"]] == [NAME]
    assert [one["name"] for one in page.get("/api/project").json["files"]] == ["wlan.toml", NAME]
    assert (folder / ".testudo" / "drafts" / ".gitignore").read_text() == "*\n"


def test_a_draft_outlives_the_server(folder: Path) -> None:
    with served(folder) as page:
        _keep(page, "ada 1", [], MINE)
    with served(folder) as page:
        assert page.get(f"/api/draft?name={NAME}").json["draft"]["content"] == MINE


def test_half_a_table_is_a_draft_of_its_profile(page: Page) -> None:
    assert _keep(page, "ada 1", [], '{"rows": [', name="wlan.toml").status == 200
    assert page.get("/api/draft?name=wlan.toml").json["draft"]["content"] == '{"rows": ['


def test_a_page_that_does_not_know_the_draft_replaces_neither_it_nor_the_file(
    page: Page, folder: Path
) -> None:
    _keep(page, "ada 1", [], MINE)
    refused = _keep(page, "bob 1", ["bob 0"], THEIRS)
    assert (refused.status, refused.error) == (409, "somebody else has changed the file")
    assert _save(page, THEIRS, []).status == 409
    assert (_draft(page), (folder / NAME).read_text()) == (MINE, RULES)
    assert _keep(page, "bob 2", ["ada 1"], THEIRS).status == 200
    assert _draft(page) == THEIRS


def test_a_draft_whose_answer_got_lost_is_known_to_its_page(page: Page) -> None:
    _keep(page, "ada 1", [], MINE)
    assert _keep(page, "ada 2", ["ada 0", "ada 1"], THEIRS).status == 200


def test_a_save_takes_the_place_of_the_draft(page: Page, folder: Path) -> None:
    _keep(page, "ada 1", [], MINE)
    assert _save(page, MINE, ["ada 1"]).status == 200
    assert (_draft(page), (folder / NAME).read_text()) == (None, MINE)
    assert page.get("/api/drafts").json["drafts"] == []


def test_what_is_discarded_is_a_version(page: Page) -> None:
    _keep(page, "ada 1", [], MINE)
    _drop(page, ["ada 1"], discarded=MINE)
    assert _draft(page) is None
    (kept,) = page.get(f"/api/versions?name={NAME}").json["versions"]
    assert page.post("/api/version", {"name": NAME, "id": kept["id"]}).json["text"] == MINE


def test_the_draft_of_somebody_else_is_not_discarded(page: Page) -> None:
    _keep(page, "ada 1", [], MINE)
    assert _drop(page, ["bob 1"], discarded=THEIRS).status == 200
    assert _draft(page) == MINE


def test_a_page_of_another_project_writes_no_draft_here(page: Page) -> None:
    draft = {"content": MINE, "beside": "", "base_hash": None}
    asked = {"name": NAME, "root_hash": "of another", "id": "ada 1", "known_ids": [], "draft": draft}
    assert _put(page, asked).error == "this is another project now"
    assert _draft(page) is None


def test_a_disk_without_room_leaves_the_draft_before(folder: Path) -> None:
    store = DraftStore(ProjectFolder(folder))
    store.keep(NAME, _unsaved(MINE), "ada 1", [])
    with _no_room(), pytest.raises(OutputFileError, match="the draft cannot be written"):
        store.keep(NAME, _unsaved(THEIRS), "ada 2", ["ada 1"])
    kept = store.read(NAME)
    assert kept is not None
    assert (kept.id, kept.content) == ("ada 1", MINE)
    assert [one.name for one in (folder / ".testudo" / "drafts" / "zones").iterdir()] == ["a.adirf.json"]


def test_a_draft_is_as_large_as_a_file_at_most(page: Page) -> None:
    assert _keep(page, "ada 1", [], "/" * 999_000).status == 200
    refused = _keep(page, "ada 2", ["ada 1"], "/" * 1_000_001)
    assert (refused.status, refused.error) == (422, "the draft is larger than 1 MB")


@pytest.mark.parametrize("damage", ["", "{", "[]", '{"id": 5}', "\ud800"])
def test_a_damaged_draft_is_none(folder: Path, page: Page, damage: str) -> None:
    _keep(page, "ada 1", [], MINE)
    path = folder / ".testudo" / "drafts" / f"{NAME}.json"
    path.write_bytes(damage.encode("utf-8", "surrogatepass"))
    assert _draft(page) is None
    assert page.get("/api/drafts").json["drafts"] == []
    assert _keep(page, "ada 2", [], MINE).status == 200


@pytest.mark.parametrize(
    "name",
    ["../a.adirf", "/etc/passwd", "", ".", ".testudo/x", "zones", "zones/.a.adirf.layout.json", "a\0.adirf"],
)
def test_drafts_of_other_files_are_refused(page: Page, name: str) -> None:
    assert page.get(f"/api/draft?name={quote(name)}").status == 403
    assert _keep(page, "ada 1", [], MINE, name=name).status == 403


def test_a_link_does_not_lead_drafts_out_of_the_project(folder: Path, tmp_path: Path) -> None:
    outside = tmp_path / "outside"
    outside.mkdir()
    (folder / ".testudo").symlink_to(outside)
    with pytest.raises(ForbiddenPathError):
        DraftStore(ProjectFolder(folder)).keep(NAME, _unsaved(MINE), "ada 1", [])
    assert list(outside.iterdir()) == []


def _unsaved(content: str) -> Unsaved:
    return Unsaved(content=content, beside="", base_hash=None)


def _keep(page: Page, draft_id: str, known: list[str], content: str, *, name: str = NAME) -> Answer:
    draft = {"content": content, "beside": '{"map":null}', "base_hash": None}
    return _put(page, {"name": name, "id": draft_id, "known_ids": known, "draft": draft})


def _drop(page: Page, known: list[str], *, discarded: str) -> Answer:
    asked = {"name": NAME, "id": "", "known_ids": known, "draft": None, "discarded": discarded}
    return _put(page, asked)


def _put(page: Page, asked: Mapping[str, object]) -> Answer:
    return page.put("/api/draft", {"root_hash": page.get("/api/project").json["root_hash"], **asked})


def _save(page: Page, text: str, known: list[str]) -> Answer:
    base = page.get(f"/api/file?name={NAME}").json["hash"]
    return page.put("/api/file", {"name": NAME, "text": text, "base_hash": base, "draft_ids": known})


def _draft(page: Page) -> str | None:
    draft = page.get(f"/api/draft?name={NAME}").json["draft"]
    return None if draft is None else draft["content"]


@contextmanager
def _no_room() -> Iterator[None]:
    """Files of this process cannot grow."""
    soft, hard = resource.getrlimit(resource.RLIMIT_FSIZE)
    resource.setrlimit(resource.RLIMIT_FSIZE, (0, hard))
    try:
        yield
    finally:
        resource.setrlimit(resource.RLIMIT_FSIZE, (soft, hard))
