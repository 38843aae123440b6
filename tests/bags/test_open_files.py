# SPDX-FileCopyrightText: 2026 The SmartTestudo authors
# SPDX-License-Identifier: Apache-2.0
"""Recordings of many files, as of a day that was split each minute."""

from __future__ import annotations

import os
import resource
from collections.abc import Iterator
from contextlib import contextmanager
from itertools import pairwise
from pathlib import Path

import pytest
from rosbags.rosbag2 import StoragePlugin

from bags.bag_factory import BagContent, small_mission, write_split_bag
from bags.bag_reading import read_bag
from smarttestudo.bags.reader import open_recording
from smarttestudo.domain.errors import RecordingError

MISSION = small_mission()
FILES = 20


def open_files() -> int:
    return sum(1 for _ in Path("/proc/self/fd").iterdir())


def of_many_files(folder: Path, storage: StoragePlugin) -> Path:
    bounds = [number * len(MISSION.messages) // FILES for number in range(FILES + 1)]
    parts = [BagContent(MISSION.topics, MISSION.messages[first:last]) for first, last in pairwise(bounds)]
    return write_split_bag(folder, parts, storage=storage)


@contextmanager
def descriptors_left(count: int) -> Iterator[None]:
    before = resource.getrlimit(resource.RLIMIT_NOFILE)
    free = os.dup(0)
    os.close(free)
    resource.setrlimit(resource.RLIMIT_NOFILE, (free + count, before[1]))
    try:
        yield
    finally:
        resource.setrlimit(resource.RLIMIT_NOFILE, before)


@pytest.mark.parametrize("storage", StoragePlugin)
@pytest.mark.full
def test_of_a_recording_only_files_that_are_being_read_are_open(
    tmp_path: Path, storage: StoragePlugin
) -> None:
    folder, before = of_many_files(tmp_path / "mission", storage), open_files()
    with open_recording(folder) as recording:
        for read in (recording.messages, recording.sizes, lambda: recording.heads(4)):
            opened = [open_files() - before for _ in read()]
            assert len(opened) == len(MISSION.messages)
            assert max(opened) <= 4
    assert open_files() == before


@pytest.mark.full
def test_files_that_cannot_be_opened_at_once_are_an_error_and_not_left_out(tmp_path: Path) -> None:
    folder = of_many_files(tmp_path / "mission", StoragePlugin.SQLITE3)
    for path in folder.glob("*.db3"):
        path.write_bytes(path.read_bytes()[:-4096])
    assert len(read_bag(folder).notices) >= FILES
    with (
        descriptors_left(FILES // 2),
        pytest.raises(RecordingError, match=r": Too many open files; raise the limit of open files: ulimit"),
        open_recording(folder),
    ):
        pass
