# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""The reference pages say what the code does."""

from __future__ import annotations

import runpy
from pathlib import Path

import pytest

from smarttestudo.checks import CHECKS

ROOT = Path(__file__).resolve().parents[2]
PAGES = runpy.run_path(str(ROOT / "scripts" / "make_reference.py"))["pages"]()


@pytest.mark.parametrize("path", PAGES, ids=lambda path: path.name)
def test_the_committed_page_is_what_make_docs_writes(path: Path) -> None:
    assert path.read_text(encoding="utf-8") == PAGES[path]


def test_every_check_has_a_file_of_its_own_and_a_line_in_the_registry() -> None:
    folder = ROOT / "src" / "smarttestudo" / "checks"
    named = {
        path.stem.replace("_", "-")
        for path in folder.glob("*.py")
        if "CHECK = RuleCheck(" in path.read_text()
    }
    assert named == {check.code for check in CHECKS}
