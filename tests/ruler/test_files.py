# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""Files are called otherwise and deleted, and nothing else is touched."""

from __future__ import annotations

from pathlib import Path
from urllib.parse import quote

import pytest

from ruler.ruler_server import Page, served

RULES = "begin\n    SetFrequency /odom 10\nend\n"
# With ".adirf" a name of 250 bytes, the most are 255.
LONG = "n" * 244


def saved(page: Page, name: str, text: str = RULES) -> str:
    """Save a new file; its hash."""
    answer = page.put("/api/file", {"name": name, "text": text, "base_hash": None})
    assert answer.status == 200, answer.body
    return str(answer.json["hash"])


def names(project: dict[str, list[dict[str, str]]]) -> set[str]:
    return {file["name"] for file in project["files"]}


def test_a_file_takes_its_versions_its_map_and_its_profile_along(tmp_path: Path) -> None:
    with served(tmp_path) as page:
        first = saved(page, "day.adirf")
        text = RULES.replace("10", "4")
        page.put("/api/file", {"name": "day.adirf", "text": text, "base_hash": first})
        saved(page, "radio.toml", "")
        saved(page, ".day.adirf.layout.json", '{"map": null}')
        page.put("/api/profile/for", {"name": "day.adirf", "profile": "radio.toml"})
        sha256 = page.get("/api/file?name=day.adirf").json["hash"]

        asked = {"name": "day.adirf", "new_name": "runs/night.adirf", "base_hash": sha256}
        answer = page.post("/api/file/rename", asked)

        assert answer.status == 200, answer.body
        assert names(answer.json) == {"runs/night.adirf", "runs/.night.adirf.layout.json", "radio.toml"}
        assert page.get("/api/file?name=runs/night.adirf").json["text"] == text
        assert len(page.get("/api/versions?name=runs/night.adirf").json["versions"]) == 2
        assert page.get("/api/versions?name=day.adirf").json["versions"] == []
        chosen = page.post("/api/profile/for", {"name": "runs/night.adirf", "text": text}).json
        assert chosen["name"] == "radio.toml"
    assert not (tmp_path / ".testudo/versions/day.adirf").exists()


def test_a_copy_has_the_map_and_the_profile_of_the_file_and_versions_of_its_own(tmp_path: Path) -> None:
    with served(tmp_path) as page:
        saved(page, "day.adirf")
        saved(page, "radio.toml", "")
        saved(page, ".day.adirf.layout.json", '{"map": null}')
        page.put("/api/profile/for", {"name": "day.adirf", "profile": "radio.toml"})

        asked = {"name": "day.adirf", "new_name": "runs/night.adirf"}
        answer = page.post("/api/file/copy", asked)

        assert answer.status == 200, answer.body
        assert (tmp_path / "runs/.night.adirf.layout.json").read_text() == '{"map": null}'
        for name in ("day.adirf", "runs/night.adirf"):
            assert (tmp_path / name).read_text() == RULES
            assert len(page.get(f"/api/versions?name={name}").json["versions"]) == 1
            chosen = page.post("/api/profile/for", {"name": name, "text": RULES}).json
            assert chosen["name"] == "radio.toml"
        assert page.post("/api/file/copy", asked).status == 409


def test_a_copy_of_a_table_is_a_table_and_nothing_else(tmp_path: Path) -> None:
    with served(tmp_path) as page:
        saved(page, "radio.toml", "budget_kb_per_s = 5.0\n")
        answer = page.post("/api/file/copy", {"name": "radio.toml", "new_name": "radio_copy.toml"})
        assert (answer.status, names(answer.json)) == (200, {"radio.toml", "radio_copy.toml"})
    assert (tmp_path / "radio_copy.toml").read_text() == "budget_kb_per_s = 5.0\n"


def test_a_file_whose_map_would_have_too_long_a_name_takes_its_versions_along(tmp_path: Path) -> None:
    with served(tmp_path) as page:
        sha256 = saved(page, f"{LONG}.adirf")
        asked = {"name": f"{LONG}.adirf", "new_name": "day.adirf", "base_hash": sha256}
        answer = page.post("/api/file/rename", asked)
        assert (answer.status, names(answer.json)) == (200, {"day.adirf"})
        assert len(page.get("/api/versions?name=day.adirf").json["versions"]) == 1
        back = {"name": "day.adirf", "new_name": f"{LONG}.adirf", "base_hash": sha256}
        assert page.post("/api/file/rename", back).status == 200


