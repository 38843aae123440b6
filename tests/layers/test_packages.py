# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""Each third-party package stands in a contract that says which folders may import it."""

from __future__ import annotations

import sys
from pathlib import Path

import grimp
import tomli

ROOT = Path(__file__).parents[2]


def test_every_third_party_package_has_the_folders_that_may_import_it() -> None:
    contracts = tomli.loads((ROOT / "pyproject.toml").read_text(encoding="utf-8"))["tool"]["importlinter"]
    protected = [name for one in contracts["contracts"] for name in one.get("protected_modules", ())]
    named = [name for name in protected if not name.startswith("smarttestudo.")]
    graph = grimp.build_graph("smarttestudo", include_external_packages=True)
    imported = {name.partition(".")[0] for name in graph.modules} - {"smarttestudo"}
    assert set(named) == imported - sys.stdlib_module_names
    assert len(named) == len(set(named)) > 20
