# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
from __future__ import annotations

from pathlib import Path

import pytest

from made_demos import Ran, made_demo
from simulation.demo.demo_runs import Messages, messages_of, robots_messages_of


@pytest.fixture(scope="session")
def demo_out(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """What ``testudo demo`` writes as it comes, 200 s and seed 0."""
    return made_demo(tmp_path_factory)[0]


@pytest.fixture(scope="session")
def whole_demo(tmp_path_factory: pytest.TempPathFactory) -> Ran:
    """What it says."""
    return made_demo(tmp_path_factory)[1]


@pytest.fixture(scope="session")
def baseline(whole_demo: Ran, demo_out: Path) -> Messages:
    return messages_of(demo_out / "baseline")


@pytest.fixture(scope="session")
def adaptive(whole_demo: Ran, demo_out: Path) -> Messages:
    return robots_messages_of(demo_out / "adaptive")
