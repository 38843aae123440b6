# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""The list of files says of rules what they take of the budget, and what the last try of them said."""

from __future__ import annotations

from collections.abc import Iterator
from pathlib import Path
from typing import Any

import pytest

from ruler.ruler_server import Page, served

RULES = (
    "begin\n    SetFrequency /odom 10\n    If (CheckValue /odom pose_x > 3) Then SetFrequency /odom 20\nend\n"
)
PROFILE = 'budget_kb_per_s = 100\n\n[topics."/odom"]\nmessage_kb = 2\nsource_hz = 50\n'
TRIED = {"name": "a.adirf", "bag": "walk", "kb_per_s": 12.5, "percent": 60.0}


@pytest.fixture
def folder(tmp_path: Path) -> Path:
    (tmp_path / "a.adirf").write_text(RULES)
    (tmp_path / "a.toml").write_text(PROFILE)
    return tmp_path


@pytest.fixture
def page(folder: Path) -> Iterator[Page]:
    with served(folder) as page:
        yield page


def test_a_file_has_the_load_of_its_worst_case(page: Page) -> None:
    assert _summary(page) == {"load": {"kb_per_s": 40.0, "budget_kb_per_s": 100.0}, "last_try": None}


def test_a_load_follows_file_and_profile(page: Page, folder: Path) -> None:
    (folder / "a.adirf").write_text(RULES.replace("20", "40"))
    assert _summary(page)["load"]["kb_per_s"] == 80.0
    (folder / "a.toml").write_text(PROFILE.replace("message_kb = 2", "message_kb = 4"))
    assert _summary(page)["load"] == {"kb_per_s": 160.0, "budget_kb_per_s": 100.0}


@pytest.mark.parametrize(
    ("rules", "profile"),
    [
        (RULES.replace("Then", "Than"), PROFILE),
        (RULES, PROFILE.replace("budget_kb_per_s = 100", "")),
        (RULES, PROFILE.replace("message_kb = 2", "")),
        (RULES, "no profile"),
    ],
)
def test_what_cannot_be_computed_has_no_load(page: Page, folder: Path, rules: str, profile: str) -> None:
    (folder / "a.adirf").write_text(rules)
    (folder / "a.toml").write_text(profile)
    assert _summary(page)["load"] is None


def test_a_draft_has_no_part_in_the_load(page: Page) -> None:
    draft = {"content": RULES.replace("20", "50"), "beside": "", "base_hash": None}
    root_hash = page.get("/api/project").json["root_hash"]
    asked = {"name": "a.adirf", "root_hash": root_hash, "id": "1", "known_ids": [], "draft": draft}
    assert page.put("/api/draft", asked).status == 200
    assert _summary(page)["load"]["kb_per_s"] == 40.0


def test_the_last_try_outlives_the_server(folder: Path) -> None:
    with served(folder) as page:
        assert page.put("/api/file/tried", {**TRIED, "bag": "walk before"}).status == 200
        assert page.put("/api/file/tried", TRIED).status == 200
    with served(folder) as page:
        last = _summary(page)["last_try"]
    assert last.pop("tried_at_ms") > 0
    assert last == {key: value for key, value in TRIED.items() if key != "name"}


@pytest.mark.parametrize("wrong", [{"bag": "b" * 1001}, {"name": "../a.adirf"}, {"kb_per_s": None}])
def test_what_is_no_try_is_refused(page: Page, wrong: dict[str, object]) -> None:
    assert page.put("/api/file/tried", {**TRIED, **wrong}).status in {400, 403, 422}
    assert _summary(page)["last_try"] is None


def test_a_file_that_cannot_be_read_has_neither(page: Page, folder: Path) -> None:
    (folder / "a.adirf").write_bytes(b"\xff")
    assert _summary(page) == {"load": None, "last_try": None}


def _summary(page: Page) -> Any:
    return page.get("/api/file/summary?name=a.adirf").json
