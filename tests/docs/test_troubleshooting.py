# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""A user who searches the documentation for an error finds it, as the code says it."""

from __future__ import annotations

import ast
import re
import runpy
from collections.abc import Iterator
from pathlib import Path

import pytest

ROOT = Path(__file__).parents[2]
DOCS = ROOT / "docs"
MAKE = runpy.run_path(str(ROOT / "scripts" / "make_error_texts.py"))
QUOTED = re.compile(r"^\| `([^`]*)` \|", re.MULTILINE)
OF_OTHERS = {"error: externally-managed-environment", "unrecognized arguments: …"}
"""Quoted texts that pip and argparse write."""


def quoted() -> list[str]:
    page = (DOCS / "troubleshooting.md").read_text(encoding="utf-8")
    return [text for text in QUOTED.findall(page) if text not in OF_OTHERS]


def parts(text: str) -> list[str]:
    """What stands between the … for all that differs."""
    return [part for part in re.split(r"\s*…\s*", text) if part.strip()]


@pytest.fixture(scope="module")
def strings() -> str:
    return "\n".join(_strings())


def _strings() -> Iterator[str]:
    # The link on one machine is a benchmark's.
    for path in (*MAKE["SOURCES"].rglob("*.py"), *(ROOT / "benchmarks" / "thin_link").glob("*.py")):
        for node in ast.walk(ast.parse(path.read_text(encoding="utf-8"))):
            if isinstance(node, ast.Constant) and isinstance(node.value, str):
                yield node.value


def test_the_list_of_error_texts_is_what_make_docs_writes() -> None:
    assert MAKE["PAGE"].read_text(encoding="utf-8") == MAKE["page"]()


@pytest.mark.parametrize("text", quoted())
def test_a_text_in_troubleshooting_is_one_of_the_code(text: str, strings: str) -> None:
    assert [part for part in parts(text) if part not in strings] == []


def test_every_folder_that_raises_errors_is_in_the_list() -> None:
    raising = re.compile(rf"raise (?:{'|'.join(MAKE['error_classes']())})\(")
    listed = tuple(folder for folders in MAKE["SECTIONS"].values() for folder in folders)
    paths = [path.relative_to(MAKE["SOURCES"]) for path in MAKE["SOURCES"].rglob("*.py")]
    unlisted = [
        str(path)
        for path in paths
        if raising.search((MAKE["SOURCES"] / path).read_text(encoding="utf-8"))
        and not str(path).startswith(listed)
    ]
    assert unlisted == []
