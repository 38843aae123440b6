# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""A whole recording is measured without what only others need: that would take longer than counting it."""

from __future__ import annotations

import subprocess
import sys
from pathlib import Path

import pytest
from rosbags.rosbag2 import StoragePlugin

from bags.bag_factory import small_mission, write_bag

PROGRAM = """
import sys
from smarttestudo.cli.main import main
main(["bag", *sys.argv[1:]])
print(*sys.modules, file=sys.stderr)
"""
NEVER = {
    "lz4",
    "matplotlib",
    "mcap",
    "numpy",
    "rich",
    "rosbags.rosbag2",
    "smarttestudo.bags.comparison",
    "smarttestudo.bags.file_copies",
    "smarttestudo.bags.time_index",
    "smarttestudo.domain.incident",
    "smarttestudo.pacing.sample",
    "zstandard",
}


@pytest.mark.parametrize("action", ["info", "rates", "bandwidth"])
@pytest.mark.parametrize(
    ("storage", "unneeded"),
    [
        (StoragePlugin.SQLITE3, {"smarttestudo.bags.mcap"}),
        (StoragePlugin.MCAP, {"apsw"}),
    ],
)
def test_only_what_the_storage_needs_is_imported(
    tmp_path: Path, action: str, storage: StoragePlugin, unneeded: set[str]
) -> None:
    write_bag(tmp_path / "bag", small_mission(), storage=storage)
    done = subprocess.run(
        [sys.executable, "-c", PROGRAM, action, str(tmp_path / "bag")],
        capture_output=True,
        text=True,
        check=True,
    )
    assert "/odom" in done.stdout
    assert not (NEVER | unneeded) & set(done.stderr.split())
