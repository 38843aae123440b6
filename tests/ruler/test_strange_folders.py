# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""Folders with links in circles, pipes and names that no page can show."""

from __future__ import annotations

import os
from collections.abc import Iterator
from pathlib import Path
from urllib.parse import quote

import pytest

from bags.bag_factory import small_mission, write_bag
from ruler.ruler_server import Page, served

RULES = "begin end"
MAP = "resolution: 0.1\norigin: [0, 0, 0]\n"


@pytest.fixture(scope="module")
def folder(tmp_path_factory: pytest.TempPathFactory) -> Path:
    folder = tmp_path_factory.mktemp("project")
    for name in ("circle.adirf", "circle.png", "circle", "circle.db3"):
        (folder / name).symlink_to(name)
    os.mkfifo(folder / "pipe.adirf")
    os.mkfifo(folder / "pipe.png")
    (folder / "of_circle.yaml").write_text(f"image: circle.png\n{MAP}")
    (folder / "of_pipe.yaml").write_text(f"image: pipe.png\n{MAP}")
    (folder / "of_zero.yaml").write_text(f'image: "a\\0b.png"\n{MAP}')
    (folder / "good.adirf").write_text(RULES)
    (folder / "run 12:30.adirf").write_text(RULES)
    write_bag(folder / "rec 12:30", small_mission(1.0))
    (folder / "C:drive.adirf").write_text(RULES)
    (folder / "back\\slash.adirf").write_text(RULES)
    (folder / "two\nlines.adirf").write_text(RULES)
    Path(os.fsdecode(os.fsencode(folder) + b"/\xff.adirf")).write_text(RULES)
    return folder


@pytest.fixture(scope="module")
def page(folder: Path) -> Iterator[Page]:
    with served(folder) as page:
        yield page


def test_the_rest_of_the_project_is_listed(page: Page) -> None:
    answer = page.get("/api/project")
    assert answer.status == 200
    maps = ["of_circle.yaml", "of_pipe.yaml", "of_zero.yaml"]
    assert [one["name"] for one in answer.json["files"]] == [
        "good.adirf",
        *maps,
        "rec 12:30",
        "run 12:30.adirf",
    ]
    assert [one["name"] for one in page.get("/api/backgrounds").json["choices"]] == [*maps, "rec 12:30"]


def test_what_has_a_time_in_its_name_is_opened(page: Page) -> None:
    assert page.get(f"/api/file?name={quote('run 12:30.adirf')}").json["text"] == RULES
    assert page.post("/api/recording", {"bag": "rec 12:30"}).json["topics"]


@pytest.mark.parametrize(
    "path",
    [
        "/api/file?name=circle.adirf",
        "/api/file?name=circle/a.adirf",
        "/api/file?name=pipe.adirf",
        "/api/file?name=good.adirf/a.adirf",
        f"/api/file?name={'n' * 256}.adirf",
        f"/api/file?name={quote('é' * 130)}.adirf",
        "/api/file?name=two%0Alines.adirf",
        "/api/file?name=zero%00.adirf",
        "/api/file?name=C:drive.adirf",
        "/api/file?name=back%5Cslash.adirf",
        "/api/background/picture?kind=image&name=circle.png",
        "/api/background/picture?kind=map&name=of_circle.yaml",
        "/api/background/picture?kind=map&name=of_pipe.yaml",
        "/api/background/picture?kind=map&name=of_zero.yaml",
    ],
)
def test_what_cannot_be_read_is_said_with_the_name_that_the_page_gave(
    page: Page, folder: Path, path: str
) -> None:
    answer = page.get(path)
    assert answer.status in {403, 404, 422}
    assert answer.error
    assert str(folder).encode() not in answer.body


@pytest.mark.parametrize("bag", ["circle.db3", "n" * 256])
def test_a_bag_that_cannot_be_read_is_said_with_the_name_that_the_page_gave(
    page: Page, folder: Path, bag: str
) -> None:
    answer = page.post("/api/profile/measure", {"bag": bag})
    assert answer.status in {403, 404, 422}
    assert answer.error
    assert str(folder).encode() not in answer.body


@pytest.mark.parametrize(
    ("name", "status"),
    [
        ("circle.adirf", 403),
        (f"{'n' * 256}.adirf", 403),
        ("two\nmore.adirf", 403),
        ("good.adirf/x.adirf", 422),
    ],
)
def test_what_cannot_be_written_is_said_with_the_name_that_the_page_gave(
    page: Page, folder: Path, name: str, status: int
) -> None:
    before = sorted(folder.iterdir())
    answer = page.put("/api/file", {"name": name, "text": RULES, "base_hash": None})
    assert answer.status == status
    assert answer.json["error"]["place"] == name
    assert str(folder).encode() not in answer.body
    assert sorted(folder.iterdir()) == before


def test_a_file_of_the_longest_name_is_written(page: Page) -> None:
    name = f"{'n' * 249}.adirf"
    assert page.put("/api/file", {"name": name, "text": RULES, "base_hash": None}).status == 200
    assert page.get(f"/api/file?name={name}").json["text"] == RULES