def test_a_deleted_file_comes_back_from_what_the_page_kept_and_from_its_versions(tmp_path: Path) -> None:
    (tmp_path / "beside.txt").write_text("mine")
    with served(tmp_path) as page:
        sha256 = saved(page, "day.adirf")
        answer = page.post("/api/file/delete", {"name": "day.adirf", "base_hash": sha256})
        assert (answer.status, names(answer.json)) == (200, set())
        assert not (tmp_path / "day.adirf").exists()
        assert len(page.get("/api/versions?name=day.adirf").json["versions"]) == 1
        assert saved(page, "day.adirf") == sha256
    assert (tmp_path / "beside.txt").read_text() == "mine"


@pytest.mark.parametrize(
    ("route", "asked", "says"),
    [
        ("rename", {"new_name": "b.adirf"}, "has a file of this name"),
        ("rename", {"new_name": "a.toml"}, "keeps its kind"),
        ("rename", {"new_name": "../a.adirf"}, "not the name of a file in the project"),
        ("rename", {"new_name": ".hidden/a.adirf"}, "shows no files of such a folder"),
        ("rename", {"new_name": "1/2/3/4/5/6/a.adirf"}, "shows no files of such a folder"),
        ("rename", {"new_name": "c.adirf", "base_hash": "0"}, "changed on disk"),
        ("rename", {"new_name": f"{LONG}.adirf"}, "too long for the map"),
        ("copy", {"new_name": "b.adirf"}, "has a file of this name"),
        ("copy", {"new_name": "a.toml"}, "keeps its kind"),
        ("copy", {"new_name": "../a.adirf"}, "not the name of a file in the project"),
        ("copy", {"new_name": f"{LONG}.adirf"}, "too long for the map"),
        ("copy", {"name": "gone.adirf", "new_name": "c.adirf"}, "no such file"),
        ("delete", {"base_hash": "0"}, "changed on disk"),
        ("delete", {"name": "linked.adirf"}, "is a link"),
        ("delete", {"name": "../outside.adirf"}, "not the name of a file in the project"),
        ("delete", {"name": "beside.txt"}, "does not edit this kind of file"),
        ("delete", {"name": "gone.adirf"}, "no such file"),
    ],
)
def test_what_is_refused_leaves_everything_as_it_was(
    tmp_path: Path, route: str, asked: dict[str, str], says: str
) -> None:
    root = tmp_path / "project"
    root.mkdir()
    (tmp_path / "outside.adirf").write_text(RULES)
    for name in ("a.adirf", "b.adirf", "beside.txt"):
        (root / name).write_text(RULES)
    (root / ".a.adirf.layout.json").write_text("{}")
    (root / "linked.adirf").symlink_to("a.adirf")
    before = {path: path.read_bytes() for path in sorted(tmp_path.rglob("*")) if path.is_file()}
    with served(root) as page:
        sha256 = page.get(f"/api/file?name={quote('a.adirf')}").json["hash"]
        answer = page.post(f"/api/file/{route}", {"name": "a.adirf", "base_hash": sha256, **asked})
    assert 400 <= answer.status < 500
    assert says in answer.error
    kept = sorted(path for path in tmp_path.rglob("*") if path.is_file() and ".testudo" not in path.parts)
    assert {path: path.read_bytes() for path in kept} == before


def test_a_file_that_the_browser_has_travels_again_only_when_it_changed(tmp_path: Path) -> None:
    with served(tmp_path) as page:
        sha256 = saved(page, "day.adirf")
        known = page.get("/api/file?name=day.adirf")
        asked = {"If-None-Match": known.headers["etag"]}
        again = page.request("GET", "/api/file?name=day.adirf", headers=asked)
        assert (again.status, again.body) == (304, b"")
        assert "no-store" not in known.headers["cache-control"] + again.headers["cache-control"]
        text = RULES.replace("10", "4")
        page.put("/api/file", {"name": "day.adirf", "text": text, "base_hash": sha256})
        changed = page.request("GET", "/api/file?name=day.adirf", headers=asked)
        assert (changed.status, changed.json["text"]) == (200, text)
