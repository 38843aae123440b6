# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""The first line of a docstring names its subject, or says what to do; no question word stands for it."""

from __future__ import annotations

import ast
from collections.abc import Iterator
from pathlib import Path

import pytest

SOURCES = Path(__file__).resolve().parent.parent / "src" / "smarttestudo"
UNNAMED = {"What", "Who", "Those", "Each"}


def unnamed_lines(source: str) -> Iterator[str]:
    for node in ast.walk(ast.parse(source)):
        if isinstance(node, ast.Module | ast.ClassDef | ast.FunctionDef | ast.AsyncFunctionDef):
            line = (ast.get_docstring(node) or "").partition("\n")[0]
            if line.partition(" ")[0] in UNNAMED:
                yield line


def test_each_first_line_names_its_subject() -> None:
    files = [path.relative_to(SOURCES) for path in sorted(SOURCES.rglob("*.py"))]
    assert len(files) > 200
    found = {
        f"{file}: {line}" for file in files for line in unnamed_lines((SOURCES / file).read_text("utf-8"))
    }
    assert found == set()


@pytest.mark.parametrize("word", sorted(UNNAMED))
def test_an_unnamed_subject_is_seen(word: str) -> None:
    source = f'def noted() -> None:\n    """{word} was noted.\n\n    Later lines do not count.\n    """\n'
    assert list(unnamed_lines(source)) == [f"{word} was noted."]


def test_a_later_line_may_begin_with_any_word() -> None:
    assert not list(unnamed_lines('"""Notes.\n\nWhat was noted stays.\n"""\n'))
