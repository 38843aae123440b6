# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""One word for each thing: those that CONTRIBUTING.md drops are in no message, page and document."""

from __future__ import annotations

import ast
import re
from collections.abc import Iterator
from pathlib import Path

import pytest

ROOT = Path(__file__).parents[2]
PYTHON = sorted((ROOT / "src" / "smarttestudo").rglob("*.py"))
PAGE = [*sorted((ROOT / "gui" / "src").rglob("*.tsx")), *sorted((ROOT / "gui" / "src").rglob("*.ts"))]
DOCUMENTS = [
    ROOT / "README.md",
    *(page for page in sorted((ROOT / "docs").rglob("*.md")) if page.parent.name != "decisions"),
]
# In documents a decision keeps the words of its time, and so does the changelog.
DROPPED = re.compile(
    r"(?<![-\w])[Tt]iers?(?![-\w])"
    r"|\b(?:[Aa]|[Tt]he|[Tt]his|[Ee]ach|[Nn]o) bags?\b"
    r"|\b[Mm]onitored (?:topic|message|rate)"
    r"|\b[Ff]orwarded\b"
    r"|\bKiB\b|\bkB\b"
    r"|\b[Dd]efault recording\b"
    r"|\b\d{1,3}(?:,\d{3})+\b(?! *[,\]])"
)
GROUPED_BY_COMMAS = re.compile(r"\{[^{}]*:,[^{}]*\}")
COMMENT = re.compile(r"/\*.*?\*/|(?<!:)//[^\n]*", re.DOTALL)
VALUE = re.compile(r"\$\{[^{}]*\}")
SENTENCE = re.compile(r"\"[^\"\n]* [^\"\n]*\"|`[^`\n]* [^`\n]*`|>[^<>{}=;]* [^<>{}=;]*<")
CODE = re.compile(r"```\w*\n.*?```|`[^`\n]*`", re.DOTALL)


def read_by_users(path: Path) -> Iterator[str]:
    """The texts of a file that may be shown: those with a space, and no docstrings or comments."""
    text = path.read_text("utf-8")
    if path.suffix == ".md":
        yield from CODE.sub("", text).splitlines()
    elif path.suffix == ".py":
        yield from _python_texts(ast.parse(text))
    else:
        yield from SENTENCE.findall(VALUE.sub("", COMMENT.sub("", text)))


def _python_texts(tree: ast.Module) -> Iterator[str]:
    docstrings = {
        id(node.value) for node in ast.walk(tree) if isinstance(node, ast.Expr) and _is_text(node.value)
    }
    for node in ast.walk(tree):
        if isinstance(node, ast.Constant) and isinstance(node.value, str) and id(node) not in docstrings:
            yield from (line for line in node.value.splitlines() if " " in line.strip())


def _is_text(node: ast.expr) -> bool:
    return isinstance(node, ast.Constant) and isinstance(node.value, str)


@pytest.mark.parametrize("files", [PYTHON, PAGE, DOCUMENTS], ids=["messages", "page", "documents"])
def test_dropped_words_are_nowhere_to_be_read(files: list[Path]) -> None:
    assert len(files) > 5
    found = {
        f"{path.relative_to(ROOT)}: {text.strip()[:120]}"
        for path in files
        for text in read_by_users(path)
        if DROPPED.search(text)
    }
    assert found == set()


def test_no_number_is_written_with_commas_between_thousands() -> None:
    assert [str(path) for path in PYTHON if GROUPED_BY_COMMAS.search(_spelled(path))] == []


def _spelled(path: Path) -> str:
    """A module without the two functions that turn the commas into spaces."""
    return re.sub(r"return f\"\{[^\n]*\.replace\(\",\", \" \"\)", "", path.read_text("utf-8"))


@pytest.mark.parametrize(
    "text",
    [
        "a number of Hz or a tier",
        "try the bag again",
        "Try on a bag",
        "the monitored topics",
        "12,180.0 KB/s",
    ],
)
def test_a_dropped_word_is_seen(text: str) -> None:
    assert DROPPED.search(text)


@pytest.mark.parametrize(
    "text", ["tier-without-rate in it", "testudo bag info", "[1,200] or 1,5", "a bagful"]
)
def test_another_is_not(text: str) -> None:
    assert not DROPPED.search(text)
