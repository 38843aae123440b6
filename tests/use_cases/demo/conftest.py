# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
from __future__ import annotations

import json
from dataclasses import asdict
from pathlib import Path

import pytest

from made_once import made_once
from use_cases.demo.demo_runs import Messages, Ran, messages_of, run_testudo


@pytest.fixture(scope="session")
def demo_folder(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """What ``testudo demo`` writes as it comes, 200 s and seed 0, and in ``ran.json`` what it says."""

    def make(folder: Path) -> None:
        ran = run_testudo("demo", "--out", folder / "desk" / "demo-out")
        (folder / "ran.json").write_text(json.dumps(asdict(ran)), encoding="utf-8")

    return made_once(tmp_path_factory, "demo", make)


@pytest.fixture(scope="session")
def demo_out(demo_folder: Path) -> Path:
    return demo_folder / "desk" / "demo-out"


@pytest.fixture(scope="session")
def whole_demo(demo_folder: Path) -> Ran:
    return Ran(**json.loads((demo_folder / "ran.json").read_text(encoding="utf-8")))


@pytest.fixture(scope="session")
def baseline(whole_demo: Ran, demo_out: Path) -> Messages:
    return messages_of(demo_out / "baseline")


@pytest.fixture(scope="session")
def adaptive(whole_demo: Ran, demo_out: Path) -> Messages:
    return messages_of(demo_out / "adaptive")
