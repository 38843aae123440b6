# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
from __future__ import annotations

from pathlib import Path

import pytest

from demo.demo_runs import Messages, Ran, messages_of, run_testudo


@pytest.fixture(scope="session")
def demo_out(tmp_path_factory: pytest.TempPathFactory) -> Path:
    return tmp_path_factory.mktemp("demo") / "demo-out"


@pytest.fixture(scope="session")
def whole_demo(demo_out: Path) -> Ran:
    """``testudo demo`` as it comes: 200 s, seed 0."""
    return run_testudo("demo", "--out", demo_out)


@pytest.fixture(scope="session")
def baseline(whole_demo: Ran, demo_out: Path) -> Messages:
    return messages_of(demo_out / "baseline")


@pytest.fixture(scope="session")
def adaptive(whole_demo: Ran, demo_out: Path) -> Messages:
    return messages_of(demo_out / "adaptive")
