# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""Recordings, the command line and a cluster that the tests of this folder share."""

from __future__ import annotations

import shutil
from collections.abc import Iterator
from pathlib import Path

import pytest
from rosbags.rosbag2 import StoragePlugin

from bags.bag_factory import small_mission, write_bag
from bags.many.commands import Command
from bags.many.dask_processes import DaskProcesses, dask_processes
from report.bag_desk import thinned

RULES = "begin\n    SetFrequency /odom 5\n    SetFrequency /scan 1\nend\n"


@pytest.fixture(scope="session")
def cluster(tmp_path_factory: pytest.TempPathFactory) -> Iterator[DaskProcesses]:
    """Two workers, which tests leave as they are."""
    with dask_processes(tmp_path_factory.mktemp("dask")) as started:
        yield started


@pytest.fixture(scope="session")
def fleet_made_once(tmp_path_factory: pytest.TempPathFactory) -> Path:
    folder = tmp_path_factory.mktemp("fleet")
    for name in ("a", "b", "c"):
        write_bag(folder / "sent" / name, small_mission(2 + ord(name) % 3), storage=StoragePlugin.MCAP)
        write_bag(folder / "received" / name, thinned(5))
    (folder / "rules.adirf").write_text(RULES)
    return folder


@pytest.fixture
def fleet(fleet_made_once: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    shutil.copytree(fleet_made_once, tmp_path, dirs_exist_ok=True)
    monkeypatch.chdir(tmp_path)
    return tmp_path


@pytest.fixture
def testudo(capsys: pytest.CaptureFixture[str]) -> Command:
    return Command(capsys)
