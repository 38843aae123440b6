# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""One module removes files and folders, and what it cannot know to be ours stays."""

from __future__ import annotations

import ast
from collections.abc import Iterator
from pathlib import Path

import pytest

PACKAGE = Path(__file__).parents[2] / "src" / "smarttestudo"
REMOVAL = "files/removal.py"
REMOVING = frozenset({"rmtree", "unlink", "rmdir", "removedirs", "TemporaryDirectory"})
"""What removes, whatever it is called on; lists and sets have a ``remove``, too."""
REMOVING_OF_OS = frozenset({"remove", "renames"})
PROGRAMS = frozenset({"rm", "rmdir", "unlink", "shred"})


def removals(tree: ast.AST) -> Iterator[int]:
    """The lines in which something of a file system may be removed."""
    for node in ast.walk(tree):
        if isinstance(node, ast.Attribute):
            is_of_os = isinstance(node.value, ast.Name) and node.value.id in {"os", "shutil"}
            if node.attr in REMOVING or (is_of_os and node.attr in REMOVING_OF_OS):
                yield node.lineno
        elif isinstance(node, ast.ImportFrom) and node.module in {"os", "shutil", "tempfile", "pathlib"}:
            if any(alias.name in REMOVING | REMOVING_OF_OS for alias in node.names):
                yield node.lineno
        elif isinstance(node, ast.List | ast.Tuple) and node.elts:
            first = node.elts[0]
            if isinstance(first, ast.Constant) and first.value in PROGRAMS:
                yield node.lineno


@pytest.mark.parametrize(
    "text",
    [
        "shutil.rmtree(path)",
        "path.unlink()",
        "Path(name).rmdir()",
        "os.remove(name)",
        "from os import remove",
        "from shutil import rmtree as away",
        "with tempfile.TemporaryDirectory() as name: pass",
        "subprocess.run(['rm', '-r', name])",
        "list(map(os.unlink, names))",
    ],
)
def test_what_removes_is_seen(text: str) -> None:
    assert list(removals(ast.parse(text))) == [1]


def test_no_other_module_removes_anything() -> None:
    found = {
        str(path.relative_to(PACKAGE)): lines
        for path in PACKAGE.rglob("*.py")
        if (lines := list(removals(ast.parse(path.read_text(encoding="utf-8")))))
    }
    assert list(found) == [REMOVAL]
