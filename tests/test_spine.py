# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""The files that ARCHITECTURE.md calls the spine know no feature."""

from __future__ import annotations

import ast
import re
from collections.abc import Iterator
from pathlib import Path

ROOT = Path(__file__).resolve().parent.parent
SOURCES = ROOT / "src" / "smarttestudo"
BELOW = {"domain", "files", "pacing", "language", "checks", "optimizer", "loop", "rules", "robot"}
"""Rooms that the loop beside a robot needs."""
LISTS_THE_PARTS = SOURCES / "cli" / "run.py"


def spine() -> list[Path]:
    text = (
        (ROOT / "ARCHITECTURE.md")
        .read_text(encoding="utf-8")
        .partition("## The spine")[2]
        .partition("\n## ")[0]
    )
    rows = re.findall(r"^- `(\w+)`: (.*(?:\n  .*)*)", text, re.MULTILINE)
    return [
        SOURCES / room / f"{name}.py" for room, names in rows for name in re.findall(r"`([\w/]+)`", names)
    ]


def imported_rooms(path: Path) -> Iterator[str]:
    for node in ast.walk(ast.parse(path.read_text(encoding="utf-8"))):
        if isinstance(node, ast.ImportFrom) and (node.module or "").startswith("smarttestudo."):
            yield (node.module or "").split(".")[1]


def test_it_imports_no_part() -> None:
    rooms = {path: set(imported_rooms(path)) for path in spine() if path != LISTS_THE_PARTS}
    assert len(rooms) > 25
    assert {path.name: found - BELOW for path, found in rooms.items() if found - BELOW} == {}
