# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""Modules import each other in no circle, so that each can be imported first."""

from __future__ import annotations

import ast
from graphlib import TopologicalSorter
from pathlib import Path

PACKAGE = Path(__file__).parents[2] / "src" / "smarttestudo"


def module_name(path: Path) -> str:
    parts = ("smarttestudo", *path.relative_to(PACKAGE).with_suffix("").parts)
    return ".".join(parts).removesuffix(".__init__")


def test_no_module_imports_itself_by_way_of_others() -> None:
    modules = {module_name(path): path for path in PACKAGE.rglob("*.py")}
    imports: dict[str, set[str]] = {}
    for name, path in modules.items():
        wanted = imports.setdefault(name, set())
        # Only what runs at import: what a function imports later may lead back.
        for statement in ast.parse(path.read_text(encoding="utf-8")).body:
            if isinstance(statement, ast.ImportFrom) and statement.module:
                names = (f"{statement.module}.{alias.name}" for alias in statement.names)
                wanted |= {full if full in modules else statement.module for full in names}
    graph = {name: wanted & modules.keys() for name, wanted in imports.items()}
    assert len(list(TopologicalSorter(graph).static_order())) == len(modules) > 300
