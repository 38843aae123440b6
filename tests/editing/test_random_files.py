# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""Any rule file goes through the server and back without losing a byte."""

from __future__ import annotations

import re
from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from language.written_rules import WrittenFile, written_files
from ruler.ruler_server import Page, served

NEW_RATE = {"kind": "set", "topic": "/new", "rate": {"kind": "hz", "value": 1}}


@dataclass(frozen=True, slots=True, kw_only=True)
class Project:
    """A folder, and the page that works in it."""

    folder: Path
    page: Page

    def document(self, text: str) -> Any:
        return self.page.post("/api/document", {"text": text}).json

    def edited(self, text: str, edit: object) -> str:
        return str(self.page.post("/api/edit", {"text": text, "edits": [edit]}).json["text"])


@pytest.fixture(scope="module")
def project(tmp_path_factory: pytest.TempPathFactory) -> Iterator[Project]:
    folder = tmp_path_factory.mktemp("project")
    with served(folder) as page:
        yield Project(folder=folder, page=page)


def statements(document: Any) -> list[Any]:
    return [one for collection in document["collections"] for one in collection["statements"]]


def words_of(text: str, one: Any) -> str:
    """The words of a statement, whose place counts as JavaScript does."""
    units = text.encode("utf-16-le")
    return units[2 * one["offset"] : 2 * one["end_offset"]].decode("utf-16-le")


@given(written=written_files(max_statements=4))
@settings(max_examples=25)
def test_a_random_file_opens_as_blocks_and_saves_the_same_bytes(
    project: Project, written: WrittenFile
) -> None:
    file = project.folder / "random.adirf"
    file.write_bytes(written.text.encode())
    read = project.page.get("/api/file?name=random.adirf").json
    document = project.document(read["text"])
    assert document["parses"]
    as_text = {"For", "Within", "Until", "KeepWithin"}
    for one in statements(document):
        # What the page has no words for is shown as its text.
        assert one["kind"] != "raw" or as_text & set(re.findall(r"[A-Za-z]+", one["text"]))
    body = {"name": "random.adirf", "text": read["text"], "base_hash": read["hash"]}
    assert project.page.put("/api/file", body).status == 200
    assert file.read_bytes() == written.text.encode()


@given(written=written_files(max_statements=4), data=st.data())
@settings(max_examples=25)
def test_an_edit_of_a_random_file_keeps_the_words_of_all_other_statements(
    project: Project, written: WrittenFile, data: st.DataObject
) -> None:
    before = project.document(written.text)
    names = [one["id"] for one in statements(before)]
    collection = data.draw(st.sampled_from(before["collections"]))
    index = data.draw(st.integers(0, len(collection["statements"])))
    edits: list[dict[str, Any]] = [
        {"kind": "insert", "collection": collection["id"], "index": index, "statement": NEW_RATE}
    ]
    if names:
        name = data.draw(st.sampled_from(names))
        edits += [{"kind": "delete", "id": name}, {"kind": "replace", "id": name, "statement": NEW_RATE}]
    for edit in edits:
        text = project.edited(written.text, edit)
        after = [words_of(text, one) for one in statements(project.document(text))]
        kept = [words_of(written.text, one) for one in statements(before) if one["id"] != edit.get("id")]
        rest = iter(after)
        # The one thing that an edit may add is an EndIf.
        assert all(any(word.startswith(words) for word in rest) for words in kept), edit
